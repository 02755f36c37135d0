"""A page of the documentation, cut into blocks."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from hil_tests.support.paths import ROOT

#: The four kinds of pages: learning by doing, steps of a task, how and why, tables.
FOLDERS = ("tutorial", "howto", "explanation", "reference")
#: README and the pages of docs. Those in docs/reproduce are written whole by ``railhil reproduce``.
PAGES = (
    "README.md",
    *sorted(str(path.relative_to(ROOT)) for path in (ROOT / "docs").glob("*.md")),
    *sorted(str(path.relative_to(ROOT)) for folder in FOLDERS for path in (ROOT / "docs" / folder).glob("*.md")),
)
#: Kinds of a marker above a block.
MARKERS = ("figures", "measured", "given")
_FENCE = re.compile(r"^( *)```(.*)$")
_BEFORE = re.compile(r"^ *<!-- before: (.*?) -->$")
_MARKER = re.compile(rf"^ *<!-- ({'|'.join(MARKERS)}): (.*?) -->$")
_CODE = re.compile(r"`[^`]*`|\]\([^)]*\)|<!--.*?-->", re.S)
#: A figure: digits on both sides of a point. Not part of a longer word such as a version or a file name.
DECIMAL = re.compile(r"(?<![\w.])[+-]?\d+\.\d+(?![.]?\w|/)")


@dataclass(frozen=True, slots=True)
class Block:
    """Lines of a page that belong together.

    ``kind`` is ``fence``, ``table`` or ``text``; ``info`` the words after the opening of a fence; ``first`` the number
    (from 0) of the first of ``lines`` in the page. A fence's lines are those between its marks, a table's its rows
    below the head. ``marker`` is kind and text of the comment above, ``before`` has the commands that make what the
    block's own commands need.
    """

    page: str
    kind: str
    first: int
    lines: tuple[str, ...]
    info: tuple[str, ...] = ()
    marker: tuple[str, str] | None = None
    before: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.page}:{self.first + 1}"

    @property
    def text(self) -> str:
        """The lines, joined."""
        return "\n".join(self.lines)

    @property
    def figures(self) -> list[str]:
        """Its decimal figures, but for those in code and in the addresses of links."""
        return DECIMAL.findall(self.text if self.kind == "fence" else _CODE.sub(" ", self.text))


def blocks_of(page: str, lines: list[str]) -> Iterator[Block]:
    """Blocks of a page in their order."""
    at = 0
    marker: tuple[str, str] | None = None
    before: list[str] = []
    while at < len(lines):
        if found := _MARKER.match(lines[at]):
            marker, at = (found[1], found[2]), at + 1
            continue
        if found := _BEFORE.match(lines[at]):
            before.append(found[1])
            at += 1
            continue
        if opening := _FENCE.match(lines[at]):
            end = next(n for n in range(at + 1, len(lines)) if lines[n].rstrip() == f"{opening[1]}```") + 1
            inside = tuple(lines[at + 1 : end - 1])
            yield Block(page, "fence", at + 1, inside, tuple(opening[2].split()), marker, tuple(before))
        elif not lines[at].strip():
            end = at + 1
        else:
            end = at
            while end < len(lines) and lines[end].strip() and not _FENCE.match(lines[end]):
                end += 1
            is_table = lines[at].lstrip().startswith("|") and end > at + 1
            first = at + 2 if is_table else at
            yield Block(page, "table" if is_table else "text", first, tuple(lines[first:end]), (), marker)
        at, marker, before = end, None, []


def read(page: str) -> list[str]:
    """Lines of a page of the tree."""
    return (ROOT / page).read_text(encoding="utf-8").split("\n")


@cache
def blocks() -> tuple[Block, ...]:
    """Blocks of all pages."""
    return tuple(block for page in PAGES for block in blocks_of(page, read(page)))


def write(page: str, changed: dict[int, str], length: int) -> None:
    """Put other lines into a page of the tree, by their numbers (from 0).

    :param length: number of lines of the page when it was read.
    :raises ValueError: somebody has edited the page since then.
    """
    lines = read(page)
    if len(lines) != length:
        raise ValueError(f"{page}: edited meanwhile; nothing is written")
    for number, line in changed.items():
        lines[number] = line
    (ROOT / page).write_text("\n".join(lines), encoding="utf-8")
