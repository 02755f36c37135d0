"""Equipment, adhesion, mismatch and actuators of the plant's faults alone, each at its edges."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
import pytest

from hil_tests.support.plant_faults import SCENARIO, fault, made, said
from railhil.common.errors import InputError
from railhil.faults.activity import Activity
from railhil.faults.actuators import SideState
from railhil.faults.language import parse
from railhil.faults.model import Fault, Trigger
from railhil.plant_sim.ato.faults.equipment import FaultyEquipment, Side, cap_limit, share_limit
from railhil.plant_sim.ato.faults.forces import AxleSlip
from railhil.plant_sim.ato.faults.mismatch import Mismatch, constant_mismatches
from railhil.plant_sim.ato.forces import EffortLimit
from railhil.plant_sim.ato.plant_readings import TrainStatus
from railhil.scenarios.fault_list import draw_values

MANUAL = Trigger("manual")


# -- equipment ---------------------------------------------------------------------------------------------------------


def test_equipment_is_as_its_faults_make_it() -> None:
    injections = made(
        fault("train.doors", "off", 0.01, duration_s=0.01), fault("train.line_voltage", "low", 0.01, {"share": 0.5}),
        fault("train.line_voltage", "low", 0.02, {"share": 0.8}, duration_s=0.01),
        fault("train.line_voltage", "low", 0.03, {"share": 0.5}), fault("train.model", "nan", MANUAL),
    )  # fmt: skip
    equipment, status = FaultyEquipment(injections), TrainStatus()
    # Set by somebody else.
    status.pantograph_up = False
    found = []
    for tick in range(4):
        injections.look(tick, 0.0, 0.0)
        equipment.change(status)
        found.append((status.doors_closed_locked, status.line_voltage_percent))
    assert found == [(True, 100.0), (False, 50.0), (True, 50.0), (True, 50.0)]
    assert not status.pantograph_up
    assert status.power_on
    # The lowest voltage counts; one that changes nothing more is no hit.
    assert said(injections) == [(4, "true", "false"), (5, "100 %", "50 %")]
    injections.order(5, False)
    injections.look(4, 0.0, 0.0)
    equipment.change(status)
    assert said(injections)[2:] == [(7, "100 %", "50 %")]


@pytest.mark.parametrize(
    ("name", "field"),
    [
        ("power", "power_on"), ("pantograph", "pantograph_up"), ("main_breaker", "main_breaker_closed"),
        ("doors", "doors_closed_locked"), ("parking_brake", "parking_brake_released"),
        ("safety_loop", "safety_loop_closed"),
    ],
)  # fmt: skip
def test_each_interlock_has_its_field(name: str, field: str) -> None:
    injections = made(fault(f"train.{name}", "off", duration_s=0.01), fault(f"train.{name}", "off", 0.03))
    equipment, status, found = FaultyEquipment(injections), TrainStatus(), []
    for tick in range(4):
        injections.look(tick, 0.0, 0.0)
        equipment.change(status)
        found.append(getattr(status, field))
    assert found == [False, True, True, False]
    assert replace(status, **{field: True}) == TrainStatus()
    assert said(injections) == [(4, "true", "false"), (5, "true", "false")]


# -- adhesion ----------------------------------------------------------------------------------------------------------


def slid(
    demand_n: float, carried_n: float, *, slip: float = 0.0, speed: float = 10.0, inertial_kg: float = 1100.0
) -> tuple[float, float]:
    """Slip in m/s and in m after one step of 0.5 s; 1000 kg."""
    axle = AxleSlip()
    assert (axle.slip_mps, axle.slip_m) == (0.0, 0.0)
    axle.slip_mps = slip
    axle.step(demand_n, carried_n, speed, 1000.0, inertial_kg, 0.5)
    return axle.slip_mps, axle.slip_m


def test_an_axle_slips_and_slides() -> None:
    for demand_n, carried_n in ((100.0, 100.0), (-100.0, 100.0), (50.0, 100.0), (-50.0, 100.0), (100.0, inf)):
        assert slid(demand_n, carried_n) == (0.0, 0.0)
    # 20 N beyond, 100 kg: 0.2 m/s2.
    assert slid(120.0, 100.0) == pytest.approx((0.1, 0.025))
    assert slid(-120.0, 100.0) == pytest.approx((-0.1, -0.025))
    # Once it slips the rail acts against it, whatever is demanded.
    assert slid(50.0, 100.0, slip=1.0) == pytest.approx((0.75, 0.4375))
    assert slid(-50.0, 100.0, slip=-1.0) == pytest.approx((-0.75, -0.4375))
    assert slid(0.0, 100.0, slip=1.0) == pytest.approx((0.5, 0.375))
    # It rolls again at the speed of the train, and at once with good adhesion.
    assert slid(-50.0, 100.0, slip=0.1) == pytest.approx((0.0, 0.025))
    assert slid(0.0, 100.0, slip=0.5) == pytest.approx((0.0, 0.125))
    assert slid(50.0, 100.0, slip=-0.1) == pytest.approx((0.0, -0.025))
    assert slid(120.0, inf, slip=1.0) == (0.0, 0.0)
    # A locked wheel stands.
    assert slid(-9000.0, 100.0, speed=3.0) == pytest.approx((-3.0, -0.75))
    # A train without rotating mass has one per cent of it.
    for inertial_kg in (1000.0, 1009.0, 1010.0):
        assert slid(120.0, 100.0, inertial_kg=inertial_kg) == pytest.approx((1.0, 0.25))
    assert slid(120.0, 100.0, inertial_kg=1020.0) == pytest.approx((0.5, 0.125))


def test_the_way_of_a_slip_adds_up() -> None:
    axle = AxleSlip()
    for _ in range(2):
        axle.step(120.0, 100.0, 10.0, 1000.0, 1100.0, 0.5)
    assert axle.slip_m == pytest.approx(0.025 + 0.075)
    axle.step(0.0, inf, 10.0, 1000.0, 1100.0, 0.5)
    assert (axle.slip_mps, axle.slip_m) == (0.0, pytest.approx(0.1))


# -- train and line ----------------------------------------------------------------------------------------------------


def test_a_mismatch_of_train_and_line() -> None:
    factor = {"factor": 2.0}
    assert Mismatch.of([]) == Mismatch(1.0, 1.0, 1.0, 0.0)
    assert Mismatch.of(
        [
            fault("train.mass", "scale", 0.0, factor), fault("train.mass", "scale", 0.0, {"factor": 3.0}),
            fault("train.resistance", "scale", 0.0, {"factor": 0.5}),
            fault("train.resistance", "scale", 0.0, {"factor": 0.5}),
            fault("train.gradient", "offset", 0.0, {"permil": 5.0}),
            fault("train.gradient", "scale", 0.0, {"factor": 4.0}),
            fault("train.gradient", "offset", 0.0, {"permil": -1.0}), fault("train.gradient", "scale", 0.0, factor),
            # None of train and line.
            fault("train.adhesion", "low", 0.0, {"coefficient": 0.1}), fault("actuator.traction", "scale", 0.0, factor),
            fault("sensor.mass", "scale", 0.0, factor),
        ]
    ) == Mismatch(6.0, 0.25, 8.0, 38.0)  # fmt: skip
    over = Mismatch.over([Mismatch(), Mismatch(2.0, 3.0, 4.0, 5.0)])
    assert [list(value) for value in (over.mass, over.resistance, over.grade, over.grade_permil)] == [
        [1.0, 2.0], [1.0, 3.0], [1.0, 4.0], [0.0, 5.0],
    ]  # fmt: skip
    assert isinstance(over.mass, np.ndarray)
    scenario = replace(SCENARIO, line=replace(SCENARIO.line, grade_permil=((0.0, 3.0), (10.0, -1.0))))
    changed = Mismatch(2.0, 3.0, 4.0, 5.0).applied(scenario)
    train, nominal = changed.train, scenario.train
    assert changed.line.grade_permil == ((0.0, 17.0), (10.0, 1.0))
    assert (train.mass_kg, train.inertial_mass_kg) == (2.0 * nominal.mass_kg, 2.0 * nominal.inertial_mass_kg)
    assert train.davis_a_n_per_kn == 3.0 * nominal.davis_a_n_per_kn
    assert train.davis_b_n_per_kn_kmh == 3.0 * nominal.davis_b_n_per_kn_kmh
    assert train.davis_c_n_per_kn_kmh2 == 3.0 * nominal.davis_c_n_per_kn_kmh2
    assert Mismatch().applied(scenario) == scenario


def test_faults_of_runs_without_nodes_are_mismatches() -> None:
    heavy, up = "train.mass scale 1.1 @0s", "train.gradient offset uniform(1,5) @0s"
    first, second = constant_mismatches(replace(SCENARIO, faults=(heavy, up)), (3, 4))
    assert (first.mass, second.mass) == (1.1, 1.1)
    assert 1.0 <= first.grade_permil <= 5.0
    assert first.grade_permil != second.grade_permil
    # Drawn as the second fault of its run.
    assert first == Mismatch.of([parse(heavy), draw_values(parse(up), 2, 3)])
    with pytest.raises(InputError, match="mass, gradient or resistance from the start to the end") as raised:
        constant_mismatches(replace(SCENARIO, faults=(heavy, "bus off @0s")), (3,))
    assert f"{heavy}; bus off @0s" in str(raised.value)


# -- actuators ---------------------------------------------------------------------------------------------------------


LIMIT = EffortLimit(100.0, 500.0, (1.0, 2.0), (30.0, 20.0))


def test_limits_that_are_shared_or_capped() -> None:
    assert share_limit(LIMIT, 0.5) == EffortLimit(50.0, 250.0, (1.0, 2.0), (15.0, 10.0))
    assert [cap_limit(LIMIT, force_n) for force_n in (40.0, 100.0, 400.0, 0.0, -5.0)] == [
        LIMIT._replace(force_max_n=force_n) for force_n in (40.0, 100.0, 100.0, 0.0, 0.0)
    ]


def side(*faults: Fault, sign: int = 1) -> Side:
    found = Side([Activity(one, number) for number, one in enumerate(faults, 4)], sign, 0.1)
    for one in found.faults:
        one.activity.look(0, 0.0, 0.0)
    found.change(77.0)
    return found


AT = "actuator.traction"


def test_what_faults_make_of_a_side() -> None:
    half = {"factor": 0.5}
    for faults, state in (
        ((), SideState()),
        ((fault(AT, "weak", 9.0, {"share": 0.5}),), SideState()),
        ((fault(AT, "ok"),), SideState()),
        ((fault(AT, "weak", 0.0, {"share": 0.5}), fault(AT, "scale", 0.0, {"factor": 3.0})), SideState(share=1.5)),
        ((fault(AT, "weak", 0.0, {"share": 0.5}), fault(AT, "off")), SideState(share=0.0)),
        ((fault(AT, "slow", 0.0, half), fault(AT, "slow", 0.0, half)), SideState(poles=(0.5, 0.5))),
        (
            (fault(AT, "dead_time", 0.0, {"delay_s": 0.2}), fault(AT, "dead_time", 0.0, {"delay_s": 0.3})),
            SideState(delays_s=(0.2, 0.3)),
        ),
        ((fault(AT, "full"),), SideState(instead=inf)),
        ((fault(AT, "stuck"),), SideState(instead=77.0)),
    ):  # fmt: skip
        assert side(*faults).state == state
    assert SideState() == SideState(1.0, (), (), None) == Side([], 1, 0.1).state
    slow = fault(AT, "slow", 0.0, half)
    assert (side(slow, slow).pole, side().pole) == (0.25, 1.0)


def test_a_stuck_force_is_that_of_its_beginning() -> None:
    found = side(fault(AT, "stuck", 0.0, duration_s=1.0))
    found.change(5.0)
    assert found.state.instead == 77.0
    found.faults[0].activity.active = False
    found.change(6.0)
    assert found.state.instead is None
    found.faults[0].activity.active = True
    found.change(8.0)
    assert found.state.instead == 8.0


def test_each_side_has_its_notches() -> None:
    assert [side().part(code) for code in (-5, 0, 5)] == [0, 0, 5]
    assert [side(sign=-1).part(code) for code in (-5, 0, 5)] == [-5, 0, 0]
    assert [side().acting(code) for code in (-5, 0, 5)] == [0, 0, 5]
    # A force instead of the commanded one leaves no notch.
    assert side(fault(AT, "full")).acting(5) == 0
    assert side(fault(AT, "stuck")).acting(5) == 0
    side().remember(5)


def test_a_dead_time_in_whole_ticks() -> None:
    found = side(fault(AT, "dead_time", 0.0, {"delay_s": 0.2}), fault(AT, "dead_time", 9.0, {"delay_s": 0.4}))
    acted = []
    for code in (1, 2, 3, -4, 5, 6):
        acted.append(found.acting(code))
        found.remember(code)
    # The notch at the beginning of the tick, two ticks ago; before the first there was none.
    assert acted == [0, 0, 0, 1, 2, 3]
    assert found._past is not None
    assert found._past.maxlen == 5
    found.faults[0].activity.active = False
    found.change(0.0)
    assert found.acting(9) == 9
    none = side(fault(AT, "weak", 0.0, {"share": 0.5}))
    assert none._past is None
    assert side()._past is None


def noted(*faults: Fault, commanded_n: float, instead_n: float | None = None, possible: bool = True) -> list[Any]:
    found, injections = side(*faults), made()
    found.note(injections, possible, 300, commanded_n, instead_n)
    return said(injections)


def test_what_is_noted_of_an_actuator() -> None:
    weak = fault(AT, "weak", 0.0, {"share": 0.25})
    assert noted(weak, commanded_n=1000.4) == [(4, "1000 N", "250 N")]
    assert noted(weak, commanded_n=0.1) == [(4, "0 N", "0 N")]
    assert noted(weak, commanded_n=0.0) == []
    assert noted(weak, commanded_n=1000.0, possible=False) == []
    assert noted(fault(AT, "weak", 9.0, {"share": 0.25}), commanded_n=1000.0) == []
    assert noted(fault(AT, "slow", 0.0, {"factor": 0.5}), commanded_n=5.0) == [(4, "pole", "pole x 0.5")]
    for what in ("full", "stuck"):
        one = fault(AT, what)
        assert noted(one, commanded_n=100.0, instead_n=101.0) == []
        assert noted(one, commanded_n=100.0, instead_n=99.0) == []
        assert noted(one, commanded_n=100.0, instead_n=101.005) == [(4, "100 N", "101 N")]
        assert noted(one, commanded_n=100.0, instead_n=101.5) == [(4, "100 N", "102 N")]
        assert noted(one, commanded_n=0.0, instead_n=2.0) == [(4, "0 N", "2 N")]
        assert noted(one, commanded_n=100.0, instead_n=0.0) == [(4, "100 N", "0 N")]
        assert noted(one, commanded_n=100.0) == []
    late = fault(AT, "dead_time", 0.0, {"delay_s": 0.1})
    assert noted(late, commanded_n=0.0) == [(4, "300", "0")]
    found, injections = side(late), made()
    found.remember(300)
    found.note(injections, True, 300, 1000.0, None)
    assert said(injections) == [(4, "300", "0")]
    found.remember(300)
    found.note(injections, True, 300, 1000.0, None)
    assert len(said(injections)) == 1
