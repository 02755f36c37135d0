"""One fault of a run, and the words of which its text is made.

Times are simulation time. Injectors apply a fault to a sensor, a telegram or a process: :mod:`railhil.plant_sim.faults`
in the plant, :mod:`railhil.bus.injector` at the nodes' connections.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol

from railhil.faults.truth import Truth

if TYPE_CHECKING:
    from railhil.faults.activity import Activity

#: Levels, in the order in which they act on a value on its way: from the sensor to the bus.
LEVELS = ("train", "sensor", "actuator", "command", "clock", "telegram", "node", "bus")

#: Levels of the watches, weakest first, in readable form.
WATCH_LEVELS = ("NORMAL", "HOLD", "TRACTION CUT", "SERVICE BRAKE", "EMERGENCY")

#: Event ``braking``: the train decelerates by at least this much.
BRAKING_MPS2 = 0.3

TriggerKind = Literal["time", "position", "speed", "event", "telegram", "manual", "mark"]


#: Units of parameters: keys of :data:`railhil.faults.notation.UNITS`.
SHARE, TIME, LENGTH, SPEED, NUMBER, COUNT, PPM, NAME = "share", "s", "m", "m/s", "1", "count", "ppm", "name"

#: Origins of words in several modules.
PX4, RAILWAY = "PX4 failure injection", "railway"
#: Treatment of frames held back, and continuation of a counter after its fault; the first is the usual one.
DELIVERY = ("drop", "deliver")
CONTINUING = ("correct", "last_valid", "last")


@dataclass(frozen=True, slots=True)
class Parameter:
    """A value of a word.

    ``unit``: one of the above. ``usual``: its value if none is given; None: it must be given. ``keyword``: word written
    before it in the text (``jitter 20ms``); several parameters in a row may share one (``gemodel 5% 40%``); empty: its
    place says which it is. ``low``, ``high``: allowed values, inclusive. ``example``: a value, where that of
    its unit says nothing.
    """

    name: str
    unit: str
    usual: float | str | None
    meaning: str
    keyword: str = ""
    low: float = float("-inf")
    high: float = float("inf")
    example: str = ""


@dataclass(frozen=True, slots=True)
class Word:
    """A kind of fault at a place.

    ``part``: part of a telegram: ``whole``, ``counter``, ``checksum``, ``signal``; of the bus ``whole`` or ``line``.
    ``origin``: where the word comes from. ``after``: words allowed for its end, the usual one first. ``names``: places
    of its level that have it; empty: all. ``lasts``: whether it has a duration at all.
    ``looks_back``: whether its effect depends on what passed its place before it began.
    """

    name: str
    level: str
    meaning: str
    origin: str
    parameters: tuple[Parameter, ...] = ()
    part: str = "whole"
    after: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    lasts: bool = True
    looks_back: bool = False


@dataclass(frozen=True, slots=True)
class Place:
    """The place of a fault.

    ``level``: one of :data:`LEVELS`. ``name``: the sensor, port, node, ... of that level; ``bus`` itself has none.
    ``part``: of a telegram ``counter``, ``checksum`` or the name of a signal; of the bus a line; else empty.
    """

    level: str
    name: str = ""
    part: str = ""


@dataclass(frozen=True, slots=True)
class Trigger:
    """The beginning of a fault, decided by the simulated truth.

    ``value``: s (time), m (position), m/s (speed), name of a milestone or of the watches' levels (event), number of
    the telegram of the place's port, from 1 (telegram), name and number of a planned instant of the scenario such as
    ``stop 3`` (mark: a scenario that is read has its time instead); unused for ``manual``. ``edge``: for position and
    speed, the direction of the crossing. ``delay_s``: time between the condition and the beginning of the fault.
    """

    kind: TriggerKind
    value: float | str = 0.0
    edge: Literal["rising", "falling"] = "rising"
    delay_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Draw:
    """A value drawn for each run with the seed: ``uniform`` between a and b, or ``normal`` with mean and sigma."""

    kind: Literal["uniform", "normal"]
    a: float
    b: float


#: Value of a parameter, in its base unit: a share (0 to 1), s, m, m/s, a count, a name.
Value = float | str | Draw

_NO_VALUES: Mapping[str, Value] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Expect:
    """The expected reaction to a fault; every part may be missing.

    ``level``: of one of the watches, in capitals with spaces (``TRACTION CUT``); ``within_s``: from the fault's first
    effect; ``detected_by``: a cause of the watches (``speed_age``); ``verdict``: of the run.
    """

    level: str = ""
    within_s: float | None = None
    detected_by: str = ""
    verdict: str = ""


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault. At most one of ``duration_s``, ``count`` and ``until`` ends it; without them it lasts to the end.

    ``values``: parameters of ``what`` by name. ``count``: number of telegrams that it changes. ``until``: an event, as
    a trigger's; with a mark as its trigger also a time of the run (``400s``). ``after``: treatment of frames held back
    (``drop``, ``deliver``), or continuation of a counter (``correct``, ``last_valid``, ``last``); empty: the word's
    usual one. ``seed``: of its own random numbers; None: derived from the run's seed and the fault's number. ``units``:
    of a train with several, from 1; empty: all. ``combine``: permits other faults on the same target and level. ``id``:
    its name in the catalogue.
    """

    place: Place
    what: str
    trigger: Trigger
    values: Mapping[str, Value] = field(default_factory=lambda: _NO_VALUES)
    duration_s: float | None = None
    count: int | None = None
    until: str = ""
    after: str = ""
    seed: int | None = None
    units: tuple[int, ...] = ()
    combine: bool = False
    expect: Expect | None = None
    id: str = ""

    def parameter(self, name: str) -> float:
        """A parameter as a number, in its base unit; distributions have been drawn."""
        value = self.values[name]
        assert isinstance(value, int | float)
        return float(value)

    @property
    def kills_controller(self) -> bool:
        """Whether the run is meant to continue without a controller."""
        return (self.place.level, self.place.name, self.what) == ("node", "controller", "kill")


