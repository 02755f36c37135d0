"""Faults of doors, stops and track side; a kind of fault is a class here, listed in :data:`KINDS` by its word.

Before each tick the equipment is made healthy and the active faults act, in the order of their numbers; after it each
fault notes whether it has changed anything.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from railhil.faults.activity import Activity
from railhil.faults.words import ONLY
from railhil.plant_sim.faults.injections import Injections
from railhil.plant_sim.line.brakes import EmergencyForce, HoldingBrake
from railhil.plant_sim.line.doors import CLOSING, FAULT, ISOLATED, LOCKED, OPENING, DoorSet, TrainDoors

if TYPE_CHECKING:
    from railhil.plant_sim.line.faults.train import FaultyLineTrain


class StationFault:
    """A fault of the equipment of a line."""

    def __init__(self, activity: Activity, train: FaultyLineTrain, injections: Injections) -> None:
        self.activity = activity
        self.train = train
        self._injections = injections

    @property
    def active(self) -> bool:
        """Whether it is active."""
        return self.activity.active

    def act(self) -> None:
        """Act over the coming tick, while it is active."""

    def note(self) -> None:
        """Note whether the last tick shows it."""

    def effect(self, acts: bool, before: str, after: str) -> None:
        """Note an effect that lasts."""
        self._injections.effect(self.activity, acts, before, after)


def _doors_of(doors: TrainDoors, place: str) -> list[DoorSet]:
    """The doors at the place of a fault."""
    if place == "psd":
        return [doors.psd]
    sides = {"door_left": [doors.left], "door_right": [doors.right]}
    return sides.get(place, [doors.left, doors.right])


class DoorFault(StationFault):
    """A fault of doors."""

    def __init__(self, activity: Activity, train: FaultyLineTrain, injections: Injections) -> None:
        super().__init__(activity, train, injections)
        self.doors = _doors_of(train.doors, activity.fault.place.name)

    def in_state(self, *states: int) -> bool:
        """Whether one of the doors is in one of these states."""
        return any(door.state in states for door in self.doors)


class StuckOpen(DoorFault):
    """``stuck_open``: they open, but do not close."""

    def act(self) -> None:
        for door in self.doors:
            door.is_stuck = True

    def note(self) -> None:
        self.effect(self.active and self.in_state(CLOSING, FAULT), "closing", "open")


class Slow(DoorFault):
    """``slow``: they take longer to open and to close."""

    def act(self) -> None:
        for door in self.doors:
            door.slowness *= self.activity.fault.parameter("factor")

    def note(self) -> None:
        factor = self.activity.fault.parameter("factor")
        self.effect(self.active and factor > 1.0 and self.in_state(OPENING, CLOSING), "1", f"{factor:g}")


class Obstacle(DoorFault):
    """``obstacle``: closings meet an obstacle."""

    _met = 0
    _before: tuple[int, ...] = ()

    def act(self) -> None:
        self._before = tuple(door.obstructions for door in self.doors)
        if self._met < self.activity.fault.parameter("closings"):
            for door in self.doors:
                door.obstacles = 1

    def note(self) -> None:
        for door, before in zip(self.doors, self._before, strict=False):
            if self.active and door.obstructions > before:
                self._met += 1
                self._injections.hit(self.activity, "closing", "obstructed")


class NotLocked(DoorFault):
    """``not_locked``, and ``off`` of the train's doors: closed doors are not locked."""

    def act(self) -> None:
        for door in self.doors:
            door.has_lost_lock = True

    def note(self) -> None:
        doors = self.train.doors
        is_there = doors.has_psd or self.doors != [doors.psd] or bool(self.train.journey.passed_platforms)
        self.effect(self.active and is_there and self.in_state(LOCKED), "locked", "not locked")


class Isolated(DoorFault):
    """``isolated``: locked by hand."""

    def act(self) -> None:
        for door in self.doors:
            door.isolate()

    def note(self) -> None:
        self.effect(self.active, "locked", "isolated")


class DwellHold(StationFault):
    """``hold``: the exchange of the present stop takes longer, or that of the next one if it is over."""

    _held = False

    def act(self) -> None:
        if self._held:
            return
        extra_s = self.activity.fault.parameter("extra_s")
        self._held = self.train.journey.hold(extra_s, self.train.tick)
        if self._held:
            self._injections.hit(self.activity, "0 s", f"{extra_s:g} s")


class SignalRed(StationFault):
    """``red``: one signal of the route, or all of them and the exits of the stops."""

    def act(self) -> None:
        self.train.journey.held_red.add(int(self.activity.fault.parameter(ONLY.name)))

    def note(self) -> None:
        train = self.train
        self.effect(self.active and train.journey.is_held_red(train.position_01mm / 1e4, train.tick), "clear", "red")


