"""Creeping to the stopping point, with the train of the plant."""

from __future__ import annotations

import random
from dataclasses import replace
from functools import lru_cache

import pytest

from railhil.controller_node.line.jog import STEP_MS, Creep, CreepLimits
from railhil.plant_sim.ato.plant import Plant
from railhil.scenarios.load import load, names
from railhil.scenarios.profiles import shift
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.perturb import perturb

RUNS = [name for name in names() if name.startswith("yizhuang_") and name[9:11].isdigit()]
PERMITTED_MPS = 3 / 3.6
SEEDS = range(70_000, 71_000)


@lru_cache
def single(name: str) -> Scenario:
    return load(name)


def creep(seed: int) -> tuple[float, float, float]:
    """Error at the end, largest speed and duration of a creep of a perturbed train to one of Yizhuang's stops."""
    chance = random.Random(seed)
    nominal = single(chance.choice(RUNS))
    drawn = perturb(nominal, seed)
    short_m, mistaken_m = chance.uniform(0.5, 5.0), chance.uniform(-0.06, 0.06)
    from_m = nominal.plan.distance_m - short_m
    line = replace(
        drawn.line,
        grade_permil=shift(drawn.line.grade_permil, from_m),
        speed_limit_mps=shift(drawn.line.speed_limit_mps, from_m),
        balises=(),
    )
    train, loop = Plant(replace(drawn, line=line), seed), Creep(CreepLimits.of(nominal, PERMITTED_MPS))
    loop.start()
    largest_mps, has_moved, code = 0.0, False, 0
    for tick in range(6000):
        if tick * 10 % STEP_MS == 0:
            left_01mm = round((short_m + mistaken_m) * 1e4) - train.odometer_mm * 10
            code = loop.step(left_01mm, train.speed_01mmps, round(train.grade_permil * 100))
        train.command(code, False)
        train.advance()
        speed_mps = train.true_speed_01mmps / 1e4
        largest_mps, has_moved = max(largest_mps, speed_mps), has_moved or speed_mps > 0
        if has_moved and speed_mps == 0:
            return train.position_01mm / 1e4 - short_m, largest_mps, tick / 100
    return short_m, largest_mps, 60.0


@pytest.mark.parametrize("seed", SEEDS[::50])
def test_a_perturbed_train_creeps_to_its_stopping_point(seed: int) -> None:
    error_m, largest_mps, time_s = creep(seed)
    assert abs(error_m) <= 0.3
    assert largest_mps <= 1.1 * PERMITTED_MPS
    assert time_s < 25


@pytest.mark.long
def test_at_least_99_percent_of_1000_perturbed_creeps_end_within_the_limit_of_a_pass() -> None:
    errors_m = [creep(seed)[0] for seed in SEEDS]
    assert sum(abs(error_m) <= 0.3 for error_m in errors_m) >= 990


def test_behind_the_stopping_point_the_train_is_braked() -> None:
    loop = Creep(CreepLimits.of(single(RUNS[0]), PERMITTED_MPS))
    loop.start()
    assert loop.step(-2000, 5000, 0) < 0
