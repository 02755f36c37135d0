"""Numbers in the telegrams of the bench: its enumerations, flags, and how milestones are sent."""

from __future__ import annotations

from enum import IntFlag

from railhil.bus.telegrams import Event, FaultOrder, Role, SupCommand, TimeState

__all__ = [
    "EVENT_COPIES",
    "EVENT_SPACING_NS",
    "ControllerFlag",
    "Event",
    "FaultOrder",
    "Role",
    "SupCommand",
    "TimeState",
    "ends_run",
]

#: Number of times each milestone is sent, first at its tick, then at this spacing: longer than the assembly time of one
#: telegram, so that a disturbance of one copy cannot affect the next. All copies of a run's last milestone are sent at
#: once. A receiver recognises repetitions by the number and drops them; a missing number means that a milestone was
#: lost.
EVENT_COPIES = 3
EVENT_SPACING_NS = 20_000_000

_ENDS = frozenset(event for event in Event if event >= Event.ENDED_COMPLETE)


def ends_run(milestone: int) -> bool:
    """Whether a milestone is the last of its run. A milestone of a system's own never ends the run."""
    return milestone in _ENDS


class ControllerFlag(IntFlag):
    """OverflowFlags: events in the controller since its start."""

    WRAP = 1
    SATURATION = 2
    DIVISION_BY_ZERO = 4
    MESSAGE_LOST = 8
