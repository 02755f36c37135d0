"""The track side orders a profile for a section: the controller keeps it, and is excused for what it takes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import railhil
from railhil.systems.line.scenario.sections import ordered_time_s
from railhil.wire.line import AtoProfile, AtoStat, ModeOrder, StnInfo

pytestmark = pytest.mark.slow

ORDERED_TOML = """extends = "four_stops"
name = "ordered"
[route]
dwell_disturbance_s = [0, 0]
hold = { probability = 0, extra_s = [0, 0] }
profiles_percent = [7, 9, 25]
stops = [
    { name = "A", position_m = 0, platform = "left", depart_s = 30, mode = "economy" },
    { name = "B", position_m = 1200, platform = "left", arrive_s = 137, depart_s = 167, mode = "fast" },
    { name = "D", position_m = 3420, platform = "right", arrive_s = 340, service = "terminal" },
]
"""


def test_sections_are_run_in_the_time_of_the_ordered_profiles_and_the_run_passes(tmp_path: Path) -> None:
    file = tmp_path / "ordered.toml"
    file.write_text(ORDERED_TOML)
    run = railhil.run(file, out=tmp_path / "run")
    assert run.verdict == "PASS", run.score.failures
    line = run.scenario
    told = run.trace.raw(StnInfo.PORT, "ModeOrder")
    assert [int(one) for one in told[np.flatnonzero(np.diff(told, prepend=-1))]] == [
        ModeOrder.ECONOMY, ModeOrder.FAST, ModeOrder.TIMETABLE,
    ]  # fmt: skip
    for number, profile in ((1, AtoProfile.ECONOMY), (2, AtoProfile.FAST)):
        here = run.trace.raw(AtoStat.PORT, "AtoSection") == number
        assert set(run.trace.raw(AtoStat.PORT, "AtoProfile")[here].tolist()) == {int(profile)}
    for stop, section, mode in zip(run.score.stops[1:], line.sections, ("economy", "fast"), strict=True):
        wanted_s = ordered_time_s(line, section, mode)
        assert stop.section.chosen_s == pytest.approx(wanted_s, abs=0.06)
        assert stop.section.made_s == pytest.approx(wanted_s, abs=0.5)
    late, early = run.score.stops[1:]
    assert late.late_s > 5.0
    assert early.late_s < -5.0
