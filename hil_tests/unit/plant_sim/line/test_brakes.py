"""Holding brake and emergency brake: forces, and when they act."""

from __future__ import annotations

from math import exp

import pytest

from railhil.plant_sim.line.brakes import EmergencyForce, HoldingBrake
from railhil.systems.line.scenario.model import EmergencyBrake

MASS_KG = 200_000.0


def test_the_emergency_brake_waits_and_then_follows_its_lag() -> None:
    force = EmergencyForce(EmergencyBrake(1.2, 0.3, 0.6), MASS_KG, 0.01)
    values = [force.step() for _ in range(400)]
    assert values[:30] == [0.0] * 30
    assert values[90] == pytest.approx(240_000 * (1 - exp(-0.605 / 0.6)))
    assert values == sorted(values)
    assert values[-1] == pytest.approx(240_000, rel=0.01)


def test_an_emergency_brake_without_lag_is_full_after_its_dead_time() -> None:
    force = EmergencyForce(EmergencyBrake(1.2, 0.1, 0.0), MASS_KG, 0.01)
    assert [force.step() for _ in range(12)] == [0.0] * 10 + [240_000.0] * 2


def test_a_weak_emergency_brake_has_a_share_of_its_force() -> None:
    force = EmergencyForce(EmergencyBrake(1.2, 0.0, 0.0), MASS_KG, 0.01)
    force.share = 0.7
    assert force.step() == pytest.approx(168_000.0)


@pytest.mark.parametrize(
    ("traction_n", "against_n", "departing", "held"),
    [
        (0.0, 4000.0, True, True),
        (4000.0, 4000.0, True, True),
        (4001.0, 4000.0, False, False),
        (0.0, -4000.0, False, True),
        (0.0, -4000.0, True, False),
        (1.0, -4000.0, False, False),
    ],
)
def test_the_holding_brake_lets_go_for_traction_or_a_departure_downhill(
    traction_n: float, against_n: float, departing: bool, held: bool
) -> None:
    brake = HoldingBrake(80_000.0)
    brake.follow(traction_n, against_n, departing)
    assert brake.is_applied is held
    assert brake.acting_n == (80_000.0 if held else 0.0)
