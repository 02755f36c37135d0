"""A panel that follows the record of a run while it grows."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from railhil.bus.errors import BusLost, BusUnavailable
from railhil.bus.frame import FD, Frame
from railhil.bus.select import choose_bus
from railhil.common.errors import InputError
from railhil.panel import receiver as receivers
from railhil.panel.command import arguments
from railhil.panel.receiver import LogFollower, Receiver
from railhil.record.framelog import LOG_NAME, log_line
from railhil.run.node_commands import gets_pipes

pytest.importorskip("websockets", reason="MISSING CAPABILITY websockets")

from railhil.panel.service import serve_panel

FRAMES = [Frame(0x100 + number % 8, bytes([number & 0xFF] * (number % 9))) for number in range(1000)]
LINES = [log_line(number * 10_000_000, frame).encode() for number, frame in enumerate(FRAMES)]


def write(folder: Path, text: bytes) -> None:
    with (folder / LOG_NAME).open("ab") as stream:
        stream.write(text)


def looked(receiver: Receiver) -> list[Frame]:
    """All that can be had in several looks."""
    heard: list[Frame] = []
    while frames := receiver.look():
        assert len(frames) < 80
        heard += frames
    return heard


def test_it_has_every_frame_however_the_log_grows(tmp_path: Path) -> None:
    text = b"".join(LINES)
    write(tmp_path, b"")
    run, found, at = LogFollower(tmp_path), list[Frame](), 0
    for size in (1, 10, 43, 44, 1000, 7, len(text)):
        write(tmp_path, text[at : at + size])
        found += run.receive()
        at += size
    assert found == FRAMES
    assert run.receive() == []
    assert not run.counters["rx_lost"]
    run.close()


def test_frames_of_other_kinds_are_read_one_by_one(tmp_path: Path) -> None:
    frame = Frame(0x110, bytes(12), FD)
    write(tmp_path, LINES[3] + log_line(0, frame).encode())
    assert LogFollower(tmp_path).receive() == [FRAMES[3], frame]


@pytest.mark.parametrize("before", [0, 10, 500])
def test_what_is_too_much_is_left_out_and_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, before: int) -> None:
    """As after a SIGSTOP of the panel: the oldest frames are left out, and the newest are whole."""
    monkeypatch.setattr(receivers, "LOOK_BYTES", 2048)
    monkeypatch.setattr(receivers, "BACKLOG_BYTES", 8192)
    monkeypatch.setattr(receivers, "_SKIP_BYTES", 1000)
    write(tmp_path, b"".join(LINES[:before]))
    receiver = Receiver({}, lambda config, name: LogFollower(tmp_path), waits=True)
    heard = looked(receiver)
    dropped = receiver.dropped
    assert len(heard) + dropped == before
    # A line that is not finished.
    write(tmp_path, LINES[before][:20])
    receiver.look()
    write(tmp_path, LINES[before][20:] + b"".join(LINES[before + 1 :]))
    heard = looked(receiver)
    assert 100 < len(heard) < 300
    assert heard == FRAMES[-len(heard) :]
    assert receiver.dropped - dropped + len(heard) == len(FRAMES) - before


def test_a_run_that_has_not_begun_is_waited_for(tmp_path: Path) -> None:
    receiver = Receiver({}, lambda config, name: LogFollower(tmp_path), waits=True)
    assert receiver.look() == []
    assert receiver.trouble == f"run {tmp_path} has not begun"
    write(tmp_path, LINES[0])
    receiver._retry_s = 0.0
    assert receiver.look() == FRAMES[:1]
    assert receiver.trouble == ""


def test_something_else_is_no_record(tmp_path: Path) -> None:
    write(tmp_path, b"no frame\n")
    with pytest.raises(BusLost, match=r"frames\.log: found lines that are no frames"):
        LogFollower(tmp_path).receive()
    (tmp_path / LOG_NAME).unlink()
    (tmp_path / LOG_NAME).mkdir()
    with pytest.raises(BusUnavailable, match="is a directory"):
        LogFollower(tmp_path)


def test_a_bus_and_a_record_are_refused_together(tmp_path: Path) -> None:
    words = ["--follow", str(tmp_path), "-i", "railhil", "-c", "x.sock"]
    with pytest.raises(InputError, match=r"--follow: cannot be given with -i railhil -c x\.sock or any other option"):
        serve_panel(arguments().parse_args(words))


def test_a_word_that_names_nothing_could_have_been_a_run_folder() -> None:
    with pytest.raises(
        InputError, match=r"SCENARIO\|RUN: found 'nosuch', allowed a run folder, a path ending in \.toml"
    ):
        serve_panel(arguments().parse_args(["nosuch"]))


@pytest.mark.parametrize(
    ("options", "gets"),
    [({}, True), ({"interface": "railhil"}, False)],
)
def test_a_run_in_lockstep_needs_no_hub(tmp_path: Path, options: dict[str, object], gets: bool) -> None:
    assert gets_pipes(options, choose_bus(options, tmp_path / "hub", vcan=False)) is gets


@pytest.mark.slow
def test_a_panel_starts_without_python_can() -> None:
    """Its import loads every log format; the start of a panel falls into that of the run."""
    code = "import sys, railhil.panel.command as c, railhil.panel.service; c.arguments().parse_args(['--follow', 'x'])"
    code += "; print([name for name in ('can', 'cantools', 'pandas') if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
