"""Faults of a train on a line, each on the plant alone: a train that stands at its first stop, or rolls."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from railhil.bus.layout import flag
from railhil.faults.language import fault_text, parse
from railhil.faults.model import Fault, Place, Trigger, Word
from railhil.faults.words import CLEAR, words_at
from railhil.plant_sim.line.faults.train import FaultyLineTrain
from railhil.plant_sim.line.onboard import EMERGENCY_BRAKE, NO_REACTION, SERVICE_BRAKE
from railhil.plant_sim.line.train import LineTrain
from railhil.scenarios.load import load_any
from railhil.systems.line import INJECTS
from railhil.wire.ato import NotchCmd
from railhil.wire.line import DoorCmd, DoorOrder, DoorState

TICKS_PER_S = 100
#: Every place of this module's faults with every word that it has.
INJECTED = [(place, word) for place in INJECTS for word in words_at(*place.split("."), "") if word.name != CLEAR]


class Driver:
    """A train with faults, and a controller that orders doors and a notch every 40 ms."""

    def __init__(self, *faults: str | Fault, seed: int = 0, scenario: str = "four_stops") -> None:
        texts = [parse(one) if isinstance(one, str) else one for one in faults]
        self.train = FaultyLineTrain(load_any(scenario, ()), seed, False, 0.0, list(enumerate(texts, 1)))
        self.events: list[str] = []
        self.told: list[Any] = []
        self._life = 0

    def run(
        self,
        seconds: float,
        notch: float = 0.0,
        order: DoorOrder = DoorOrder.NONE,
        hold: bool = True,
        ready: bool = False,
    ) -> Driver:
        """Let some time pass."""
        train = self.train
        for _ in range(round(seconds * TICKS_PER_S)):
            if train.tick % 4 == 0:
                self._life = self._life % 15 + 1
                train.take(NotchCmd(notch_256th=round(notch * 256), mode=1, life=self._life))
                flags = {"hold_brake": flag(hold), "depart_ready": flag(ready)}
                station = train.journey.arrival + 1
                train.take(DoorCmd(order=order, station=station, life=self._life, **flags))
            train.advance()
            self.events += [event.kind for event in train.drain_events()]
        return self

    def depart(self, seconds: float) -> Driver:
        """Leave the first stop and accelerate."""
        self.run(0.2, ready=True, hold=False)
        return self.run(seconds, 5.0, hold=False)

    @property
    def hits(self) -> list[int]:
        """The numbers of the faults that changed something, in order."""
        return [hit.fault for hit in self.train.injections.log.hits]


def doors(*faults: str) -> Driver:
    """Doors on the left that have opened at the first stop and are ordered to close."""
    driver = Driver(*faults).run(6.0, order=DoorOrder.OPEN_LEFT)
    return driver.run(14.0, order=DoorOrder.CLOSE)


def test_a_train_whose_faults_are_not_active_is_the_train_without_faults() -> None:
    scenario = load_any("four_stops", ())
    plain = LineTrain(scenario, 3, True, 0.0)
    faulty = Driver("door stuck open @900s", "mass scale 1.1 @900s", "balise missed @900s", seed=3)
    faulty.train = FaultyLineTrain(scenario, 3, True, 0.0, [(1, parse("atp dead @900s"))])
    reference = Driver("atp dead @900s", seed=3)
    reference.train = plain  # type: ignore[assignment]
    for driver in (faulty, reference):
        driver.depart(12.0).run(3.0, -6.0, hold=False)
    assert faulty.train._motion == plain._motion
    assert plain._motion.speed_mps > 1.0
    assert faulty.events == reference.events


def test_doors_close_without_a_fault() -> None:
    driver = doors()
    assert driver.train.doors.are_locked
    assert driver.events.count("doors_locked") == 1


def test_stuck_doors_end_in_a_fault_and_keep_traction_off() -> None:
    driver = doors("door left stuck open @1s")
    assert driver.train.doors.left.state == DoorState.FAULT
    assert not driver.train.status.doors_closed_locked
    assert driver.hits == [1]


def test_slow_doors_take_their_time() -> None:
    begun = Driver("door left slow 3x @0s").run(2.0)
    driver = begun.run(7.0, order=DoorOrder.OPEN_LEFT)
    assert "doors_open" not in driver.events
    assert "doors_open" in driver.run(2.0, order=DoorOrder.OPEN_LEFT).events


@pytest.mark.parametrize(("count", "reopened", "state"), [(2, 2, DoorState.LOCKED), (4, 3, DoorState.FAULT)])
def test_obstacles_open_doors_again_until_they_count_as_failed(count: int, reopened: int, state: DoorState) -> None:
    driver = doors(f"door obstacle {count}x @1s")
    driver.run(15.0, order=DoorOrder.CLOSE)
    assert driver.train.doors.left.obstructions == count
    assert driver.train.doors.left.state == state
    assert driver.hits == [1] * count
    assert driver.train.doors.left.reopened == (0 if state == DoorState.LOCKED else reopened)


@pytest.mark.parametrize(
    ("fault", "locked"),
    [("psd not locked @1s", False), ("psd not locked @1s for 10s", True), ("psd isolated @1s", True)],
)
def test_the_platform_s_doors_hold_the_train_while_they_are_not_locked(fault: str, locked: bool) -> None:
    driver = doors(fault)
    assert driver.train.doors.is_psd_locked is locked
    assert driver.train.status.doors_closed_locked is locked
    driver.run(20.0).depart(2.0)
    assert (driver.train.journey.section >= 0) is locked


def test_a_lost_lock_in_motion_brakes() -> None:
    driver = Driver("doors off @20s").run(12.0).depart(7.0)
    assert driver.train.onboard is not None
    assert driver.train.onboard.reaction == NO_REACTION
    driver.run(1.0, 5.0, hold=False)
    assert driver.train.onboard.reaction == EMERGENCY_BRAKE
    assert driver.train.traction_n == 0.0


@pytest.mark.parametrize(
    ("fault", "reaction", "bound_s"),
    [
        ("authority lost @20s", SERVICE_BRAKE, 1.2),
        ("atp dead @20s", EMERGENCY_BRAKE, 0.5),
        ("atp.speed wrong 110% @20s", EMERGENCY_BRAKE, 3.0),
        ("atp.speed wrong 90% @20s", EMERGENCY_BRAKE, 3.0),
        ("atp.odometer stuck @20s", EMERGENCY_BRAKE, 3.0),
    ],
)
def test_a_protection_that_does_not_know_brakes_in_its_time(fault: str, reaction: int, bound_s: float) -> None:
    driver = Driver(fault).run(2.0).depart(17.8)
    onboard = driver.train.onboard
    assert onboard is not None
    assert onboard.reaction == NO_REACTION
    driver.run(bound_s, 5.0, hold=False)
    assert onboard.reaction == reaction
    assert "atp" in driver.events
    assert driver.hits[0] == 1


def test_a_dead_protection_stops_the_train_even_with_a_weak_emergency_brake() -> None:
    whole, weak = (
        Driver(*faults).run(2.0).depart(18.0).run(25.0, 5.0, hold=False)
        for faults in (("atp dead @20s",), ("atp dead @20s combine", "emergency_brake weak 70% @0s combine"))
    )
    assert whole.train.is_standing
    assert weak.train.is_standing
    assert weak.train.position_01mm > whole.train.position_01mm + 10_000
    assert weak.hits == [1, 2]


def test_a_held_signal_and_a_held_dwell_delay_the_departure() -> None:
    red = Driver("signal red @1s for 10s").run(5.0)
    assert not red.train.is_departure_permitted
    assert red.run(7.0).train.is_departure_permitted
    assert red.hits == [1]


def test_a_held_dwell_lasts_longer_once() -> None:
    journey = Driver("dwell hold 45s @1s").run(3.0).train.journey
    # Nobody boards at the first stop, so it waits for the next one.
    journey.depart(300)
    journey.stand(journey.stop.position_m)
    before_s = journey.exchange_s
    assert journey.hold(45.0, 400)
    assert journey.exchange_s == pytest.approx(before_s + 45.0)
    journey.open(400)
    left_s = journey.dwell_left_s(400)
    assert left_s == pytest.approx(before_s + 45.0, abs=0.01)
    assert not journey.hold(45.0, 400 + round(left_s * TICKS_PER_S))


def test_a_stuck_docking_loop_is_found_by_the_first_motion() -> None:
    driver = Driver("docking loop stuck @1s").run(2.0).depart(3.0)
    assert driver.hits == [1]
    assert not driver.train.docking.is_in_window


@pytest.mark.slow
@pytest.mark.parametrize(("place", "word"), INJECTED, ids=lambda one: one if isinstance(one, str) else one.name)
def test_every_word_has_an_effect_or_waits_for_its_occasion(place: str, word: Word) -> None:
    """None raises, whenever it begins; an effect is never before the fault."""
    values = {one.name: 2.0 if one.usual is None else one.usual for one in word.parameters}
    text = place.split(".")
    fault = Fault(Place(*text), word.name, Trigger("time", 3.0), values)
    driver = Driver(fault)
    assert parse(fault_text(fault)) == fault
    driver.run(2.0).run(4.0, order=DoorOrder.OPEN_LEFT).run(6.0, order=DoorOrder.CLOSE).depart(5.0)
    assert all(hit.time_ns >= 3_000_000_000 for hit in driver.train.injections.log.hits)
    if place not in ("train.dwell", "train.emergency_brake") and word.name not in ("not_locked", "intermittent"):
        assert driver.hits or "right" in place


@st.composite
def station_faults(draw: st.DrawFn) -> str:
    """A fault of this module with usual values at a random time."""
    place, word = draw(st.sampled_from(INJECTED))
    values = {one.name: 2.0 if one.usual is None else one.usual for one in word.parameters}
    begin_s = draw(st.integers(0, 25))
    ends = {"duration_s": float(draw(st.integers(1, 10)))} if word.lasts and draw(st.booleans()) else {}
    level, _, name = place.partition(".")
    return fault_text(
        Fault(Place(level, name), word.name, Trigger("time", float(begin_s)), values, combine=True, **ends)
    )


@pytest.mark.slow
@pytest.mark.long
@settings(max_examples=25, deadline=None)
@given(st.lists(station_faults(), min_size=2, max_size=4), st.integers(0, 9))
def test_no_combination_opens_a_door_in_motion_or_raises(faults: list[str], seed: int) -> None:
    driver = Driver(*faults, seed=seed)
    plan = ((2.0, DoorOrder.NONE), (5.0, DoorOrder.OPEN_LEFT), (7.0, DoorOrder.CLOSE))
    for seconds, order in plan:
        driver.run(seconds, order=order)
    driver.run(0.2, ready=True, hold=False)
    for _ in range(100):
        driver.run(0.1, 5.0, order=DoorOrder.OPEN_BOTH, hold=False)
        train = driver.train
        states = {train.doors.left.state, train.doors.right.state}
        assert train.is_standing or not states & {DoorState.OPENING, DoorState.OPEN}
        assert train.status.doors_closed_locked or train.traction_n == 0.0
