"""How large the product is: ``python -m hil_tests.size [REVISION ...]``, one column for each revision and one for the
files here.

Product: every Python module that git knows outside ``hil_tests`` and ``benchmarks``. A module that says "do not edit"
in its first line is written by a program, and counted apart.
"""

from __future__ import annotations

import argparse
import io
import subprocess
import sys
import tarfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from hil_tests.support.paths import ROOT

#: A module of fewer lines is small.
_SMALL = 60
_OTHERS = ("hil_tests/", "benchmarks/")


@dataclass(frozen=True)
class Size:
    """Lines and modules of a version."""

    lines: int
    modules: int
    small: int
    generated: int
    test_lines: int


def measure(files: Iterable[tuple[str, str]]) -> Size:
    """Size of a version.

    :param files: path from the top and text of each Python module.
    """
    product, generated, tests = [], 0, 0
    for path, text in files:
        lines = text.splitlines()
        if path.startswith(_OTHERS):
            tests += len(lines)
        elif lines and "do not edit" in lines[0]:
            generated += len(lines)
        else:
            product.append(len(lines))
    return Size(sum(product), len(product), sum(count < _SMALL for count in product), generated, tests)


def files_of(revision: str, root: Path = ROOT) -> Iterable[tuple[str, str]]:
    """Path and text of each Python module of a revision.

    :raises subprocess.CalledProcessError: git knows no such revision.
    """
    command = ["git", "-C", str(root), "archive", "--format=tar", revision]
    packed = subprocess.run(command, check=True, capture_output=True).stdout
    with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
        for member in archive:
            if member.isfile() and member.name.endswith(".py"):
                found = archive.extractfile(member)
                assert found is not None
                yield member.name, found.read().decode()


def files_here(root: Path = ROOT) -> Iterable[tuple[str, str]]:
    """Path and text of each Python module here that git does not ignore; a symbolic link is none."""
    command = ["git", "-C", str(root), "ls-files", "--cached", "--others", "--exclude-standard", "*.py"]
    for name in subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines():
        path = root / name
        if path.is_file() and not path.is_symlink():
            yield name, path.read_text(encoding="utf-8")


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m hil_tests.size", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("revisions", nargs="*", metavar="REVISION", help="as git names it, e.g. 9f2e9f48")
    revisions = parser.parse_args().revisions
    sizes = [*(measure(files_of(revision)) for revision in revisions), measure(files_here())]
    table = Table("", *(f"{name}" for name in [*revisions, "here"]))
    for what, name in (
        ("product, lines", "lines"),
        ("product, modules", "modules"),
        (f"modules under {_SMALL} lines", "small"),
        ("lines written by a program, in git", "generated"),
        ("lines of tests and benchmarks", "test_lines"),
    ):
        table.add_row(what, *(f"{getattr(size, name):,}" for size in sizes))
    Console().print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
