"""How hard the train's own watch brakes, level by level."""

from __future__ import annotations

from math import inf

import pytest

from railhil.plant_sim.ato.command_watch import watch_brake_mps2
from railhil.wire.ato import WatchLevel

STEP_S, SERVICE_MPS2 = 0.02, 1.0


def brake(level: WatchLevel, last: float, now: float = 0.0, moving: bool = True) -> float:
    return watch_brake_mps2(level, last, now, moving, STEP_S, SERVICE_MPS2)


@pytest.mark.parametrize("moving", [False, True])
def test_emergency_is_all_the_brake_has(moving: bool) -> None:
    assert brake(WatchLevel.EMERGENCY, 0.3, 0.2, moving) == inf


def test_the_service_brake_builds_up_at_075_mps3_from_what_brakes_already() -> None:
    level = WatchLevel.SERVICE_BRAKE
    assert brake(level, 0.0) == pytest.approx(0.015)
    assert brake(level, 0.3, 0.1) == pytest.approx(0.315)
    assert brake(level, 0.1, 0.3) == pytest.approx(0.315)
    assert brake(level, 0.99) == brake(level, 0.0, 1.2) == SERVICE_MPS2
    assert brake(level, 0.0, moving=False) == SERVICE_MPS2


@pytest.mark.parametrize("level", [WatchLevel.NORMAL, WatchLevel.HOLD, WatchLevel.TRACTION_CUT])
def test_it_is_released_at_the_same_rate_and_at_rest_at_once(level: WatchLevel) -> None:
    assert brake(level, 0.5, 0.9) == pytest.approx(0.485)
    assert brake(level, 0.01) == brake(level, 0.0) == 0.0
    assert brake(level, 0.5, moving=False) == 0.0
