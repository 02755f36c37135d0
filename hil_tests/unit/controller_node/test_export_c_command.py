"""``railhil export-c``: same bytes each time, one line for bad input, nothing lost."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from railhil.common.errors import InputError
from railhil.controller_node.export import make_bundle, write_bundle
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec


@pytest.mark.slow
def test_same_law_and_scenario_give_the_same_bytes(tmp_path: Path) -> None:
    """In two processes, whose hash order differs; nothing in the files says where or when they were written."""
    for name in ("one", "two"):
        assert railhil("export-c", "ipfc", "--out", tmp_path / name).exit_code == 0
    names = sorted(path.name for path in (tmp_path / "one").iterdir())
    assert names == sorted(
        [
            "Makefile",
            "controller.toml",
            "README.md",
            "ipfc.c",
            "ipfc.h",
            "ipfc_log.txt",
            "ipfc_mailboxes.h",
            "ipfc_node.h",
            "railhil_clock.c",
            "railhil_clock.h",
            "railhil_control.c",
            "railhil_control.h",
            "railhil_filters.h",
            "railhil_guard.c",
            "railhil_guard.h",
            "railhil_iq.h",
            "railhil_law.c",
            "railhil_law.h",
            "railhil_motion.c",
            "railhil_motion.h",
            "railhil_mvb.h",
            "railhil_node.c",
            "railhil_pipe.c",
            "railhil_pipe.h",
            "railhil_ports.h",
            "railhil_position.c",
            "railhil_position.h",
            "railhil_result.h",
            "railhil_run.c",
            "railhil_safe.h",
            "railhil_slcan.c",
            "railhil_socket.c",
            "railhil_socket.h",
            "railhil_telegrams.c",
        ]
    )
    for name in names:
        data = (tmp_path / "one" / name).read_bytes()
        assert data == (tmp_path / "two" / name).read_bytes()
        assert str(tmp_path).encode() not in data


@pytest.mark.slow
def test_bad_input_is_one_line_and_exit_code_2(tmp_path: Path) -> None:
    full = tmp_path / "full"
    full.mkdir()
    (full / "mine.txt").write_text("mine")
    refusals: tuple[tuple[tuple[str | Path, ...], str], ...] = (
        (("ipfcc", "--out", tmp_path / "new"), "did you mean ipfc?"),
        (("ipfc", "nowhere", "--out", tmp_path / "new"), "scenario: name: found 'nowhere'"),
        (("ipfc",), "--out"),
        (("delay_qp", "hst_short", "--out", tmp_path / "new"), "this law is computed by a solver"),
        (("ipfc", "--out", full), "full: is not empty, expected an empty or new folder (--force"),
    )
    for arguments, words in refusals:
        done = railhil("export-c", *arguments)
        assert done.exit_code == 2
        assert words in done.one_line()
    assert not (tmp_path / "new").exists()
    assert [path.name for path in full.iterdir()] == ["mine.txt"]


def test_folder_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    """A file in its place, a file above it, and files that cannot be put in place: nothing half-written stays."""
    bundle = make_bundle(load("lvshun_tieshan"), LawSpec())
    (tmp_path / "file").write_text("mine")
    for folder, words in ((tmp_path / "file", "file exists"), (tmp_path / "file" / "below", "not a directory")):
        with pytest.raises(InputError, match=f"{folder}: cannot be written: {words}"):
            write_bundle(bundle, folder)
    blocked = tmp_path / "blocked"
    (blocked / "ipfc.c" / "in the way").mkdir(parents=True)
    with pytest.raises(InputError, match="blocked: cannot be written: is a directory"):
        write_bundle(bundle, blocked, force=True)
    assert [path.name for path in blocked.iterdir()] == ["ipfc.c"]


@pytest.mark.slow
def test_force_writes_beside_what_is_there(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / "ipfc.c").write_text("old")
    done = railhil("export-c", "ipfc", "--out", tmp_path, "--force")
    assert done.exit_code == 0, done.err
    assert (tmp_path / "mine.txt").read_text() == "mine"
    assert "ipfc_step" in (tmp_path / "ipfc.c").read_text()
    assert not [path for path in tmp_path.iterdir() if path.is_dir()]
    listed = {
        line.split()[0]: int(line.split()[1]) for line in done.out.splitlines() if re.match(r"\S+\s+\d+\s*$", line)
    }
    assert listed == {path.name: path.stat().st_size for path in tmp_path.iterdir() if path.name != "mine.txt"}
    assert "not run on a C28x" in done.out
