"""What has to be run for the pages, in groups, and the lines of the pages that would then change."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from hil_tests.documents import commands
from hil_tests.documents.compared import Change, paragraph, table
from hil_tests.documents.pages import Block, blocks


@dataclass(frozen=True)
class Group:
    """Blocks that are checked together: the commands of a page, or a block with figures."""

    name: str
    page: str
    long: bool
    changes: Callable[[], list[Change]]


def groups(of: Iterable[Block] | None = None) -> list[Group]:
    """Everything that is run or computed: the commands of each page without and with the long ones, and the figures."""
    found = list(blocks() if of is None else of)
    return [
        *_commands(found),
        *map(_figures, (block for block in found if block.marker and block.marker[0] == "figures")),
    ]


def _commands(found: Sequence[Block]) -> Iterable[Group]:
    pages = dict.fromkeys(block.page for block in found)
    for page in pages:
        run = [
            one
            for one in found
            if one.page == page and one.kind == "fence" and one.info[:1] and one.info[0] in commands.RUN
        ]
        for long in (False, True):
            chosen = [block for block in run if ("long" in block.info) is long and "machine" not in block.info]
            if chosen:
                yield Group(f"{page}{' long' if long else ''}", page, long, lambda chosen=chosen: _run(chosen))


def _run(chosen: Sequence[Block]) -> list[Change]:
    examples = [block for block in chosen if block.info[0] == "python" and ">>> " in block.text]
    with tempfile.TemporaryDirectory(prefix="railhil-page-") as name:
        found = [change for block in chosen if block not in examples for change in commands.check(block, Path(name))]
        return found + commands.examples(examples, Path(name))


def _figures(block: Block) -> Group:
    assert block.marker is not None
    name, *words = block.marker[1].split()
    given = words[words.index("given") + 1 :] if "given" in words else []

    def changes() -> list[Change]:
        # Not before: what computes figures loads half of the bench.
        from hil_tests.documents.figures import computed

        return table(block, computed(name)) if block.kind == "table" else paragraph(block, computed(name), given)

    return Group(f"{block.page} {name}", block.page, "long" in words, changes)
