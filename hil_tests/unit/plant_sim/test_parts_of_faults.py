"""The parts of the plant's faults alone, each at its edges: what acts, what it changes, what is noted of it."""

from __future__ import annotations

from dataclasses import replace
from math import exp, inf
from typing import Any

import numpy as np
import pytest

from hil_tests.support.plant_faults import SCENARIO, fault
from hil_tests.support.scripted import Scripted
from railhil.bus.injector.activity import Activity
from railhil.bus.injector.log import Hit
from railhil.bus.telegrams import TrnSpeed
from railhil.common.errors import InputError
from railhil.faults.language import parse
from railhil.faults.model import Fault, Trigger
from railhil.plant_sim.faults.adhesion import AxleSlip
from railhil.plant_sim.faults.balises import FaultyReader, UnreadBalise
from railhil.plant_sim.faults.drive import Side, SideState, capped, shared
from railhil.plant_sim.faults.equipment import FaultyEquipment
from railhil.plant_sim.faults.injections import Injections, MotionEvents
from railhil.plant_sim.faults.mismatch import Mismatch
from railhil.plant_sim.faults.plants import constant_mismatches, in_plant, make_plant, needs_nodes
from railhil.plant_sim.faults.readings import FaultySensor, Quantity, Reading
from railhil.plant_sim.faults.train import FaultyTrain
from railhil.plant_sim.forces import EffortLimit
from railhil.plant_sim.status import TrainStatus
from railhil.scenarios.fault_list import drawn
from railhil.scenarios.model import Balise
from railhil.scenarios.run_spec import RunSpec

TICK_NS = 10_000_000
MANUAL = Trigger("manual")


def made(*faults: Fault) -> Injections:
    return Injections(list(enumerate(faults, 4)), 0, TICK_NS)


def said(injections: Injections) -> list[tuple[int, str, str]]:
    return [(hit.fault, hit.before, hit.after) for hit in injections.log.hits]


# -- which faults are active ------------------------------------------------------------------------------------------


def test_events_of_the_motion() -> None:
    events = MotionEvents()
    # It begins at a standstill, which is no event.
    assert events.seen(0.0, 0.0, 0.0) == []
    assert events.seen(0.0, -0.3, 0.0) == ["braking"]
    assert events.seen(0.1, -0.3, 1e-9) == ["traction"]
    assert events.seen(0.1, -0.3, 1e-9) == []
    assert events.seen(0.1, -0.2999, -5.0) == []
    assert events.seen(0.0, -5.0, 5.0) == ["standstill", "braking", "traction"]
    assert MotionEvents().seen(1.0, 0.0, 0.0) == []
    assert MotionEvents().seen(0.0, -1.0, 1.0) == ["braking", "traction"]


def test_begins_and_ends_are_changes() -> None:
    injections = made(fault("sensor.speed", "off", 0.02, duration_s=0.02), fault("sensor.position", "off", MANUAL))
    assert [injections.look(tick, 0.0, 0.0) for tick in range(6)] == [True, False, True, False, True, False]
    # Ended between two looks, by its count: the next one tells.
    injections = made(fault("sensor.speed", "off", 0.0, count=1))
    injections.look(0, 0.0, 0.0)
    injections.hit(injections.activities[0], "a", "b")
    assert injections.look(1, 0.0, 0.0)
    assert not injections.look(2, 0.0, 0.0)


def test_place_and_speed_reach_the_faults() -> None:
    injections = made(
        fault("sensor.speed", "off", Trigger("position", 10.0)), fault("sensor.position", "off", Trigger("speed", 10.0))
    )
    injections.look(0, 9.0, 1.0)
    injections.look(1, 11.0, 9.0)
    assert [one.active for one in injections.activities] == [True, False]
    injections.look(2, 12.0, 11.0)
    assert [one.active for one in injections.activities] == [True, True]


