"""The path of a stranger: every command of the tutorial, from the clone on, with nothing but Python, git and make."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import time
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from hil_tests.documents.commands import lines_of
from hil_tests.documents.pages import Block, blocks_of, read
from hil_tests.support.paths import ROOT
from hil_tests.support.venvs import base_python, project

_PAGES = ("docs/tutorial/first_run.md", "docs/tutorial/own_line_and_law.md")
#: What every Linux has beside Python, git and make.
_SYSTEM = (
    *(
        "awk",
        "basename",
        "bash",
        "cat",
        "chmod",
        "cp",
        "date",
        "dirname",
        "env",
        "expr",
        "grep",
        "head",
        "id",
        "ln",
        "ls",
    ),
    *("mkdir", "mv", "nproc", "readlink", "rm", "sed", "sh", "sort", "tail", "touch", "tr", "uname", "wc"),
)
#: Variables of the machine that lead to a package index.
_KEPT = re.compile(r"PIP_|.*CERT|SSL_|.*_proxy$|.*_PROXY$|LANG$|HOME$")
_MARK = "\x01"
_TIMEOUT_S = 900
#: A page says "Save this as `NAME`".
_SAVED = re.compile(r"Save this as\s+`([^`]+)`")
#: A server that waits for the reader.
_SERVES = "railhil panel"


def _blocks() -> Iterator[tuple[Block, str]]:
    """What a reader types or saves, in the order of the pages; of a test file also its name."""
    for page in _PAGES:
        name = ""
        for block in blocks_of(page, read(page)):
            if found := _SAVED.search(block.text):
                name = found[1]
            elif block.kind == "fence":
                yield block, name if block.info[0] == "python" else ""


def _commands(block: Block) -> list[str]:
    if block.info[0] == "console":
        return [line[2:] for line in block.lines if line.startswith("$ ")]
    return [line for line in lines_of(block.lines) if not line.startswith(_SERVES)]


def _exit_code(block: Block, command: str) -> int:
    """What the page shows below a command: FAIL, one line about bad input, or neither."""
    after = block.text.partition(f"$ {command}\n")[2].partition("\n$ ")[0]
    return 1 if re.search("^FAIL", after, re.M) else 2 if after.startswith("railhil: ") else 0


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A folder of programs: Python, git, make and those of any Linux."""
    programs = tmp_path / "bin"
    programs.mkdir()
    for name in ("git", "make", *_SYSTEM):
        found = shutil.which(name)
        assert found is not None, name
        (programs / name).symlink_to(found)
    (programs / "python3").symlink_to(base_python())
    return programs


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.timeout(_TIMEOUT_S + 60)
def test_a_stranger_comes_from_the_clone_to_tests_of_a_line_and_a_law(
    path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    script, expected = "", []
    for block, name in _blocks():
        if name:
            script += f"cat >{name} <<'END'\n{block.text}\nEND\n"
            continue
        for line in _commands(block):
            script += f"{line}\nprintf '{_MARK}%s %s{_MARK}' $? $EPOCHREALTIME\n"
            expected.append((line, _exit_code(block, line)))
    # The address of the project, wherever this tree lies.
    address = {"GIT_CONFIG_COUNT": "1", "GIT_CONFIG_VALUE_0": project()["urls"]["Homepage"]}
    address["GIT_CONFIG_KEY_0"] = f"url.{ROOT.as_uri()}.insteadOf"
    kept = {name: value for name, value in os.environ.items() if _KEPT.match(name)}
    begun_s = time.time()
    done = subprocess.run(
        [path / "bash", "-c", script], cwd=tmp_path, env={**kept, **address, "PATH": str(path)}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, timeout=_TIMEOUT_S, check=False,
    )  # fmt: skip
    said, *marks = done.stdout.split(_MARK)
    times_s = {"": begun_s}
    for (line, code), mark, after in zip(expected, marks[::2], marks[1::2], strict=True):
        found, now_s = mark.split()
        assert int(found) == code, f"{line}: ended with {found}\n{said}"
        times_s[line], said = float(now_s), after
    passed = {junit: _junit(tmp_path / "trial" / junit) for junit in ("junit.xml", "my_line.xml")}
    assert passed == {"junit.xml": 2, "my_line.xml": 5}
    with capsys.disabled():
        print(f"\nfrom an empty folder, with Python, git and make:{_milestones(times_s)}")


def _junit(path: Path) -> int:
    """Number of tests of a report, of which none has failed."""
    cases = list(ET.parse(path).iter("testcase"))
    assert not any(len(case.findall("failure") + case.findall("error") + case.findall("skipped")) for case in cases)
    return len(cases)


#: What a stranger wants -> the command at whose end he has it, and the one at whose end he began.
_WANTED = {
    "clone to verdict": ("make run", ""),
    "own line to verdict": ("railhil run my_line.toml --controller ipfc_plus", "pytest test_speed_loss.py"),
    "own law to verdict": ("railhil run my_line.toml --controller mylaw", "railhil run my_line.toml --set"),
    "own test to JUnit": ("pytest test_my_line.py", "railhil run my_line.toml --controller mylaw"),
    "the whole tutorial": ("pytest test_my_line.py", ""),
}


def _milestones(times_s: Mapping[str, float]) -> str:
    def end_s(beginning: str) -> float:
        return next(time_s for line, time_s in times_s.items() if line.startswith(beginning))

    return "".join(f" {name} {end_s(last) - end_s(first):.0f} s;" for name, (last, first) in _WANTED.items())
