"""Write the constant tables of the laws: ``python -m railhil.controller_node.ato.generate``.

With ``--check`` nothing is written; the exit code is 1 if a table differs from the result of its law.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from typing import Any

from railhil.controller_node.ato import fuzzy_pid_constants, ipfc_constants, tdmc_constants
from railhil.controller_node.ato.laws import tpfc1, tpfc2
from railhil.controller_node.laws.constant_table import LawTable, coarse, flatten

#: One table per law.
TABLES: tuple[LawTable[Any], ...] = (
    ipfc_constants.TABLE,
    tpfc1.TABLE,
    tpfc2.TABLE,
    tdmc_constants.TABLE,
    fuzzy_pid_constants.TABLE,
)


def main(arguments: Sequence[str] | None = None, tables: Sequence[LawTable[Any]] = TABLES) -> int:
    """Write or check every table; lists the constants with large rounding errors."""
    parser = argparse.ArgumentParser(
        prog="python -m railhil.controller_node.ato.generate", description="Constant tables."
    )
    parser.add_argument("--check", action="store_true", help="write nothing, exit code 1 when a table is out of date")
    check = parser.parse_args(arguments).check
    stale = 0
    for table in tables:
        text = table.text()
        if not check:
            table.path.parent.mkdir(exist_ok=True)
            table.path.write_text(text, encoding="utf-8", newline="\n")
        elif not table.path.is_file() or table.path.read_bytes() != text.encode():
            print(f"{table.path.name}: not what the law computes; without --check it is written anew", file=sys.stderr)
            stale = 1
            continue
        constants = flatten(table.load())
        print(f"{table.path.name}: {len(constants)} constants")
        for constant in coarse(constants):
            print(f"  {constant.name} = {constant.value!r}: Q{constant.q} is off by {constant.relative_error:.1e}")
    return stale


if __name__ == "__main__":
    sys.exit(main())