def test_places_of_the_faults() -> None:
    injections = made(
        fault("sensor.speed", "off"), fault("sensor.position", "off"), fault("train.power", "off"),
        fault("actuator.brake", "off"),
    )  # fmt: skip
    assert [one.number for one in injections.activities] == [4, 5, 6, 7]
    assert [one.number for one in injections.at("sensor")] == [4, 5]
    assert [one.number for one in injections.at("sensor", "position", "power")] == [5]
    assert injections.at("train", "speed") == []


def test_orders_and_events() -> None:
    injections = made(
        fault("sensor.speed", "off", MANUAL), fault("sensor.position", "off", MANUAL),
        fault("train.power", "off", Trigger("event", "braking")),
    )  # fmt: skip
    injections.look(3, 0.0, 0.0)
    injections.order(5, True)
    injections.order(1, True)
    injections.happened("standstill")
    injections.look(4, 0.0, 0.0)
    assert [one.active for one in injections.activities] == [False, True, False]
    injections.happened("braking")
    injections.order(5, False)
    assert injections.activities[1].ended_ns == 4 * TICK_NS
    injections.look(5, 0.0, 0.0)
    assert [one.active for one in injections.activities] == [False, False, True]


def test_ok_ends_what_is_active_at_its_place() -> None:
    injections = made(
        fault("sensor.speed", "off"), fault("sensor.speed", "stuck", 9.0), fault("sensor.position", "off"),
        fault("sensor.speed", "ok", 0.01), fault("sensor.speed", "noise"),
    )  # fmt: skip
    injections.look(0, 0.0, 0.0)
    injections.look(1, 0.0, 0.0)
    assert [one.active for one in injections.activities] == [False, False, True, False, False]
    assert [one.over for one in injections.activities] == [True, False, False, True, True]
    assert injections.log.hits == [Hit(7, TICK_NS, "ok", what, "ok") for what in ("off", "noise")]


def test_a_lasting_effect_is_a_hit_each_time_it_begins() -> None:
    injections = made(fault("train.power", "off"), fault("train.doors", "off"))
    one, other = injections.activities
    for tick, acts in enumerate((False, True, True, False, True)):
        injections.look(tick, 0.0, 0.0)
        injections.effect(one, acts, f"{tick}", "x")
    injections.effect(other, True, "y", "z")
    assert said(injections) == [(4, "1", "x"), (4, "4", "x"), (5, "y", "z")]
    assert [hit.time_ns for hit in injections.log.hits] == [TICK_NS, 4 * TICK_NS, 4 * TICK_NS]


def test_each_fault_has_its_own_random_numbers() -> None:
    injections = made(fault("sensor.speed", "garbage"), fault("sensor.speed", "garbage"))
    first, second = (injections.samples(one).random() for one in injections.activities)
    assert first != second
    assert injections.samples(injections.activities[0]).random() == first
    other = Injections([(4, fault("sensor.speed", "garbage"))], 1, TICK_NS)
    assert other.samples(other.activities[0]).random() != first


# -- sensors ----------------------------------------------------------------------------------------------------------

QUANTITY = Quantity(100.0, -1000, 999)


def test_a_quantity_keeps_to_its_signal() -> None:
    assert Quantity.of(TrnSpeed, "speed_01mmps", 1e4) == Quantity(1e4, -(1 << 23), (1 << 23) - 1)
    assert [QUANTITY.raw(value) for value in (1.234, -1.236, 9.99, 10.0, 99.0, -10.0, -99.0)] == [
        123, -124, 999, 999, 999, -1000, -1000,
    ]  # fmt: skip


def sensed(*faults: Fault, raw: list[int], tick_s: float = 0.1) -> list[Reading]:
    injections = Injections(list(enumerate(faults, 1)), 0, round(tick_s * 1e9))
    sensor = FaultySensor(injections, QUANTITY, tick_s, "speed")
    assert (sensor.reading, sensor.error) == (Reading(0, True), 0)
    found = []
    for tick, value in enumerate(raw):
        injections.look(tick, 0.0, 0.0)
        sensor.sample(value)
        assert sensor.error == sensor.reading.raw - value
        found.append(sensor.reading)
    return found


