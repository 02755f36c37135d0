"""Settings of the environment that are there but wrong, and a user without rights: one line, exit code 2."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT
from railhil.scenarios.run_document import ENVIRONMENT, OTHER_VARIABLES
from railhil.testing.settings import OPTIONS

#: Root without its right to pass over the permissions of files. Another user might not be allowed to enter the folders
#: of Python and of this tree.
_WITHOUT_RIGHT = ("setpriv", "--bounding-set", "-dac_override,-dac_read_search")


def locked_out(*words: str, home: Path) -> subprocess.CompletedProcess[str]:
    """A command of a user who may not enter the folder ``home``."""
    home.chmod(0)
    user = _WITHOUT_RIGHT if os.geteuid() == 0 else ()
    return subprocess.run(
        [*user, sys.executable, *words], env={**os.environ, "HOME": str(home)}, cwd="/", capture_output=True, text=True,
        check=False,
    )  # fmt: skip


@pytest.mark.slow
def test_the_home_of_somebody_else_has_no_settings(tmp_path: Path) -> None:
    asked = "from railhil.bus.can_settings import has_settings; print(has_settings({}))"
    assert locked_out("-c", asked, home=tmp_path).stdout == "False\n"


@pytest.mark.long_after(1)
@pytest.mark.slow
@pytest.mark.parametrize("words", ["scenarios {}/x.toml", "score {}/run", "memory show {}/store", "panel {}/run"])
def test_a_path_that_the_user_may_not_look_at_is_bad_input(tmp_path: Path, words: str) -> None:
    found = locked_out("-m", "railhil.cli", *words.format(tmp_path).split(), home=tmp_path)
    assert found.returncode == 2, found.stderr
    assert re.fullmatch(r"railhil.*: (cannot be read: )?permission denied, expected .*\n", found.stderr)


def test_every_variable_that_something_reads_is_known() -> None:
    """So that a run may refuse any other name."""
    read = {f"RAILHIL_{name.replace('-', '_').upper()}" for name in OPTIONS}
    folders = ("bus", "controller_node", "plant_sim", "hil_tests", "railhil")
    sources = [path for folder in folders for path in (ROOT / folder).rglob("*.py")]
    sources += [*ROOT.glob("*.py"), *ROOT.glob("docker-compose*.yml")]
    for path in sources:
        text = path.read_text(encoding="utf-8")
        read |= {*re.findall(r"(?:environ\b[^\n]*|_VARIABLE = [^\n]*|\$\{)\"?(RAILHIL_[A-Z_]+)", text)}
    assert "RAILHIL_PURE" in read
    assert "RAILHIL_UID" in read
    assert read <= {*ENVIRONMENT.values(), *OTHER_VARIABLES}
