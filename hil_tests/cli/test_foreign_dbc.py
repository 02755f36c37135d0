"""A DBC that does not match the port table: a user's, or that of the installation."""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path

import pytest

from hil_tests.support.cli import complaint, railhil
from hil_tests.support.paths import ROOT
from railhil import AT_TOP

DBC = ROOT / "dbc" / "railhil.dbc"


@pytest.mark.slow
def test_dbc_files(here):
    right = DBC.read_text()
    assert here("ports", "--dbc", DBC).exit_code == 0
    moved = "SG_ SpeedLife : 27|4@0+", "SG_ SpeedLife : 26|3@0+"
    unit = '(0.0001,0) [-838.86080000000004|838.86070000000007] "m/s"', '(0.0001,0) [-838|838] "km/h"'
    for change in (moved, unit):
        assert change[0] in right
    for text, words in (
        ("no dbc", "cannot be read"),
        ("", "cannot be read"),
        ('VERSION ""\nBS_:\nBU_: A\nBO_ 256 Foo: 8 A\n SG_ x : 0|8@1+ (1,0) [0|0] "" A\n', "missing"),
        (right.replace(*moved), "message TRN_SPEED (0x118): signal SpeedLife: start bit: found 26, allowed 27"),
        (right.replace(*unit), "signal TrainSpeed: unit: found 'km/h', allowed 'm/s'"),
        (right.replace("SpeedLife", "Speedlife"), "signal SpeedLife: missing"),
    ):
        Path("my.dbc").write_text(text)
        for command in ("ports", "run"):
            line = complaint(here(command, "--dbc", "my.dbc"))
            assert line.startswith("railhil: my.dbc: ")
            assert words in line
    assert "is a directory" in complaint(here("ports", "--dbc", "."))
    assert not Path("runs").exists()


def test_the_dbc_is_written_as_the_handshake_hashes_it(here):
    assert here("ports", "--write-dbc", "my.dbc").exit_code == 0
    assert Path("my.dbc").read_bytes() == DBC.read_bytes()
    assert here("ports", "--system", "stop", "--write-dbc", "my.dbc").exit_code == 0
    assert hashlib.sha256(Path("my.dbc").read_bytes()).hexdigest() in here("ports", "--system", "stop").out
    line = complaint(here("ports", "--write-dbc", "none/my.dbc"))
    assert "--write-dbc: the file none/my.dbc cannot be written: no such file or directory" in line


@pytest.mark.slow
def test_replaced_dbc_of_the_installation_is_noticed_by_every_command(tmp_path):
    for folder, place in (("railhil", ""), *((name, name) for name in AT_TOP)):
        shutil.copytree(ROOT / folder, tmp_path / "railhil" / place, ignore=shutil.ignore_patterns("__pycache__"))
    path = tmp_path / "railhil" / "dbc" / "railhil.dbc"
    path.write_text(path.read_text().replace("SpeedLife", "Speedlife"))
    for name in (["run"], ["scenarios"], ["node", "plant"]):
        done = railhil(*name, cwd=tmp_path, anew=True)
        assert "railhil.dbc: sha256: found " in complaint(done)
    assert not (tmp_path / "runs").exists()