class Random(Protocol):
    """Random numbers of one fault while it is active."""

    def random(self) -> float:
        """A number from 0 to below 1."""

    def integers(self, low: int, high: int, /, *, endpoint: bool = False) -> Any:
        """A whole number from ``low`` to below ``high``, with ``endpoint`` up to ``high``."""

    def standard_normal(self) -> float:
        """A standard normal number."""


@dataclass(frozen=True, slots=True)
class Injection:
    """Data of one run for its injectors.

    ``faults``: all of the run with their distributions drawn; number n is the n-th. ``samples``: number of a fault ->
    its random numbers. ``truth``, ``named``, ``units``: of the system; ``events``: its milestones, by number.
    """

    faults: tuple[Fault, ...]
    samples: Callable[[int], Random]
    truth: Truth | None = None
    named: Mapping[str, str] = field(default_factory=dict)
    units: tuple[str, ...] = ()
    events: Mapping[int, str] = field(default_factory=dict)


class Kind:
    """One fault of one kind.

    :cvar word: its word in the fault language.
    """

    word: ClassVar[Word]

    def __init__(self, activity: Activity) -> None:
        self.activity = activity
        self._has_begun = False

    def begins(self) -> bool:
        """Whether the fault is active and was not when last asked."""
        before, self._has_begun = self._has_begun, self.activity.active
        return self._has_begun and not before

    def parameter(self, name: str) -> float:
        """A parameter of the fault, in its base unit."""
        return self.activity.fault.parameter(name)

    def largest(self, name: str) -> float:
        """The largest possible value of a parameter: an operator may give a fault by hand other values."""
        if self.activity.fault.trigger.kind == "manual":
            return next(one.high for one in self.word.parameters if one.name == name)
        return self.parameter(name)
