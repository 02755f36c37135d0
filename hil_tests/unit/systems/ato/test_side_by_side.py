"""Trains side by side are what each is by itself, with the whole functions of the bench, to the last bit."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from railhil.batch import Case
from railhil.scenarios.load import load
from railhil.systems.ato.batch import lanes
from railhil.systems.ato.batch.engine import Engine
from railhil.systems.ato.batch.kernel import run_period, stand_to_the_end
from railhil.systems.ato.batch.lanes import LANES
from railhil.systems.ato.batch.layout import READ_ENDED, Common
from railhil.systems.ato.batch.setup import Trains, trains
from railhil.systems.ato.scenario.model import Scenario

#: Two blocks, and one that is nearly empty.
COUNT = 2 * LANES + 3
DRIVEN = "lvshun_tieshan"
LIMITED = "yizhuang_02_xiaocun_xiaohongmen"


def _fleet(scenario: Scenario, engine: Engine) -> Trains:
    """Trains with delays of all kinds: whole ticks, none, parts of a tick, and more than a control period."""
    fleet = trains(scenario, range(COUNT), True, engine.times, len(engine.grid.counts))
    delays = fleet.column(lanes.DELAY_TICKS)
    delays[::7] = np.rint(delays[::7])
    delays[1::11] = 0.0
    delays[2::13] = 61.3
    delays[3::17] = 50.0
    for index, delay in enumerate(delays):
        fleet.tables.blocks[index // LANES, lanes.DELAY_TICKS + index % LANES] = delay
    return fleet


def _codes(engine: Engine, seed: int) -> Any:
    """Notches of a driver who is never content: traction first, then anything, in the end the brake."""
    random = np.random.Generator(np.random.PCG64(seed))
    steps = engine.times.steps.size
    held = np.repeat(random.integers(-900, 1300, (steps // 8 + 1, COUNT)), 8, axis=0)[:steps]
    codes = held + random.integers(-40, 40, (steps, COUNT))
    codes[:20] = 1100 + 40 * random.integers(0, 3, (20, COUNT))
    codes[-steps // 4 :] = -random.integers(100, 700, (steps // 4 + (steps % 4 > 0), COUNT))
    return codes


def _driven(engine: Engine, common: Common, fleet: Trains, codes: Any) -> tuple[int, int]:
    """Make the runs; the trains that were side by side and those that were not, at the end of each control period."""
    noise = np.random.Generator(np.random.PCG64(9)).normal(size=(engine.times.steps.size, COUNT))
    together, alone = 0, 0
    run_period(common, fleet.tables, codes[0], noise[0], -1, 0)
    for i, (tick, end) in enumerate(zip(engine.times.steps.tolist(), engine.times.ends.tolist(), strict=True)):
        run_period(common, fleet.tables, codes[i], noise[i], tick, end)
        ordinary, running = fleet.column(lanes.ORDINARY) > 0.0, fleet.column(lanes.ENDED) == 0.0
        together, alone = together + int((running & ordinary).sum()), alone + int((running & ~ordinary).sum())
        if fleet.tables.readings[READ_ENDED].all():
            break
    stand_to_the_end(common, fleet.tables)
    return together, alone


def _with_curves(common: Common) -> Common:
    speeds, share = np.array([2.0, 9.0, 15.0, 30.0]), np.array([1.0, 0.9, 0.6, 0.25])
    return common._replace(
        traction=common.traction._replace(curve_mps=speeds, curve_n=share * common.traction.force_max_n),
        brake=common.brake._replace(curve_mps=speeds, curve_n=(1.1 - share / 4) * common.brake.force_max_n),
    )


#: What else may happen in a run: scenario, changes of its constants.
WAYS = {
    "grades": (DRIVEN, lambda common: common),
    "limits": (LIMITED, lambda common: common),
    "curves": (DRIVEN, _with_curves),
    "weak brakes are found": (
        DRIVEN,
        lambda common: common._replace(checks=common.checks._replace(share=0.97, allowance_mps2=0.02, weak_looks=3)),
    ),
    "traction that is left is found": (
        LIMITED,
        lambda common: common._replace(checks=common.checks._replace(left_max_n=-3000.0)),
    ),
    "end of authority": (LIMITED, lambda common: common._replace(checks=common.checks._replace(end_m=900.0))),
    "readings in the middle of a period": (DRIVEN, lambda common: common._replace(position_ticks=7)),
    "less force": (
        DRIVEN,
        lambda common: common._replace(traction=common.traction._replace(force_max_n=120_000.0, power_max_w=1.1e6)),
    ),
}


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("by_distance", [False, True])
def test_trains_side_by_side_are_what_they_are_alone(way: str, by_distance: bool) -> None:
    name, changed = WAYS[way]
    scenario = load(name)
    scenario = replace(scenario, timing=replace(scenario.timing, loop_delay_s=0.4))
    engine = Engine(Case(scenario))
    common = changed(engine.common)._replace(by_distance=by_distance)
    together, apart = _fleet(scenario, engine), _fleet(scenario, engine)
    codes = _codes(engine, list(WAYS).index(way))
    assert _driven(engine, common, together, codes)[0] > 5 * COUNT
    assert _driven(engine, common._replace(side_by_side=False), apart, codes)[0] == 0
    for quantity in range(0, lanes.ORDINARY, lanes.LANES):
        if quantity not in (lanes.AGE, lanes.WANTED, lanes.ERROR):
            found, wanted = together.column(quantity), apart.column(quantity)
            assert np.array_equal(found, wanted), (quantity // lanes.LANES, int((found != wanted).sum()))
    for part in ("error_sums_kmh", "control_accel_raw", "readings"):
        assert np.array_equal(getattr(together.tables, part), getattr(apart.tables, part)), part


@pytest.mark.slow
def test_nearly_all_of_a_run_is_side_by_side() -> None:
    """Else the batch would be slow, with the same results."""
    engine = Engine(Case(load(DRIVEN)))
    fleet = trains(load(DRIVEN), range(COUNT), True, engine.times, len(engine.grid.counts))
    chunk = engine.run(range(COUNT))
    codes = np.ascontiguousarray(chunk.codes[:, fleet.tables.order], dtype=np.int64)
    together, alone = _driven(engine, engine.common, fleet, codes)
    assert together > 20 * alone


def test_trains_of_a_block_have_similar_delays() -> None:
    scenario = load(DRIVEN)
    engine = Engine(Case(scenario))
    fleet = trains(scenario, range(COUNT), True, engine.times, len(engine.grid.counts))
    assert (np.diff(fleet.column(lanes.DELAY_TICKS)) >= 0.0).all()
    assert sorted(fleet.tables.order.tolist()) == list(range(COUNT))
