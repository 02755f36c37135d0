"""Kinds of faults of traction and brake, each with its word, and a side of the train that has them.

A new kind is a class here, listed in :data:`ACTUATOR_KINDS`. The language, its documentation and the plants of all
systems read that list. Each plant defines the meaning of the fields of a :class:`SideState` for its forces or
accelerations.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING, ClassVar, Literal

from railhil.faults.model import NUMBER, PX4, RAILWAY, SHARE, TIME, Kind, Parameter, Word

if TYPE_CHECKING:
    from railhil.faults.activity import Activity


@dataclass(frozen=True, slots=True)
class SideState:
    """State of traction or brake under the active faults.

    ``share``: of its force, for any source of the command. ``poles``: factors on its pole while it acts. ``delays_s``:
    its commands act later. ``instead``: the force that it gives instead of the commanded one, in the unit of the plant;
    infinite: its full force; None: no such fault.
    """

    share: float = 1.0
    poles: tuple[float, ...] = ()
    delays_s: tuple[float, ...] = ()
    instead: float | None = None


class ActuatorFault(Kind):
    """A fault of traction or brake.

    :cvar field: the field of :class:`SideState` that it changes.
    """

    field: ClassVar[Literal["share", "poles", "delays_s", "instead"]] = "share"

    def change(self, state: SideState, present: float) -> SideState:
        """The state with this fault.

        :param present: force of the side at this instant.
        """
        if self.begins():
            self.begin(present)
        return self.changed(state) if self.activity.active else state

    def begin(self, present: float) -> None:
        """Take note of the force at the fault's first instant."""

    def changed(self, state: SideState) -> SideState:
        """The state with this fault, which is active."""
        raise NotImplementedError

    def longest_delay_s(self) -> float:
        """The longest time by which the fault can delay a command."""
        return 0.0


class ActuatorWeak(ActuatorFault):
    word = Word("weak", "actuator", "only a share of its force", RAILWAY,
                (Parameter("share", SHARE, 0.5, "share of the force that is left", low=0.0, high=1.0),))  # fmt: skip

    def changed(self, state: SideState) -> SideState:
        return replace(state, share=state.share * self.parameter("share"))


class ActuatorScale(ActuatorFault):
    word = Word("scale", "actuator", "multiplied: a train that is stronger or weaker than its data", RAILWAY,
                (Parameter("factor", NUMBER, None, "factor", low=0.01, high=100.0),))  # fmt: skip

    def changed(self, state: SideState) -> SideState:
        return replace(state, share=state.share * self.parameter("factor"))


class ActuatorOff(ActuatorFault):
    word = Word("off", "actuator", "no force", PX4)

    def changed(self, state: SideState) -> SideState:
        return replace(state, share=0.0)


class ActuatorStuck(ActuatorFault):
    word = Word("stuck", "actuator", "the force of the first instant stays", PX4)
    field = "instead"

    def begin(self, present: float) -> None:
        self._held = present

    def changed(self, state: SideState) -> SideState:
        return replace(state, instead=self._held)


class ActuatorFull(ActuatorFault):
    word = Word("full", "actuator", "full force whatever is commanded (runaway)", RAILWAY)
    field = "instead"

    def changed(self, state: SideState) -> SideState:
        return replace(state, instead=inf)


class ActuatorSlow(ActuatorFault):
    word = Word("slow", "actuator", "its pole is slower", PX4,
                (Parameter("factor", NUMBER, 0.5, "factor of the pole", low=0.001, high=1.0),))  # fmt: skip
    field = "poles"

    def changed(self, state: SideState) -> SideState:
        return replace(state, poles=(*state.poles, self.parameter("factor")))


class ActuatorDeadTime(ActuatorFault):
    word = Word("dead_time", "actuator", "commands act later", RAILWAY,
                (Parameter("delay_s", TIME, 0.2, "dead time", low=0.001, high=100.0),),
                looks_back=True)  # fmt: skip
    field = "delays_s"

    def changed(self, state: SideState) -> SideState:
        return replace(state, delays_s=(*state.delays_s, self.parameter("delay_s")))

    def longest_delay_s(self) -> float:
        return self.largest("delay_s")


#: In the order of the documentation, in which random faults are drawn, too.
ACTUATOR_KINDS: tuple[type[ActuatorFault], ...] = (
    ActuatorWeak, ActuatorScale, ActuatorOff, ActuatorStuck, ActuatorFull, ActuatorSlow, ActuatorDeadTime
)  # fmt: skip


class FaultySide:
    """Traction or brake with its faults, in the order of their numbers.

    :ivar state: its state under the active faults, from :meth:`change`.
    """

    def __init__(self, activities: Iterable[Activity]) -> None:
        self.faults: list[ActuatorFault] = []
        self.state = SideState()
        self.take(activities)

    def take(self, activities: Iterable[Activity]) -> None:
        """Have these faults from now on; those that it has already keep their state."""
        kinds = {kind.word.name: kind for kind in ACTUATOR_KINDS}
        before = {one.activity: one for one in self.faults}
        self.faults = [before.get(one) or kinds[one.fault.what](one) for one in activities if one.fault.what in kinds]

    def change(self, present: float) -> None:
        """Take the faults that have begun or ended.

        :param present: force of the side at this instant.
        """
        state = SideState()
        for one in self.faults:
            state = one.change(state, present)
        self.state = state
