"""``railhil completion``: the script that shtab makes, in a real bash."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from railhil.cli.completion import script
from railhil.common.errors import InputError

_ASK = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMP_LINE="$*"; COMP_POINT=${#COMP_LINE}
$(complete -p railhil | sed 's/.*-F \\([^ ]*\\).*/\\1/')
printf '%s\\n' "${COMPREPLY[@]}"
"""


@pytest.fixture(scope="module")
def bash_script(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("completion") / "railhil.bash"
    path.write_text(script("bash"), encoding="utf-8")
    return path


@pytest.mark.skipif(shutil.which("bash") is None, reason="MISSING CAPABILITY bash")
@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        (("comp",), {"compare", "completion"}),
        (("run", "--s"), {"--seed", "--set"}),
        (("run", "yizhuang_0"), {f"yizhuang_0{number}" for number in range(1, 10)}),
        (("run", "--controller", "tp"), {"tpfc1", "tpfc2"}),
        (("tune", "ipfc_"), {"ipfc_plus"}),
        (("campaign", "--se"), {"--seed", "--set"}),
        (("score", "--js"), {"--json"}),
        (("new", ""), {"law", "scenario", "system"}),
        (("new", "scenario", "mine", "--extends", "yizhuang_0"), {"yizhuang_01", "yizhuang_09"}),
    ],
)
def test_bash_completes(bash_script: Path, tmp_path: Path, words: tuple[str, ...], wanted: set[str]) -> None:
    done = subprocess.run(
        ["bash", "-c", _ASK, "bash", str(bash_script), "railhil", *words],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
        cwd=tmp_path,
    )
    assert wanted <= set(done.stdout.split()), done.stdout + done.stderr


def test_zsh_has_a_script_too() -> None:
    assert script("zsh").startswith("#compdef railhil")


def test_without_shtab_one_line_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "shtab", None)
    with pytest.raises(InputError, match=r"shtab is not installed; install it with .* install 'shtab>=1.7'"):
        script("bash")
