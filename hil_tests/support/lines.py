"""A line of four stops made by hand, and a driver for its train: no law, only a speed and orders for the doors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from functools import lru_cache
from itertools import pairwise
from math import sqrt
from typing import Any

from railhil.bus.layout import FLAG_FALSE, FLAG_TRUE, flag
from railhil.plant_sim.line.train import LineTrain
from railhil.scenarios.load import load
from railhil.scenarios.profiles import Profile
from railhil.systems.ato.scenario.generate import CurveLimits, generate
from railhil.systems.ato.scenario.model import Balise, Line, RunPlan, Scenario, Uniform
from railhil.systems.line.scenario.model import (
    EmergencyBrake,
    Hold,
    LinePerturbations,
    LineScenario,
    Route,
    RouteSignal,
    Section,
    StationStop,
)
from railhil.systems.line.scenario.sections import cut_section
from railhil.wire.ato import NotchCmd
from railhil.wire.line import DoorCmd, DoorOrder

STOPS = (
    StationStop("A", 0.0, platform="left", psd=True, depart_s=5.0),
    StationStop("B", 1200.0, platform="left", psd=True, arrive_s=137.0, depart_s=167.0),
    StationStop("C", 2300.0, service="pass"),
    StationStop("D", 3420.0, platform="right", psd=True, arrive_s=340.0, service="terminal"),
)


#: Out to B and back, in run positions.
OUT_AND_BACK = (
    STOPS[0],
    replace(STOPS[1], turn_back=True),
    StationStop("A again", 2400.0, leg=1, platform="right", psd=True, arrive_s=300.0, service="terminal"),
)
GRADES: Profile = ((-118.0, 0.0), (600.0, -8.0), (1500.0, 4.0), (2600.0, 0.0))
LIMITS: Profile = ((-118.0, 60 / 3.6), (20.0, 80 / 3.6), (3300.0, 60 / 3.6))


def make_leg(number: int, stops: tuple[StationStop, ...], grade_permil: Profile, speed_limit_mps: Profile) -> Line:
    """A leg with balises in front of its served stops, numbered along the leg."""
    served_m = [stop.position_m for stop in stops[1:] if stop.service != "pass" and stop.leg == number]
    places_m = [at_m - before_m for at_m in served_m for before_m in (180.0, 90.0, 40.0, 10.0, 0.0)]
    balises = tuple(Balise(20 * number + place, at_m, at_m) for place, at_m in enumerate(places_m, 1))
    return Line(f"leg {number}", grade_permil, speed_limit_mps, balises)


def out_and_back() -> LineScenario:
    """To the second stop and back to the first one."""
    out = make_leg(0, OUT_AND_BACK, GRADES, LIMITS)
    back = make_leg(1, OUT_AND_BACK, ((1082.0, 8.0), (1800.0, 0.0)), ((1082.0, 60 / 3.6),))
    return four_stops(stops=OUT_AND_BACK, legs=(out, back))


@lru_cache
def four_stops(
    disturbance_s: float = 0.0,
    signals: tuple[RouteSignal, ...] = (),
    stops: tuple[StationStop, ...] = STOPS,
    legs: tuple[Line, ...] = (),
    **route: Any,
) -> LineScenario:
    """The four-stop line of the documentation; it leaves its first stop at 5 s.

    :param legs: of other stops.
    """
    single = load("yizhuang_05")
    assert isinstance(single, Scenario)
    served = [number for number, stop in enumerate(stops) if stop.service != "pass"]
    legs = legs or (make_leg(0, stops, GRADES, LIMITS),)
    sections = []
    for departure, arrival in pairwise(served):
        here, there = stops[departure], stops[arrival]
        running_s = (there.arrive_s or 0.0) - (here.depart_s or 0.0)
        track = cut_section(legs[there.leg], single.train, here.position_m, there.position_m, "section")
        target = generate(track, single.train, there.position_m - here.position_m, running_s, CurveLimits())
        sections.append(Section(departure, arrival, there.leg, running_s, running_s, target))
    last = stops[-1]
    common = {item.name: getattr(single, item.name) for item in fields(Scenario)} | {
        "name": "four_stops",
        "title": "Four stops, one skipped",
        "system": "line",
        "line": legs[0],
        "target": sections[0].target,
        "plan": RunPlan(last.position_m, last.arrive_s or 0.0, 0.3, 5.0, 300.0),
        "perturbations": LinePerturbations(),
    }
    return LineScenario(
        **common,
        legs=legs,
        stops=stops,
        sections=tuple(sections),
        route=replace(
            Route(dwell_disturbance_s=Uniform(0.0, disturbance_s), hold=Hold(0.0, Uniform(20.0, 60.0))), **route
        ),
        signals=signals,
        emergency=EmergencyBrake(),
    )


class Driver:
    """Drives a train over its line by its true place, and orders its doors as the timetable says.

    ``door_life`` is the life sign of the next DOOR_CMD; :attr:`events` are all events of the train so far.

    :param heeds_due: it waits for the due departure.
    """

    #: Deceleration of its braking curve, and its speed in front of a stop.
    BRAKING_MPS2 = 0.4
    CREEP_MPS = 0.3

    def __init__(self, train: LineTrain, line: LineScenario, heeds_due: bool = True) -> None:
        self.train, self.line, self.heeds_due = train, line, heeds_due
        self.events: list[Any] = []
        self.order = DoorOrder.NONE
        self._notch_life = self.door_life = 0
        self.aim_m = 0.0

    def run(self, until: Callable[[], bool], most_s: float = 800.0) -> None:
        """Drive until something is true."""
        most = self.train.tick + round(most_s * 100)
        while not until():
            assert self.train.tick < most, f"at {self.train.position_01mm / 1e4} m"
            self.tick()

    def tick(self) -> None:
        """A tick: commands, then motion."""
        train = self.train
        if train.tick % 2 == 0:
            self.give_notch(self.notch())
        if train.tick % 4 == 0:
            self.give_door(**self.orders())
        train.advance()
        for event in train.drain_events():
            train.ending.happened(event.kind, train.tick)
            self.events.append(event)

    def kinds(self, *without: str) -> list[str]:
        """Kinds of the events so far, without those of balises and the watch."""
        return [event.kind for event in self.events if event.kind not in ("balise", "watch", *without)]

    def give_notch(self, notch: float) -> None:
        self.train.take(NotchCmd(round(notch * 256), life=self._notch_life))
        self._notch_life = (self._notch_life + 1) % 16

    def give_door(self, **values: int) -> None:
        self.train.take(DoorCmd(**values, life=self.door_life))
        self.door_life = (self.door_life + 1) % 16

    # -- what it does -------------------------------------------------------------------------------------------------

    def orders(self) -> dict[str, int]:
        """Its orders for doors, brake and departure."""
        train, journey = self.train, self.train.journey
        here = train.station_here
        if here is None:
            standing_away = train.is_standing and not journey.has_arrived
            leaving = standing_away and train.position_01mm < self.aim_m * 1e4 - 500_000
            return {"hold_brake": FLAG_FALSE, "depart_ready": flag(leaving), "station": journey.arrival}
        stop, now_s = self.line.stops[here], train.tick * 0.01
        values = {"hold_brake": FLAG_TRUE, "station": here + 1, "order": DoorOrder.NONE}
        at_first = journey.section < 0
        if not journey.has_opened and not at_first:
            if train.docking.is_in_window:
                self.order = DoorOrder.OPEN_LEFT if stop.platform == "left" else DoorOrder.OPEN_RIGHT
                values["order"] = self.order
            elif self.creeps():
                values["hold_brake"] = FLAG_FALSE
            elif (train.tick - train.stood_from_tick) > 1000:
                values |= self.departure(stop, now_s)
            return values
        if not train.doors.are_locked:
            closing = journey.dwell_left_s(train.tick) == 0.0 and (
                not self.heeds_due or now_s >= (stop.depart_s or 0.0) - 5.0
            )
            values["order"] = DoorOrder.CLOSE if closing or self.order == DoorOrder.CLOSE else self.order
            self.order = DoorOrder(values["order"])
            return values
        return values | self.departure(stop, now_s)

    def departure(self, stop: StationStop, now_s: float) -> dict[str, int]:
        """The order to depart, when it is due and permitted."""
        due = stop.depart_s is not None and (not self.heeds_due or now_s >= stop.depart_s)
        if not due or not self.train.is_departure_permitted or self.train.tick % 50 != 0:
            return {}
        section = self.line.sections[self.train.journey.section + 1]
        self.aim_m = self.line.stops[section.arrival].position_m
        self.order = DoorOrder.NONE
        return {"depart_ready": FLAG_TRUE, "hold_brake": FLAG_FALSE}

    def creeps(self) -> bool:
        """Whether it creeps to the stopping point, from short of the window."""
        left_m = self.train.journey.stop.position_m - self.train.position_01mm / 1e4
        return 0.3 < left_m < 5.0

    def notch(self) -> float:
        """Its notch: the speed of a braking curve to the stopping point, at most 60 km/h."""
        train = self.train
        here = train.station_here
        if here is not None and not (self.creeps() and train.journey.section >= 0 and not train.journey.has_opened):
            return 0.0
        left_m = self.aim_m - train.position_01mm / 1e4
        speed = train.true_speed_01mmps / 1e4
        return self.notch_for(left_m, speed)

    def notch_for(self, left_m: float, speed_mps: float) -> float:
        """The notch whose force gives the wanted speed; it leads the actuator, which is slow."""
        train, motion = self.train._train, self.train._motion
        if left_m <= 0.15:
            return -7.0
        wanted = min(55 / 3.6, sqrt(2 * self.BRAKING_MPS2 * max(0.0, left_m - 3.0) + self.CREEP_MPS**2))
        braking = self.BRAKING_MPS2 if wanted < 55 / 3.6 and left_m > 3.0 else 0.0
        force = train.inertial_mass_kg * ((wanted - speed_mps) * 0.8 - braking) + 5000.0
        lead = motion.actuator_n + 4.0 * (force - motion.actuator_n)
        return max(-7.0, min(7.0, lead / train.force_per_notch_n))
