"""The course of a run over a line: which milestone belongs to which stop.

Milestones are assigned by the order of the run. Places alone do not decide: out and back have equal ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from railhil.judge.record_checks import UNCLEAR
from railhil.systems.line.judge.milestones import Milestone
from railhil.systems.line.scenario.model import LineScenario, StationStop

#: Distance from a stop beyond which its milestone belongs to another one, m. A train may stop far beyond a missed stop.
_PASSING_MAX_M: Final = 1.0


@dataclass(slots=True)
class Visit:
    """The milestones of one stop. ``stop``: its number in ``LineScenario.stops``, from 0."""

    stop: int
    arrived: Milestone | None = None
    departed: Milestone | None = None
    passed: Milestone | None = None
    missed: Milestone | None = None
    jogs: list[Milestone] = field(default_factory=list)
    opened: list[Milestone] = field(default_factory=list)
    locked: list[Milestone] = field(default_factory=list)
    refused: list[Milestone] = field(default_factory=list)

    @property
    def is_here(self) -> bool:
        """Whether the train has come here, or begun here, and has not left."""
        return self.departed is None and (self.stop == 0 or self.arrived is not None)

    @property
    def creeps(self) -> list[Milestone]:
        """The creeps towards the stop: a train that moves with doors that have opened rolls, and has stopped before."""
        return [told for told in self.jogs if not self.opened or told.instant_s < self.opened[0].instant_s]


@dataclass(frozen=True, slots=True)
class Course:
    """Visits in the order of the stops of the run.

    ``protection``: milestones of the train protection; ``emergencies``: those of the emergency brake; ``under_way``:
    milestones of doors between two stops. ``contradiction``: the first milestone that cannot stand in its place, as a
    reason; empty if there is none.
    """

    visits: tuple[Visit, ...]
    protection: tuple[Milestone, ...] = ()
    emergencies: tuple[Milestone, ...] = ()
    under_way: tuple[Milestone, ...] = ()
    contradiction: str = ""


def course_of(scenario: LineScenario, milestones: Sequence[Milestone]) -> Course:
    """The course of a run from its milestones, in the order of their numbers."""
    walk = _Walk(scenario)
    contradiction = next(filter(None, map(walk.take, milestones)), "")
    return Course(
        tuple(walk.visits),
        tuple(told for told in milestones if told.kind == "atp"),
        tuple(told for told in milestones if told.kind == "emergency"),
        tuple(walk.under_way),
        contradiction,
    )


class _Walk:
    """Takes milestones one after another."""

    def __init__(self, scenario: LineScenario) -> None:
        self._stops = scenario.stops
        self.visits = [Visit(place) for place in range(len(scenario.stops))]
        self.under_way: list[Milestone] = []
        #: The stop where the train stands, or which it left last.
        self._at = self.visits[0]
        #: The next one that it passes or arrives at.
        self._next = 1
        self._take: dict[str, Callable[[Milestone], str]] = {
            "departure": self._departure,
            "passed": self._passed,
            "arrived": self._arrived,
            "jog": self._jog,
            "missed": self._missed,
            "doors_open": self._doors,
            "doors_locked": self._doors,
            "door_refused": self._refused,
        }

    def take(self, told: Milestone) -> str:
        """Assign a milestone.

        :returns: why it cannot be, as a reason; empty if it can.
        """
        taken = self._take.get(told.kind)
        return "" if taken is None else taken(told)

    def _wrong(self, told: Milestone, said: str) -> str:
        return f"{UNCLEAR}RUN_EVENT {told.number} says {told.kind} at {told.instant_s:.2f} s, but {said}"

    def _names(self, place: int) -> str:
        return f"stop {stop_name(self._stops, place)}"

    def _departure(self, told: Milestone) -> str:
        if not self._at.is_here:
            return self._wrong(told, f"no arrival after the departure from {self._names(self._at.stop)}")
        self._at.departed = told
        return ""

    def _passed(self, told: Milestone) -> str:
        if self._at.is_here:
            return self._wrong(told, f"no departure from {self._names(self._at.stop)}")
        if self._next >= len(self._stops) or self._stops[self._next].service != "pass":
            return self._wrong(told, "no stop is to be passed there")
        if abs(told.position_m - self._stops[self._next].position_m) > _PASSING_MAX_M:
            return self._wrong(told, f"{self._names(self._next)} is not at {told.position_m:.2f} m")
        self.visits[self._next].passed = told
        self._next += 1
        return ""

    def _arrived(self, told: Milestone) -> str:
        if self._at.is_here:
            return self._wrong(told, f"no departure from {self._names(self._at.stop)}")
        place = next((at for at in range(self._next, len(self._stops)) if self._stops[at].service != "pass"), None)
        if place is None:
            return self._wrong(told, "no stop is left")
        if unpassed := [self._names(at) for at in range(self._next, place)]:
            return self._wrong(told, f"{unpassed[0]} was not passed")
        self._at, self._next = self.visits[place], place + 1
        self._at.arrived = told
        return ""

    def _jog(self, told: Milestone) -> str:
        if self._at.arrived is None or not self._at.is_here:
            return self._wrong(told, "the train is at no stop")
        self._at.jogs.append(told)
        return ""

    def _missed(self, told: Milestone) -> str:
        """It comes in the tick of the departure, before or after it."""
        if self._at.arrived is None:
            return self._wrong(told, "the train has arrived at no stop")
        self._at.missed = told
        return ""

    def _doors(self, told: Milestone) -> str:
        if not self._at.is_here:
            self.under_way.append(told)
        elif told.kind == "doors_open":
            self._at.opened.append(told)
        else:
            self._at.locked.append(told)
        return ""

    def _refused(self, told: Milestone) -> str:
        self._at.refused.append(told)
        return ""


def stop_name(stops: Sequence[StationStop], place: int) -> str:
    """A stop as verdicts and tables name it: its number, as on the wire, and its name; out and back have equal names.

    :param place: its number from 0.
    """
    return f"{place + 1} {stops[place].name}"


def served_visits(scenario: LineScenario, course: Course) -> Iterator[Visit]:
    """The visits of stops at which the train has to stop, without the first one."""
    for visit in course.visits[1:]:
        if scenario.stops[visit.stop].service != "pass":
            yield visit
