"""README.md and the pages of docs: every command runs, every figure in a table is right."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hil_tests.documents import commands
from hil_tests.documents.compared import OtherWords, paragraph, printed, table
from hil_tests.documents.pages import FOLDERS, MARKERS, PAGES, Block, blocks, blocks_of
from hil_tests.documents.update import Group, groups
from hil_tests.support.paths import ROOT

#: A line of a block in which nothing is run, and which looks as if somebody should type it.
_TYPED = re.compile(r"(?:\$ |(?:railhil|make|python3?|docker|pip) [a-z-]+(?= |$)).*")
#: A link to a file of the tree.
_LINK = re.compile(r"\]\((?![a-z]+:)([^)#\s]+)(?:#[^)\s]*)?\)")
#: Pages whose tables are written from a schema; tests elsewhere compare them.
_WRITTEN = ("docs/reference/scenario_keys.md", "docs/reference/faults.md")


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize(
    "group", [pytest.param(one, id=one.name, marks=[pytest.mark.long] if one.long else []) for one in groups()]
)
def test_the_pages_say_what_is(group: Group) -> None:
    changes = group.changes()
    assert not changes, "\n".join(
        [f"{group.page}: `make figures` writes", *(f"{one.number + 1}: {one.line}" for one in changes)]
    )


def problem(block: Block) -> str:
    """What a block does not say of itself; empty if nothing is missing."""
    if block.kind == "fence":
        language, *words = block.info or ("",)
        if language not in (*commands.RUN, *commands.SHOWN) or not set(words) <= set(commands.WORDS):
            return (
                f"a fenced block says what it is: {', '.join((*commands.RUN, *commands.SHOWN))}; long, machine, pytest"
            )
        if language == "text":
            typed = [line for line in block.lines if _TYPED.fullmatch(line) and "[" not in line]
            if typed:
                return f"commands stand in a block that is run (console, sh), or needs a machine: {typed[0]}"
    is_ours = block.kind == "table" and block.page not in _WRITTEN
    needs = is_ours or block.info[:1] == ("text",) or (block.kind == "text" and block.page == "README.md")
    if needs and block.figures and block.marker is None:
        return f"figures ({', '.join(block.figures[:3])}) without a comment above: {', '.join(MARKERS)}"
    return ""


def test_every_block_says_what_it_is() -> None:
    found = [f"{block}: {problem(block)}" for block in blocks() if problem(block)]
    assert not found, "\n".join(found)


def test_every_link_of_a_page_leads_to_a_file() -> None:
    """Its anchors are checked by `make docs`, which takes as long as hundreds of tests."""
    links = [(page, link) for page in PAGES for link in _LINK.findall((ROOT / page).read_text(encoding="utf-8"))]
    assert len(links) > 200
    assert [(page, link) for page, link in links if not ((ROOT / page).parent / link).exists()] == []


def test_every_page_is_of_one_kind() -> None:
    """A page is in the folder of its kind. Not so the entrance, and the pages that ``railhil reproduce`` writes."""
    places = {path.relative_to(ROOT / "docs").parts[0] for path in (ROOT / "docs").rglob("*.md")}
    assert places <= {"index.md", *FOLDERS, "examples", "reproduce"}


def test_a_page_is_short_enough_to_be_read() -> None:
    """Not so the pages that a command writes: in docs/reproduce, and tables of all keys or faults."""
    texts = {page: (ROOT / page).read_bytes() for page in (*PAGES, "CONTRIBUTING.md") if page != "README.md"}
    by_hand = {page: len(text) for page, text in texts.items() if b"\nWritten by `python -m " not in text}
    assert 0 < len(texts) - len(by_hand) < 5
    assert [page for page, octets in by_hand.items() if octets > 15_000] == []
    assert by_hand["CONTRIBUTING.md"] <= 8_000


def test_commands_and_figures_are_there() -> None:
    """The rule must not hold because no block is recognised as one."""
    kinds = [block.kind for block in blocks()]
    assert {page for page in PAGES if page not in {block.page for block in blocks()}} == set()
    assert (kinds.count("fence") > 100, kinds.count("table") > 80) == (True, True)
    assert sum(not group.long for group in groups()) > 15


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (["```", "railhil run", "```"], "says what it is"),
        (["```bash", "railhil run", "```"], "says what it is"),
        (["```text", "railhil run", "```"], "commands stand in a block that is run"),
        (["```text", "stop error 0.25 m", "```"], "without a comment"),
        (["| law | m |", "|---|---|", "| ipfc | 0.25 |"], "without a comment"),
        (["<!-- given: the paper -->", "", "| law | m |", "|---|---|", "| ipfc | 0.25 |"], "without a comment"),
        (["It stops 0.25 m short."], "without a comment"),
    ],
)  # fmt: skip
def test_what_is_not_checked_is_found(lines: list[str], said: str) -> None:
    assert said in problem(next(blocks_of("README.md", lines)))


def _block(*lines: str) -> Block:
    return next(blocks_of("README.md", list(lines)))


def test_figures_are_compared_and_words_are_not_guessed(tmp_path: Path) -> None:
    block = _block("```console", "$ railhil run", "FAIL: stop error -0.347 m, after ... s", "hash " + 64 * "a", "```")
    digits = "FAIL:  stop error +0.249 m, after 1.25 s\nhash " + 64 * "b"
    changes = printed(block, 1, block.lines[1:], digits)
    assert [one.line for one in changes] == ["FAIL: stop error +0.249 m, after ... s", "hash " + 64 * "b"]
    assert [one.number for one in changes] == [2, 3]
    assert printed(block, 1, block.lines[1:], block.text) == []
    with pytest.raises(OtherWords, match=r"README\.md:3: not printed"):
        printed(block, 1, block.lines[1:], digits.replace("FAIL", "PASS"))


def test_a_paragraph_has_its_figures_where_its_words_are() -> None:
    block = _block("It stops 0.25 m short", "in 20 of 200 runs, and 0.25 m", "in `0.1`.")
    changes = paragraph(block, ["stops 0.31 m short in 21 of 200", "and 0.40 m"])
    assert [(one.number, one.line) for one in changes] == [
        (0, "It stops 0.31 m short"), (1, "in 21 of 200 runs, and 0.40 m"),
    ]  # fmt: skip
    with pytest.raises(OtherWords, match=r"no function computes 0\.25"):
        paragraph(block, ["stops 0.31 m short"])
    assert len(paragraph(block, ["stops 0.31 m short"], given=["0.25"])) == 1
    with pytest.raises(OtherWords, match="there 0 times"):
        paragraph(block, ["stops 0.31 m late", "and 0.25 m"])


def test_rows_are_those_of_the_function(tmp_path: Path) -> None:
    lines = ["x", "", "<!-- figures: laws.none -->", "   | law | m |", "   |---|---|", "   | ipfc | 0.25 |"]
    block = list(blocks_of("README.md", lines))[1]
    assert table(block, ["| ipfc | 0.25 |"]) == []
    assert [(one.number, one.line) for one in table(block, ["| ipfc | 0.26 |"])] == [(5, "   | ipfc | 0.26 |")]
    with pytest.raises(OtherWords, match="1 rows, 0 are computed"):
        table(block, [])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("railhil run yizhuang_5", "ended with 2: railhil run yizhuang_5"),
        ("exit 0", "the shell ended early"),
        ("railhil ports NOTCH_CMD && false", ""),
    ],
)
def test_a_command_that_does_not_work_is_found(tmp_path: Path, command: str, said: str) -> None:
    block = _block("```sh", command, "```")
    if not said:
        assert commands.check(block, tmp_path) == []
    else:
        with pytest.raises(commands.Failed, match=said):
            commands.check(block, tmp_path)


def test_examples_are_compared(tmp_path: Path) -> None:
    block = _block("```python", ">>> x = 20", ">>> print(x, 'm')", "19 m", "```")
    assert [(one.number, one.line) for one in commands.examples([block], tmp_path)] == [(3, "20 m")]
    with pytest.raises(OtherWords):
        commands.examples([_block("```python", ">>> print('20 m')", "20 s", "```")], tmp_path)
