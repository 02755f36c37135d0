"""A whole run of a line whose controller heeds the train protection: traction is off before the permitted speed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import railhil
from railhil.wire.ato import NotchCmd
from railhil.wire.line import AtpLim, AtpStatus

# The run misses its stop, which the node counts.
pytestmark = [pytest.mark.slow, pytest.mark.faults]

#: 300 m with a limit of 40 km/h, which a driver with constant traction reaches.
SHORT_TOML = """extends = "four_stops"
name = "short"
[line]
grade_permil = [[-118, 0]]
speed_limit_kmh = [[-118, 40]]
[route]
overtime_max_s = 5
dwell_disturbance_s = [0, 0]
stops = [
    { name = "A", position_m = 0, platform = "left", depart_s = 5 },
    { name = "B", position_m = 300, platform = "left", arrive_s = 60, service = "terminal" },
]
"""
_TRACTION, _BRAKE, _BRAKES_AT_M = 2.0, -4.0, 200.0


def push(reading: Any) -> float:
    """Constant traction, then brakes: it does not look at any limit."""
    return _TRACTION if reading.position_m < _BRAKES_AT_M else _BRAKE


def driven(folder: Path, heeds: bool) -> Any:
    file = folder / "short.toml"
    file.write_text(SHORT_TOML)
    settings = [f"atp.heed_atp={str(heeds).lower()}"]
    return railhil.run(file, controller=push, settings=settings, out=folder / f"heeds_{heeds}")


def first_s(run: Any, port: str, marked: Any) -> float:
    return float(run.trace.times_s(port)[np.flatnonzero(marked)[0]])


def test_a_controller_that_heeds_the_protection_takes_traction_off_before_the_permitted_speed(tmp_path: Path) -> None:
    runs = {heeds: driven(tmp_path, heeds) for heeds in (False, True)}
    off_s, over_s, warned_s = {}, {}, {}
    for heeds, run in runs.items():
        notch, time_s = run.trace.values(NotchCmd.PORT, "NotchCmd"), run.trace.times_s(NotchCmd.PORT)
        pulls_s = time_s[np.flatnonzero(notch == _TRACTION)[0]]
        status = run.trace.raw(AtpLim.PORT, "AtpStatus")
        off_s[heeds] = first_s(run, NotchCmd.PORT, (time_s > pulls_s) & (notch <= 0.0))
        over_s[heeds] = first_s(run, AtpLim.PORT, status >= AtpStatus.OVERSPEED)
        warned_s[heeds] = first_s(run, AtpLim.PORT, status >= AtpStatus.WARNING)
    assert 0.3 < over_s[True] - off_s[True] < 1.5, "half a second before it, and what the lag of the train adds"
    assert off_s[False] > warned_s[False], "the driver himself goes on"
    # The lag of the traction lets the train pass the permitted speed all the same, but later and by less.
    assert warned_s[True] > warned_s[False] + 2.0
    over_mps = {heeds: run.score.extras["overspeed_mps"] for heeds, run in runs.items()}
    assert over_mps[True] < over_mps[False]
