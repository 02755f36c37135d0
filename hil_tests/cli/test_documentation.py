"""README and docs: every link has a target, and every printed command line is valid."""

from __future__ import annotations

import re
from argparse import SUPPRESS, ArgumentParser, _SubParsersAction
from collections.abc import Iterator
from functools import cache

from hil_tests.support.paths import ROOT
from hil_tests.support.venvs import project
from railhil.cli import commands
from railhil.cli import programs as outside
from railhil.cli.completion import program_parser, whole_parser

_PAGES = ("README.md", "CONTRIBUTING.md", *sorted(str(page.relative_to(ROOT)) for page in ROOT.glob("docs/**/*.md")))
#: Of our own repository, and of a file in it as it is.
_REPOSITORY = project()["urls"]["Homepage"]
_RAW = _REPOSITORY.replace("github.com", "raw.githubusercontent.com")
_LINK = re.compile(r"\]\(([^)\s]+)\)")
#: From the name of the command to the end of the sentence, the shell's word or the comment. What ``railhil vcan`` runs
#: is a command line of its own.
_COMMAND = re.compile(r"\brailhil ((?:board |bus |memory |new |node |sequence )?[a-z][a-z-]*)((?: (?!-- )[^\s`|#&]+)*)")
_OPTION = re.compile(r"(?<!\S)--?[a-z][a-z0-9-]*")


def _anchor(heading: str) -> str:
    """As GitHub makes it of a heading."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def _subparsers(parser: ArgumentParser) -> dict[str, ArgumentParser]:
    return {name: sub for a in parser._actions if isinstance(a, _SubParsersAction) for name, sub in a.choices.items()}


@cache
def _options() -> dict[str, set[str]]:
    """Command, as it is typed after ``railhil`` -> its options."""
    found = _subparsers(commands.parser())
    for above in ("board", "bus", "memory", "new"):
        found |= {f"{above} {name}": parser for name, parser in _subparsers(found.pop(above)).items()}
    del found["node"]
    programs = {f"node {role}": module for role, module in outside.NODES.items()}
    programs |= outside.PROGRAMS
    for name, module in programs.items():
        found[name] = program_parser(module)
    for above in ("sequence", "target"):
        found |= {f"{above} {word}": parser for word, parser in _subparsers(found.pop(above)).items()}
    return {name: set(parser._option_string_actions) for name, parser in found.items()}


def _command_lines(text: str) -> list[tuple[str, str]]:
    joined = re.sub(r"\\\n\s*", "", text)
    return [(match[1], match[2]) for line in joined.splitlines() for match in _COMMAND.finditer(line)]


def _in_the_tree(target: str) -> str:
    """A link to our own repository, as in README.md, as one within the tree."""
    found = re.fullmatch(rf"(?:{_REPOSITORY}/blob|{_RAW})/main/(.*)", target)
    return f"/{found[1]}" if found else target


def test_readme_has_whole_addresses():
    """The package index shows it, and knows no neighbouring file."""
    targets = _LINK.findall((ROOT / "README.md").read_text(encoding="utf-8"))
    assert len(targets) > 10
    assert [target for target in targets if not target.startswith("https://")] == []
    assert sum(target.startswith((_REPOSITORY, _RAW)) for target in targets) > 10


def test_readme_is_a_screen_and_a_half() -> None:
    assert len((ROOT / "README.md").read_bytes()) <= 6000


def test_headings_are_headings() -> None:
    """Also where a line of text begins with a number sign."""
    for page in _PAGES:
        words = re.sub(r"^```.*?^```$", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.M | re.S)
        assert re.findall(r"^#+(?!#| [^#\s]).*$", words, re.M) == [], page


def test_links_lead_somewhere():
    links = [(page, link) for page in _PAGES for link in _LINK.findall((ROOT / page).read_text(encoding="utf-8"))]
    for page, link in links:
        target = _in_the_tree(link)
        if target.startswith(("http://", "https://")):
            continue
        name, _, anchor = target.partition("#")
        base = ROOT if name.startswith("/") else (ROOT / page).parent
        path = base / name.removeprefix("/") if name else ROOT / page
        assert path.exists(), (page, target)
        if anchor:
            headings = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.M)
            assert anchor in map(_anchor, headings), (page, target)


def test_options_of_printed_commands_exist():
    for page in _PAGES:
        for command, rest in _command_lines((ROOT / page).read_text(encoding="utf-8")):
            if command in _options():
                unknown = [option for option in _OPTION.findall(rest) if option not in _options()[command]]
                assert not unknown, f"{page}: railhil {command}{rest}"


def _leaves(parser: ArgumentParser, name: str = "railhil") -> Iterator[tuple[str, ArgumentParser]]:
    below = _subparsers(parser)
    for word, sub in below.items():
        yield from _leaves(sub, f"{name} {word}")
    if not below:
        yield name, parser


def test_every_option_says_what_it_is_and_is_in_the_documentation() -> None:
    text = "\n".join((ROOT / page).read_text(encoding="utf-8") for page in _PAGES)
    named = set(re.findall(r"(?<![\w-])--?[a-z][a-z0-9-]*", text)) | {"-h"}
    for name, parser in _leaves(whole_parser()):
        assert parser.epilog, name
        for action in parser._actions:
            assert action.help, (name, action.dest)
            if action.option_strings and action.help != SUPPRESS:
                assert named & set(action.option_strings), (name, action.option_strings)


def test_the_commands_without_a_document_are_named() -> None:
    """All others have ``--json``."""
    text = (ROOT / "docs/howto/runs.md").read_text(encoding="utf-8")
    named = re.findall(
        r"`([^`]+)`", text.partition("have no such\noption:")[2].partition("\n\n")[0].partition(".\n")[0]
    )
    without = {
        name.removeprefix("railhil ")
        for name, parser in _leaves(whole_parser())
        if "--json" not in parser._option_string_actions
    }
    assert without == set(named)


def test_code_blocks_name_only_commands_that_exist():
    seen = 0
    for page in _PAGES:
        for block in re.findall(
            r"^```(?:sh|console|usage)?\b[^\n]*\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.M | re.S
        ):
            for line in block.splitlines():
                # A line that is a command line, not what one prints.
                match = re.match(
                    r"\s*railhil (?:(?:board|bus|memory|new|node|sequence|target) )?[a-z][a-z-]*(?= |$)", line
                )
                if match and match[0].strip() != "railhil hub":
                    seen += 1
                    assert match[0].strip().removeprefix("railhil ") in _options(), line
    assert seen > 50


def test_a_frame_and_a_score_are_followed_through_files_that_are_there() -> None:
    """Two numbered lists: each station is a file of its own, and none comes twice."""
    text = (ROOT / "docs/explanation/house.md").read_text(encoding="utf-8").partition("## Follow one frame")[2]
    numbered = re.findall(r"^(\d+)\. `([^`]+)`", text.partition("\n## ")[0], re.MULTILINE)
    begins = [place for place, (number, _) in enumerate(numbered) if number == "1"]
    assert len(begins) == 2
    frame, score = ([path for _, path in part] for part in (numbered[: begins[1]], numbered[begins[1] :]))
    assert len(set(frame)) == len(frame) <= 12
    assert len(set(score)) == len(score) <= 8
    assert all((ROOT / path).exists() for path in (*frame, *score))
