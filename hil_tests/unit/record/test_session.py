"""What the supervisor records does not depend on how many frames arrive together."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.panel import Recorded
from railhil.bus.frame import ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.ident import Role
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame
from railhil.record.framelog import log_line
from railhil.record.session import make_session
from railhil.scenarios.run_spec import RunSpec

#: A telegram of the plant that is only recorded, with the flags of frames that are no telegrams.
_STRAY = [Frame(0x124, b"\xab" * 8, flags) for flags in (FD, EXTENDED, REMOTE, ERROR)]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    return Recorded(tmp_path_factory.mktemp("run"))


@pytest.mark.parametrize("together", [1, 3, 32, 100_000])
def test_frames_together_are_recorded_as_one_by_one(run: Recorded, tmp_path: Path, together: int) -> None:
    # Before the record begins nothing is kept; a stray frame is kept as it is.
    frames = [*_STRAY, *run.frames[:500], *_STRAY, *run.frames[500:]]
    one, many = [], []
    slow = make_session(run.scenario, one.append, RunSpec())
    answers = [answer for frame in frames for answer in slow.handle(frame)]
    fast = make_session(run.scenario, many.append, RunSpec())
    found = [
        answer for start in range(0, len(frames), together) for answer in fast.take(frames[start : start + together])
    ]
    assert "".join(many) == "".join(one)
    assert (found, fast.frames, fast.ended) == (answers, slow.frames, slow.ended)
    assert list(fast.wall_ticks) == list(slow.wall_ticks)
    assert len(answers) > 10
    assert fast.frames == len(one) > len(run.frames)
    assert sum(log_line(0, frame).partition("mvb0")[2] in "".join(many) for frame in _STRAY) == len(_STRAY)


def test_the_run_of_somebody_else_is_not_recorded(run: Recorded) -> None:
    """Its plant repeats PLT_IDENT; after a scan it is the handshake of another run."""
    lines: list[str] = []
    session = make_session(run.scenario, lines.append, RunSpec())
    ident = run.contract.port("PLT_IDENT").address
    places = [place for place, frame in enumerate(run.frames) if frame.can_id == ident]
    assert len(places) > 2
    assert session.take(run.frames[100:]) == []
    assert not session.recording
    session.handle(master_frame(F_DEVICE_STATUS, int(Role.SUPERVISOR)))
    session.take(run.frames[: places[1]])
    assert session.recording
    assert lines[0].split()[-2:] == log_line(0, run.frames[0]).split()[-2:]