def raws(*faults: Fault, raw: list[int]) -> list[int]:
    return [reading.raw for reading in sensed(*faults, raw=raw)]


def test_words_of_a_sensor_at_their_edges() -> None:
    # The fault's own time counts from its beginning, anew each time.
    assert raws(fault("sensor.speed", "drift", 0.2, {"per_s": 1.0}), raw=[500] * 6) == [500, 500, 500, 510, 520, 530]
    assert raws(fault("sensor.speed", "delayed", 0.0, {"delay_s": 0.2}), raw=[1, 2, 3, 4]) == [1, 1, 1, 2]
    # From its beginning on it lags from the reading of that instant.
    share = 1 - exp(-0.1 / 0.4)
    slow = raws(fault("sensor.speed", "slow", 0.1, {"time_constant_s": 0.4}), raw=[0, 400, 800, 800])
    assert slow == [0, 400, round(400 + 400 * share), round(400 + 400 * share + (400 - 400 * share) * share)]
    assert raws(fault("sensor.speed", "wrong", 0.0, {"factor": -1.5}), raw=[100, 801]) == [-150, -1000]
    assert raws(fault("sensor.speed", "jump", 0.1, {"distance_m": 2.0}), raw=[100, 101, 900]) == [100, 301, 999]
    assert raws(fault("sensor.speed", "jump", 0.0, {"distance_m": -2.0}), raw=[100]) == [-100]
    # What is not valid stays so, whatever comes behind.
    off = fault("sensor.speed", "off")
    for what, values in (
        ("wrong", {"factor": 2.0}), ("offset", {"error": 1.0}), ("slow", {"time_constant_s": 1.0}), ("stuck", {}),
        ("delayed", {"delay_s": 0.1}),
    ):  # fmt: skip
        assert [one.valid for one in sensed(off, fault("sensor.speed", what, 0.0, values), raw=[1, 2])] == [False] * 2
    # A given one is valid again.
    assert sensed(off, fault("sensor.speed", "value", 0.0, {"value": 1.0}), raw=[5]) == [Reading(100, True)]


def test_a_fault_that_begins_again_begins_anew() -> None:
    """By ``ok`` and another one of its kind; each has its own memory."""
    stuck = fault("sensor.speed", "stuck", 0.1, duration_s=0.2)
    assert raws(stuck, fault("sensor.speed", "stuck", 0.4), raw=[1, 2, 3, 4, 5, 6]) == [1, 2, 2, 4, 5, 5]


def test_random_words_of_a_sensor() -> None:
    injections = made(fault("sensor.speed", "garbage"), fault("sensor.speed", "intermittent", 0.0, {"share": 0.3}))
    sensor = FaultySensor(injections, QUANTITY, 0.1, "speed")
    garbage, intermittent = sensor._faults
    drawn: list[Any] = []
    garbage.source = type(  # type: ignore[assignment]
        "Source", (), {"integers": lambda self, low, high, endpoint: drawn.append((low, high, endpoint)) or 7}
    )()
    intermittent.source = Scripted((0.3, 0.2999))  # type: ignore[assignment]
    injections.look(0, 0.0, 0.0)
    sensor.sample(5)
    assert sensor.reading == Reading(7)
    sensor.sample(5)
    assert (sensor.reading, sensor.error) == (Reading(0, False), -5)
    assert drawn == [(-1000, 999, True)] * 2


def test_noise_is_of_its_standard_deviation() -> None:
    noise = fault("sensor.speed", "noise", 0.0, {"sigma": 2.0})
    drawn = made(noise).samples(made(noise).activities[0])
    sensor = FaultySensor(made(noise), QUANTITY, 0.1, "speed")
    sensor._faults[0].activity.active = True
    for _ in range(3):
        sensor.sample(5)
        assert sensor.reading == Reading(round((0.05 + 2.0 * drawn.standard_normal()) * 100))