class AuthorityLost(StationFault):
    """``lost``: the train protection receives no authority."""

    def act(self) -> None:
        if self.train.onboard is not None:
            self.train.onboard.has_authority = False

    def note(self) -> None:
        self.effect(self.active and self.train.onboard is not None, "authority", "none")


class ProtectionDead(StationFault):
    """``dead``: the train protection does nothing any more."""

    def act(self) -> None:
        if self.train.onboard is not None:
            self.train.onboard.is_dead = True

    def note(self) -> None:
        self.effect(self.active and self.train.onboard is not None, "alive", "dead")


class WeakBrake(StationFault):
    """``weak``: holding brake or emergency brake with a share of its force."""

    def act(self) -> None:
        brake = self._brake
        if brake is not None:
            brake.share *= self.activity.fault.parameter("share")

    def note(self) -> None:
        train = self.train
        acts = train.holding.is_applied if self._is_holding else train.is_emergency
        share = self.activity.fault.parameter("share")
        self.effect(self.active and share < 1.0 and acts and self._brake is not None, "1", f"{share:g}")

    @property
    def _is_holding(self) -> bool:
        return self.activity.fault.place.name == "holding_brake"

    @property
    def _brake(self) -> HoldingBrake | EmergencyForce | None:
        return self.train.holding if self._is_holding else self.train.emergency


class LoopFault(StationFault):
    """A docking loop that says what it said at the first instant (``stuck``), nothing (``off``), or nothing at times.

    A loop that says nothing finds no train in the window.
    """

    _held: bool | None = None

    def __init__(self, activity: Activity, train: FaultyLineTrain, injections: Injections) -> None:
        super().__init__(activity, train, injections)
        self._source = injections.samples(activity)
        self._is_silent = True

    def act(self) -> None:
        loop, fault = self.train.docking, self.activity.fault
        if self._held is None:
            self._held = loop.is_in_window if fault.what == "stuck" else False
        if fault.what == "intermittent" and self.train.tick % loop.period_ticks == 0:
            self._is_silent = self._source.random() < fault.parameter("share")
        if self._is_silent:
            loop.stuck = self._held

    def note(self) -> None:
        if not self.active:
            self._held = None
        is_there = self.train.is_in_window
        acts = self._held is not None and self._is_silent and is_there is not self._held
        self.effect(acts, str(is_there), str(self._held))


#: Word -> class of the kind.
KINDS: Mapping[str, Callable[[Activity, FaultyLineTrain, Injections], StationFault]] = {
    "stuck_open": StuckOpen,
    "slow": Slow,
    "obstacle": Obstacle,
    "not_locked": NotLocked,
    "isolated": Isolated,
    "hold": DwellHold,
    "red": SignalRed,
    "lost": AuthorityLost,
    "dead": ProtectionDead,
    "weak": WeakBrake,
}
#: Places with these words; the doors' own interlock is that of the status.
PLACES = (
    *("door", "door_left", "door_right", "psd", "dwell", "signal", "authority", "atp"),
    *("holding_brake", "emergency_brake"),
)


class Stations:
    """The faults of this module in a run, in the order of their numbers."""

    def __init__(self, train: FaultyLineTrain, injections: Injections) -> None:
        self.faults: list[StationFault] = []
        self._train = train
        injections.attach(lambda: self._take(injections))

    def _take(self, injections: Injections) -> None:
        before, train = {one.activity: one for one in self.faults}, self._train
        kinds = {one: KINDS[one.fault.what] for one in injections.at("train", *PLACES)}
        kinds |= dict.fromkeys(injections.at("train", "doors"), NotLocked)
        kinds |= dict.fromkeys(injections.at("sensor", "docking_loop"), LoopFault)
        found = [before.get(one) or kind(one, train, injections) for one, kind in kinds.items()]
        self.faults = sorted(found, key=lambda one: one.activity.number)

    def act(self) -> None:
        """Let the active faults act over the coming tick."""
        if not self.faults:
            return
        self._heal()
        for one in self.faults:
            if one.active:
                one.act()
        self._train.show_doors()

    def note(self) -> None:
        """Note what the last tick shows."""
        for one in self.faults:
            one.note()

    def _heal(self) -> None:
        train = self._train
        for door in (train.doors.left, train.doors.right, train.doors.psd):
            door.is_stuck = door.has_lost_lock = False
            door.slowness, door.obstacles = 1.0, 0
            if door.state == ISOLATED:
                door.state = LOCKED
        train.docking.stuck = None
        train.journey.held_red.clear()
        if train.onboard is not None:
            train.onboard.has_authority, train.onboard.is_dead = True, False
        train.holding.share = 1.0
        if train.emergency is not None:
            train.emergency.share = 1.0
