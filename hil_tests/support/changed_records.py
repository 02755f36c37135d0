"""The record of a short run, and what can go wrong with one."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import strategies as st

from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.bench import local_run
from railhil.bus.frame import Frame
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame
from railhil.record.framelog import read_log
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec
from railhil.systems.ato.scenario.model import Scenario

Recorded = list[tuple[int, Frame]]


@cache
def short_scenario(*faults: str) -> Scenario:
    """2 m."""
    with TemporaryDirectory() as name:
        path = Path(name) / "short.toml"
        path.write_text(RUN_2M_TOML, encoding="utf-8")
        return load(str(path), faults=faults)


@cache
def recorded(*faults: str) -> tuple[tuple[int, Frame], ...]:
    """A run of 2 m."""
    with TemporaryDirectory() as name:
        run = local_run(short_scenario(*faults), Path(name), RunSpec())
        assert run.log is not None
        return tuple(read_log(run.log))


@st.composite
def changed_records(draw: st.DrawFn, record: Callable[[], tuple[tuple[int, Frame], ...]], lines: int) -> Recorded:
    """So many lines of a record with frames lost, repeated, exchanged, late, foreign or with another bit."""
    start = draw(st.integers(0, max(0, len(record()) - lines)))
    frames = list(record()[start : start + lines])
    for _ in range(draw(st.integers(0, 3))):
        at, other = draw(st.integers(0, len(frames) - 2)), draw(st.integers(0, len(frames) - 1))
        time_ns, frame = frames[at]
        kind = draw(st.sampled_from(("lost", "again", "before", "late", "bit", "length", "id", "poll", "far")))
        if kind == "lost":
            del frames[at]
        elif kind == "again":
            frames.insert(at, frames[at])
        elif kind == "before":
            frames[at], frames[at + 1] = frames[at + 1], frames[at]
        elif kind == "far":
            frames[at], frames[other] = frames[other], frames[at]
        elif kind == "late":
            frames[at] = time_ns + draw(st.sampled_from((1000, 4_999_000, 5_000_000, 5_001_000))), frame
        elif kind == "bit" and frame.data:
            data = bytearray(frame.data)
            data[draw(st.integers(0, len(data) - 1))] ^= 1 << draw(st.integers(0, 7))
            frames[at] = time_ns, Frame(frame.can_id, bytes(data))
        elif kind == "length":
            frames[at] = time_ns, Frame(frame.can_id, frame.data[: draw(st.integers(0, 7))])
        elif kind == "id":
            frames[at] = time_ns, Frame(frame.can_id + draw(st.integers(-5, 5)) & 0x7FF, frame.data)
        else:
            frames.insert(at, (time_ns, master_frame(draw(st.sampled_from((0, 1, 3, F_DEVICE_STATUS))), 0x123)))
    return frames