def test_a_change_counts_when_it_is_sent() -> None:
    injections = made(fault("sensor.speed", "offset", 0.0, {"error": 1.0}), fault("sensor.speed", "off"))
    sensor = FaultySensor(injections, QUANTITY, 0.1, "speed")
    injections.look(0, 0.0, 0.0)
    sensor.sample(5)
    sensor.sample(6)
    assert said(injections) == []
    assert sensor.sent() == Reading(0, False)
    assert said(injections) == [(4, "6", "106"), (5, "106", "invalid")]
    # Once for each sample.
    sensor.sent()
    assert len(said(injections)) == 2
    assert bool(sensor)
    assert not FaultySensor(injections, QUANTITY, 0.1, "position")
    assert not FaultySensor(made(fault("sensor.speed", "ok")), QUANTITY, 0.1, "speed")


def test_reports_of_a_balise() -> None:
    balise = Balise(7, 100.5, 100.0)

    def reported(*faults: Fault) -> tuple[list[Balise], list[tuple[int, str, str]]]:
        injections = made(*faults)
        injections.look(0, 0.0, 0.0)
        return FaultyReader(injections).reported(balise), said(injections)

    at = "sensor.balise"
    assert reported() == ([balise], [])
    assert reported(fault(at, "missed", 9.0)) == ([balise], [])
    assert reported(fault(at, "missed")) == ([], [(4, "7:100.5", "none")])
    assert reported(fault(at, "doubled")) == ([balise] * 2, [(4, "7:100.5", "7:100.5 7:100.5")])
    assert reported(fault(at, "wrong", 0.0, {"error_m": -2.0})) == (
        [replace(balise, surveyed_m=98.5)], [(4, "7:100.5", "7:98.5")],
    )  # fmt: skip
    unread = UnreadBalise(7, 0.0, 100.0)
    assert reported(fault(at, "off")) == ([unread], [(4, "7:100.5", "invalid")])
    assert reported(fault(at, "intermittent", 0.0, {"share": 1.0}))[0] == [unread]
    assert reported(fault(at, "intermittent", 0.0, {"share": 0.0})) == ([balise], [])
    # In the order of their numbers; one that changes nothing more is not noted.
    assert reported(fault(at, "off"), fault(at, "doubled"), fault(at, "off")) == (
        [unread] * 2, [(4, "7:100.5", "invalid"), (5, "invalid", "invalid invalid")],
    )  # fmt: skip
    assert reported(fault(at, "missed"), fault(at, "doubled")) == ([], [(4, "7:100.5", "none")])


def test_a_share_of_the_balises_is_not_read() -> None:
    injections = made(fault("sensor.balise", "intermittent", 0.0, {"share": 0.3}))
    injections.look(0, 0.0, 0.0)
    reader = FaultyReader(injections)
    reader._faults = [(injections.activities[0], Scripted((0.3, 0.2999)))]  # type: ignore[list-item]
    kinds = [type(reader.reported(Balise(1, 2.0, 3.0))[0]) for _ in range(2)]
    assert kinds == [Balise, UnreadBalise]


# -- equipment --------------------------------------------------------------------------------------------------------


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


# -- adhesion ---------------------------------------------------------------------------------------------------------


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


# -- train and line ---------------------------------------------------------------------------------------------------


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


# -- actuators --------------------------------------------------------------------------------------------------------

LIMIT = EffortLimit(100.0, 500.0, (1.0, 2.0), (30.0, 20.0))


def test_limits_that_are_shared_or_capped() -> None:
    assert shared(LIMIT, 0.5) == EffortLimit(50.0, 250.0, (1.0, 2.0), (15.0, 10.0))
    assert [capped(LIMIT, force_n) for force_n in (40.0, 100.0, 400.0, 0.0, -5.0)] == [
        LIMIT._replace(force_max_n=force_n) for force_n in (40.0, 100.0, 100.0, 0.0, 0.0)
    ]


