"""The lateness of a run while it is made is that of its whole record."""

from __future__ import annotations

from array import array

import numpy as np
import pytest

from railhil.judge.jitter import arrivals_of
from railhil.live.live_values import RECENT, LiveLateness

TICK_NS = 10_000_000


def test_looks_during_the_run_find_what_one_look_at_its_record_finds() -> None:
    late_ns = np.random.default_rng(1).integers(0, 400_000, 3 * RECENT // 4)
    late_ns[[3, 200]] = 7_000_000, 0
    ticks, wall_ns = array("q"), array("q")
    one = LiveLateness(ticks, wall_ns)
    assert one.report(TICK_NS) is None
    for tick, late in enumerate(late_ns):
        ticks.append(tick)
        wall_ns.append(5_000_000_000 + tick * TICK_NS + int(late))
        if tick % 100 == 0:
            one.report(TICK_NS)
    found, whole = one.report(TICK_NS), arrivals_of(ticks, wall_ns, TICK_NS)
    assert found is not None
    assert found["cycles"] == whole.cycles
    assert found["worst_ms"] == whole.max_ms == 7.0
    assert found["p99_ms"] == pytest.approx(whole.p99_ms, abs=0.01)


def test_another_pace_of_the_plant_begins_anew() -> None:
    ticks, wall_ns = array("q", range(100)), array("q", range(0, 200 * TICK_NS, 2 * TICK_NS))
    one = LiveLateness(ticks, wall_ns)
    assert one.report(TICK_NS) == {"p99_ms": 990.0, "worst_ms": 990.0, "cycles": 100}
    assert one.report(2 * TICK_NS) == {"p99_ms": 0.0, "worst_ms": 0.0, "cycles": 100}
