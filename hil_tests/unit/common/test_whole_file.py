"""Files named by the user are written completely or not at all, and replace only regular files."""

from __future__ import annotations

import gc
import json
import os
import signal
import threading
from pathlib import Path

import pytest

from railhil.bus.errors import BusLost
from railhil.bus.link import Link
from railhil.common.exit_codes import INVALID, run_guarded
from railhil.common.user_files import check_writable, whole_file
from railhil.controller_node import command as controller
from railhil.controller_node.ato.node import ControllerNode
from railhil.controller_node.telemetry_file import write_telemetry
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario


def write(path: Path, text: str = "new") -> None:
    with whole_file(path) as draft:
        draft.write_text(text)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("name", ["tel.part", "a.json", "keep", ".part-a.json"])
def test_a_file_of_any_name_and_none_beside_it(tmp_path: Path, name: str) -> None:
    (tmp_path / "a.part").write_text("of somebody else")
    check_writable(tmp_path / name)
    assert names(tmp_path) == ["a.part"]
    for text in ("first", "second"):
        write(tmp_path / name, text)
        assert (tmp_path / name).read_text() == text
    assert names(tmp_path) == sorted(["a.part", name])
    assert (tmp_path / "a.part").read_text() == "of somebody else"


def test_two_at_a_time_do_not_share_a_draft(tmp_path: Path) -> None:
    with whole_file(tmp_path / "a.json") as one, whole_file(tmp_path / "a.json") as other:
        one.write_text("one")
        other.write_text("other")
        assert not (tmp_path / "a.json").exists()
    assert (tmp_path / "a.json").read_text() == "one"
    assert names(tmp_path) == ["a.json"]


def test_what_was_there_stays_when_the_block_fails(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text("old")

    def fail() -> None:
        with whole_file(path) as draft:
            draft.write_text("half of")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert path.read_text() == "old"
    assert names(tmp_path) == ["a.json"]


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    for target in ("there", "new"):
        (tmp_path / target).symlink_to(Path("real") / target)
    (tmp_path / "real" / "there").write_text("old")
    for target in ("there", "new"):
        check_writable(tmp_path / target)
        write(tmp_path / target)
        assert (tmp_path / target).is_symlink()
        assert (tmp_path / "real" / target).read_text() == "new"
    assert names(tmp_path / "real") == ["new", "there"]


def test_permissions_of_the_old_file_or_of_a_new_one(tmp_path: Path) -> None:
    (tmp_path / "old").write_text("old")
    (tmp_path / "old").chmod(0o640)
    mask = os.umask(0o027)
    try:
        (tmp_path / "usual").write_text("")
        write(tmp_path / "old")
        write(tmp_path / "new")
    finally:
        os.umask(mask)
    assert (tmp_path / "old").stat().st_mode & 0o777 == 0o640
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "usual").stat().st_mode


@pytest.fixture
def pipe(tmp_path: Path) -> Path:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    return path


def read_in_background(pipe: Path) -> tuple[threading.Thread, list[str]]:
    found: list[str] = []
    # A daemon: when nobody ever opens the pipe, the test fails and the thread goes with it.
    reader = threading.Thread(target=lambda: found.append(pipe.read_text()), daemon=True)
    reader.start()
    return reader, found


def test_a_pipe_and_a_device_are_written_to(pipe: Path) -> None:
    check_writable(pipe)
    reader, found = read_in_background(pipe)
    write(pipe, "through")
    reader.join(5)
    assert found == ["through"]
    assert pipe.is_fifo()
    null = pipe.with_name("null")
    # Even through a link: as root, a rename would take the machine's own device away.
    null.symlink_to("/dev/null")
    check_writable(null)
    write(null)
    assert null.is_char_device()
    assert names(pipe.parent) == ["null", "pipe"]


def test_the_telemetry_goes_through_a_pipe(lvshun: Scenario, pipe: Path) -> None:
    reader, found = read_in_background(pipe)
    write_telemetry(ControllerNode(lvshun, LawSpec()), pipe)
    reader.join(5)
    assert found
    assert found[0].startswith('{\n  "law": "ipfc"')
    assert pipe.is_fifo()


def test_telemetry_survives_a_sigterm_while_it_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The bus is gone, the controller writes, and only then does the supervisor end it."""

    def lost(node: ControllerNode, link: Link, **_: float) -> int:
        raise BusLost("hub closed the connection")

    def terminated(node: ControllerNode) -> dict[str, int]:
        os.kill(os.getpid(), signal.SIGTERM)
        return {"steps": 7}

    path, handler = tmp_path / "telemetry.json", signal.getsignal(signal.SIGTERM)
    words = ["--telemetry", str(path), "-i", "virtual"]
    monkeypatch.setattr("railhil.controller_node.command.run_controller", lost)
    monkeypatch.setattr("railhil.controller_node.telemetry_file.telemetry_document", terminated)
    try:
        assert run_guarded("controller", lambda: controller.main(words)) == INVALID
    finally:
        signal.signal(signal.SIGTERM, handler)
        gc.unfreeze()
        gc.enable()
    assert json.loads(path.read_text(encoding="utf-8")) == {"steps": 7}


def test_what_cannot_be_written_is_said_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "round").symlink_to("round")
    for name, error in (
        (".", IsADirectoryError),
        ("gone/a.json", FileNotFoundError),
        ("file/a.json", NotADirectoryError),
        ("round", OSError),
    ):
        with pytest.raises(error):
            check_writable(tmp_path / name)
    assert names(tmp_path) == ["file", "round"]


def test_a_write_protected_file_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder would let us replace it."""
    path = tmp_path / "a.json"
    path.write_text("old")
    asked = []
    monkeypatch.setattr("os.access", lambda *given: asked.append(given))
    with pytest.raises(PermissionError):
        check_writable(path)
    assert asked == [(path, os.W_OK)]
