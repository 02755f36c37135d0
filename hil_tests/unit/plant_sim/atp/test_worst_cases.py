"""The protection against random combinations of faults: its train stops before the supervised location, by truth.

Traction stuck or the driver at full power until cut off, service brake dead, speed and aim of the driver wrong, balises
missed or shifted by 2 m, mass, grade, wheel, red signals. The emergency brake has 1.2 m/s2 on the nominal mass, a dead
time of 0.3 s and a lag of 0.6 s.
"""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from random import Random
from typing import NamedTuple

import pytest

from hil_tests.support.protected_train import STOP_M, Worst, draw, run
from railhil.plant_sim.atp import readings as codes
from railhil.systems.line.scenario.model import EmergencyBrake

#: Way from the trip at the release speed: 0.1 s to the look, 0.3 + 0.6 s, braking at 1.0 m/s2, and a shift of 2 m.
RELEASE_M = 1.5 * 1.0 + 1.5**2 / 2 + 2.0


class Case(NamedTuple):
    """What came of one combination: ways in m, and whether it passes the supervised location unprotected."""

    seed: int
    before_svl_m: float
    beyond_eoa_m: float
    is_service_dead: bool
    passes_unprotected: bool


def case(seed: int) -> Case:
    worst = draw(Random(seed))
    outcome = run(worst)
    beyond_m = outcome.front_m - outcome.eoa_m - outcome.widest_m
    bare = run(worst, is_protected=False)
    return Case(seed, outcome.svl_m - outcome.front_m, beyond_m, worst.is_service_dead, bare.front_m > bare.svl_m)


def check(cases: list[Case]) -> str:
    """Check the bar; a line with its figures.

    The end of authority is kept by the service brake: with a dead one, only the supervised location counts.
    """
    nearest = min(cases, key=lambda one: one.before_svl_m)
    assert nearest.before_svl_m >= 0.0, nearest
    furthest = max((one for one in cases if not one.is_service_dead), key=lambda one: one.beyond_eoa_m)
    assert furthest.beyond_eoa_m <= RELEASE_M, furthest
    bare = sum(one.passes_unprotected for one in cases) / len(cases)
    assert bare >= 0.3
    return (
        f"{len(cases)} combinations: none beyond SvL, nearest {nearest.before_svl_m:.2f} m before it "
        f"(seed {nearest.seed}); with a service brake beyond EoA and interval at most {furthest.beyond_eoa_m:.2f} m "
        f"(seed {furthest.seed}); unprotected {bare:.0%} pass SvL"
    )


@pytest.mark.slow
def test_no_combination_of_faults_passes_the_supervised_location() -> None:
    check([case(seed) for seed in range(100)])


@pytest.mark.long
@pytest.mark.timeout(1500)
def test_none_of_ten_thousand_combinations_passes_the_supervised_location() -> None:
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        print(check(list(pool.map(case, range(1000, 11_000), chunksize=100))))


def test_an_emergency_brake_weaker_than_guaranteed_passes_it() -> None:
    """The test bites: 0.6 m/s2 on the nominal mass, service brake dead, heavy train, downhill."""
    worst = Worst(
        start_m=300.0,
        start_mps=20.0,
        driver="frozen",
        is_service_dead=True,
        mass_factor=1.1,
        grade_permil=((0.0, -20.0),),
        emergency=EmergencyBrake(0.6, 0.3, 0.6),
    )
    outcome = run(worst)
    assert outcome.front_m > outcome.svl_m
    held = run(replace(worst, emergency=EmergencyBrake()))
    assert held.front_m < held.svl_m


def test_a_train_without_faults_stops_at_its_stop_without_an_intervention() -> None:
    outcome = run(Worst(start_m=300.0, start_mps=15.0, balises=((1, 1000.0, 1000.0), (2, 1320.0, 1320.0))))
    assert outcome.front_m == pytest.approx(STOP_M, abs=3.0)
    assert not outcome.demands.emergency_brake
    assert all(status < codes.OVERSPEED for _, status, _ in outcome.events)
