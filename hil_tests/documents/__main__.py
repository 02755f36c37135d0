"""``python -m hil_tests.documents [PAGE...]`` (``make figures``): brings commands' output and figures up to date.

``--quick`` leaves out what is long. What differs in words is printed, and has to be written by hand; exit code 1 then.
"""

from __future__ import annotations

import argparse
import sys

from hil_tests.documents.commands import Failed
from hil_tests.documents.compared import OtherWords
from hil_tests.documents.pages import PAGES, read, write
from hil_tests.documents.update import groups


def main() -> int:
    """Update the pages of the tree."""
    parser = argparse.ArgumentParser(prog="python -m hil_tests.documents", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("pages", nargs="*", default=PAGES, metavar="PAGE", help="README.md, docs/index.md, ... (all)")
    parser.add_argument("--quick", action="store_true", help="without what `make test-long` checks")
    parser.add_argument("--only", default="", metavar="TEXT", help="only what has this text in its name")
    given = parser.parse_args()
    lengths = {page: len(read(page)) for page in PAGES}
    code = 0
    for group in groups():
        if group.page not in given.pages or (group.long and given.quick) or given.only not in group.name:
            continue
        try:
            changes = group.changes()
            write(group.page, {change.number: change.line for change in changes}, lengths[group.page])
        except (Failed, OtherWords, ValueError) as problem:
            print(f"{group.name}: {problem}", flush=True)
            code = 1
        else:
            print(f"{group.name}: {len(changes)} lines", flush=True)
    return code


if __name__ == "__main__":
    sys.exit(main())
