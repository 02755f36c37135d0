"""How near a train came to the speed that its protection permits, from the telegrams of its run."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hil_tests.support.lines import four_stops
from railhil.record.trace import Trace
from railhil.systems.line.judge.motion import Motion
from railhil.systems.line.judge.protection import ProtectionRecord
from railhil.wire.line import AtpLim, AtpStatus

LINE = four_stops()
#: Deceleration and end of the permitted speed's curve, ceiling.
BRAKING_MPS2, FOOT_M, CEILING_MPS = 0.8, 1010.0, 20.0


def permitted_mps(position_m: float) -> float:
    return min(CEILING_MPS, sqrt(2 * BRAKING_MPS2 * max(0.0, FOOT_M - position_m)))


def braking(margin_m: float, speed_mps: float = 18.0) -> tuple[Motion, Trace]:
    """A run at an even speed that then brakes on the permitted curve, shifted to the rear."""
    dt, position_m, now = 0.02, 0.0, speed_mps
    rows = []
    while now > 0.05 and len(rows) < 20_000:
        rows.append((len(rows) * dt, position_m, now))
        most = sqrt(2 * BRAKING_MPS2 * max(0.0, FOOT_M - margin_m - position_m))
        now = min(speed_mps, most)
        position_m += now * dt
    time_s, positions, speeds = np.array(rows).T
    zero = np.zeros_like(time_s)
    trace = Trace(LINE.installed_system.contract)
    for place in range(0, len(time_s), 4):
        data = AtpLim(permitted_4mmps=round(permitted_mps(positions[place]) / 0.004), life=place // 4 % 16).encode()
        trace.add(AtpLim.PORT, round(time_s[place] * 1e9), data)
    return Motion(time_s, positions, speeds, zero, zero, zero), trace


@given(margin_m=st.floats(0.5, 60.0), speed_mps=st.floats(5.0, 19.0))
def test_the_nearest_approach_is_the_distance_between_the_curves(margin_m: float, speed_mps: float) -> None:
    """The curve is known as far as the train goes: where it stops, the permitted speed must be below its own."""
    assume(permitted_mps(FOOT_M - margin_m) < speed_mps - 0.5)
    motion, trace = braking(margin_m, speed_mps)
    found = ProtectionRecord(trace).nearest_m(motion, 0.0, float(motion.time_s[-1]))
    assert found == pytest.approx(margin_m, abs=0.6)


def test_a_train_at_the_permitted_speed_has_no_distance_left() -> None:
    motion, trace = braking(-5.0)
    assert ProtectionRecord(trace).nearest_m(motion, 0.0, float(motion.time_s[-1])) == 0.0


def test_there_is_no_distance_where_the_permitted_speed_never_comes_down() -> None:
    motion, trace = braking(20.0)
    early_s = float(motion.time_s[np.searchsorted(motion.position_m, 100.0)])
    assert ProtectionRecord(trace).nearest_m(motion, 0.0, early_s) is None


def test_the_level_of_an_interval_is_one_that_two_telegrams_show() -> None:
    trace = Trace(LINE.installed_system.contract)
    for place, status in enumerate((0, 1, 1, 3, 0)):
        trace.add(AtpLim.PORT, place * 80_000_000, AtpLim(status=AtpStatus(status), life=place).encode())
    found = ProtectionRecord(trace)
    assert found.level(0.0, 1.0) == "indication"
    assert found.level(2.0, 3.0) == ""
    assert [spell.telegrams for spell in found.warnings()] == [1]
