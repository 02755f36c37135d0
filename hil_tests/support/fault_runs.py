"""Runs with faults of the catalogue that are repeated on every transport, and what each of them must show."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from railhil.bus.codes import Event
from railhil.dbc import wire_contract
from railhil.judge.events.event import LEVEL, RecordedEvent
from railhil.judge.events.telegrams import events_of
from railhil.judge.result import Result
from railhil.record.framelog import read_log
from railhil.record.trace import trace_of
from railhil.scenarios.load import load
from railhil.scenarios.model import AnyScenario

#: 590 m in 49 s, up to 75 km/h: the train passes 60 km/h at 20.3 s.
FAST_TOML = """\
extends = "lvshun_tieshan"
name = "fast"
title = "590 m in 49 s"
[target]
nodes_s_mps2 = [[0, 1.0], [20.9, 1.0], [21.1, 0], [28, 0], [28.2, -1.0], [49.1, -1.0]]
[plan]
distance_m = 590.0967
running_time_s = 49.1
overtime_max_s = 1
"""
KILL = "controller kill @v>60km/h"
#: Entries T2a, T2b, T11 and N1 of the catalogue in one run, which ends without a controller.
KILLED = (
    "TRN_SPEED loss @8s for 40ms",
    "TRN_SPEED loss @10s for 250ms",
    "TRN_SPEED corrupt 30% bits 1 @12s for 1s",
    KILL,
)
#: Entries N2, N3, C2 and T3 in one run, which ends at standstill.
BRAKED = (
    "controller stop @4s for 400ms",
    "controller restart @6s for 500ms",
    "NOTCH_CMD.EmergencyBrake raw 2 @8s x1",
    "TRN_SPEED loss @8500ms",
)


class Made(NamedTuple):
    """A run in its folder: exit code, the reason of the verdict and the hash of the record."""

    folder: Path
    exit_code: int
    line: str
    frames_sha256: str

    @classmethod
    def of(cls, folder: Path, result: Result) -> Made:
        """A run made in this process."""
        return cls(folder, result.exit_code, result.line, result.frames_sha256)


def fast(folder: Path, *faults: str) -> AnyScenario:
    """The scenario with faults; its file is ``fast.toml`` in a folder."""
    path = folder / "fast.toml"
    path.write_text(FAST_TOML, encoding="utf-8")
    return load(path, (), faults)


def levels(scenario: AnyScenario, folder: Path, watch: str) -> list[RecordedEvent]:
    """What a watch (``train``, ``controller``) reported in a run folder."""
    events = events_of(scenario, trace_of(read_log(folder / "frames.log"), wire_contract()))
    return [event for event in events if event.source == watch and event.kind == LEVEL]


def assert_stopped_by_its_own_watch(
    scenario: AnyScenario, made: Made, late_s: float = 0.0, killed_kmh: float = 60.0
) -> None:
    """The controller was killed at this speed: each level of the train's watch in its time, standstill, a whole record
    that ends with the run, and a run that was judged and failed.

    :param late_s: real time: answers that were missed before.
    """
    trace = trace_of(read_log(made.folder / "frames.log"), wire_contract())
    truth_s, speed_mps = trace.times_s("SIM_TRUTH"), trace.values("SIM_TRUTH", "TrueSpeed")
    killed_s = float(truth_s[speed_mps >= killed_kmh / 3.6][0])
    after = [event for event in levels(scenario, made.folder, "train") if event.time_s > killed_s - 0.05]
    if late_s:
        after = after[-4:]
    assert [event.level for event in after] == ["hold", "traction_cut", "service_brake", "emergency"]
    assert {event.cause for event in after} == {"command_age"}
    for event, limit_s in zip(after, (0.02, 0.064, 0.256, 1.0), strict=True):
        assert -0.02 - late_s <= event.time_s - killed_s - limit_s <= 0.02 + 1e-9, event
    assert trace.values("SIM_TRUTH", "TractionForce")[truth_s > killed_s + 0.1].max() == 0
    assert speed_mps[-1] == 0
    ended = [Event(number) for number in trace.raw("RUN_EVENT", "RunEvent")]
    assert (Event.STOPPED in ended, ended[-1]) == (True, Event.ENDED_CONTROLLER_LOST)
    steps_s = np.diff(truth_s[1:-1])
    assert steps_s.max() == pytest.approx(steps_s.min()), "nothing is missing in the record"
    assert made.exit_code != 0
    # In real time a machine that was late says so instead, beside what the recorder could then not follow.
    assert made.line.startswith("controller lost; ") or (late_s and "timing: " in made.line), made.line