def side(*faults: Fault, sign: int = 1) -> Side:
    found = Side([Activity(one, number) for number, one in enumerate(faults, 4)], sign, 0.1)
    for one in found.faults:
        one.look(0, 0.0, 0.0)
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
        ((fault(AT, "slow", 0.0, half), fault(AT, "slow", 0.0, half)), SideState(pole=0.25)),
        (
            (fault(AT, "dead_time", 0.0, {"delay_s": 0.2}), fault(AT, "dead_time", 0.0, {"delay_s": 0.3})),
            SideState(dead_ticks=5),
        ),
        ((fault(AT, "full"),), SideState(instead_n=inf)),
        ((fault(AT, "stuck"),), SideState(instead_n=77.0)),
    ):  # fmt: skip
        assert side(*faults).state == state
    assert SideState() == SideState(1.0, 1.0, 0, None) == Side([], 1, 0.1).state


def test_a_stuck_force_is_that_of_its_beginning() -> None:
    found = side(fault(AT, "stuck", 0.0, duration_s=1.0))
    found.change(5.0)
    assert found.state.instead_n == 77.0
    found.faults[0].active = False
    found.change(6.0)
    assert found.state.instead_n is None
    found.faults[0].active = True
    found.change(8.0)
    assert found.state.instead_n == 8.0


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
    found.faults[0].active = False
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


# -- the plant of a run -----------------------------------------------------------------------------------------------


def test_the_plant_of_a_run() -> None:
    assert in_plant([fault("bus.", "off"), fault("train.mass", "scale"), fault("sensor.speed", "off")]) == [
        (2, fault("train.mass", "scale")), (3, fault("sensor.speed", "off")),
    ]  # fmt: skip
    assert in_plant([fault("actuator.brake", "off"), fault("node.plant", "kill")]) == [
        (1, fault("actuator.brake", "off"))
    ]
    for faults in ((), ("TRN_SPEED loss @0s",)):
        plant, injections = make_plant(replace(SCENARIO, faults=faults), RunSpec())
        assert not isinstance(plant, FaultyTrain)
        assert injections is None
    spec = RunSpec(seed=7, perturbed=True)
    plant, injections = make_plant(replace(SCENARIO, faults=("TRN_SPEED loss @0s", "sensor.speed garbage @0s")), spec)
    assert isinstance(plant, FaultyTrain)
    assert injections is plant.injections
    (one,) = plant.injections.activities
    assert (one.number, one.fault.what) == (2, "garbage")
    # With the seed and the perturbation of the run.
    assert plant.injections.samples(one).random() == Injections([(2, one.fault)], 7, TICK_NS).samples(one).random()
    assert plant._healthy.train != SCENARIO.train


def test_faults_without_nodes() -> None:
    heavy, up = "train.mass scale 1.1 @0s", "train.gradient offset uniform(1,5) @0s"
    assert [needs_nodes(replace(SCENARIO, faults=faults)) for faults in ((), (heavy,), (heavy, "bus off @0s"))] == [
        False, False, True,
    ]  # fmt: skip
    first, second = constant_mismatches(replace(SCENARIO, faults=(heavy, up)), (3, 4))
    assert (first.mass, second.mass) == (1.1, 1.1)
    assert 1.0 <= first.grade_permil <= 5.0
    assert first.grade_permil != second.grade_permil
    # Drawn as the second fault of its run.
    assert first == Mismatch.of([parse(heavy), drawn(parse(up), 2, 3)])
    with pytest.raises(InputError, match="mass, gradient or resistance from the start to the end") as raised:
        constant_mismatches(replace(SCENARIO, faults=(heavy, "bus off @0s")), (3,))
    assert f"{heavy}; bus off @0s" in str(raised.value)
