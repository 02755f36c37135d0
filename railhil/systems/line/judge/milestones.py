"""The milestones of a record, each once, and whether their telegrams contradict each other.

The plant numbers the milestones of a run from 1 and sends each three times. A copy that differs from the others under
the same number, or a milestone after the one that ends the run, comes from another source or is damaged: the record is
then not judged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Final

from railhil.bus.codes import Event, ends_run
from railhil.bus.telegrams import RunEvent
from railhil.judge.record_checks import UNCLEAR
from railhil.record.trace import Trace

#: An instant that is later in a milestone of smaller number, in s: two events of one tick may be exchanged.
_TICK_S: Final = 0.02


@dataclass(frozen=True, slots=True)
class Milestone:
    """A milestone: its number in the run, its name, its instant in s and the train's true position in m."""

    number: int
    kind: str
    instant_s: float
    position_m: float


def milestones_of(scenario: Any, trace: Trace) -> tuple[tuple[Milestone, ...], str]:
    """The milestones in the order of their numbers, and the first contradiction of their telegrams.

    :returns: the milestones, and a reason that begins with :data:`~railhil.judge.record_checks.UNCLEAR`; empty if the
        telegrams agree.
    """
    names = {event.value: event.name.lower() for event in Event}
    names |= {number: name for name, number in scenario.installed_system.events.items()}
    columns = (
        trace.raw(RunEvent.PORT, "EventNumber"),
        trace.raw(RunEvent.PORT, "RunEvent"),
        trace.values(RunEvent.PORT, "EventTime"),
        trace.values(RunEvent.PORT, "EventPos"),
    )
    found: dict[int, Milestone] = {}
    for number, code, instant_s, position_m in zip(*(column.tolist() for column in columns), strict=True):
        told = Milestone(number, names.get(code, str(code)), instant_s, position_m)
        known = found.setdefault(number, told)
        if known != told:
            said = f"{known.kind} at {known.instant_s:.2f} s and {told.kind} at {told.instant_s:.2f} s"
            return (), f"{UNCLEAR}RUN_EVENT {number} says {said}"
    if not all(found):
        return (), f"{UNCLEAR}RUN_EVENT 0 says {found[0].kind}, but milestones are numbered from 1"
    listed = tuple(found[number] for number in sorted(found))
    return listed, _disorder(listed, names)


def _disorder(listed: Sequence[Milestone], names: dict[int, str]) -> str:
    """A milestone that cannot stand where its number puts it, as a reason."""
    ends = {name for code, name in names.items() if ends_run(code)}
    for before, after in pairwise(listed):
        if before.kind in ends:
            return f"{UNCLEAR}RUN_EVENT {after.number} says {after.kind} after {before.kind}, which ends the run"
        if after.instant_s < before.instant_s - _TICK_S:
            said = f"{after.kind} at {after.instant_s:.2f} s after {before.kind} at {before.instant_s:.2f} s"
            return f"{UNCLEAR}RUN_EVENT {after.number} says {said}"
    return ""
