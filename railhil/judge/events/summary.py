"""Summary of the events of a run, with its injected faults: one line for people, one entry of ``score.json``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from railhil.common.errors import InputError
from railhil.judge.declared import Watch
from railhil.judge.events.event import FAULT, LEVEL, LOST, MISSED_POLL, REFUSED, RecordedEvent
from railhil.judge.judging import judging_of
from railhil.scenarios.model import AnyScenario

#: Largest number of faults named in the line of a verdict; the others are counted.
_SAID_MAX = 3


def fault_events(found: Iterable[Mapping[str, Any]], end_s: float) -> Iterator[RecordedEvent]:
    """One event for each fault that became active, from then until its end; ``count``: the number of its changes.

    :param found: entries of ``injected`` in ``certificate.json``
        (:meth:`railhil.judge.fault_report.FaultOutcome.as_json`).
    :param end_s: end of the record, until which a fault without an end lasts.
    """
    for one in found:
        if one["begun_s"] is None:
            continue
        hits, until_s = one["hits"], one["ended_s"]
        effect = f"{hits} hits, first at {one['effect_s']:.2f} s" if hits else "changed nothing"
        place, cause = _parts(one["fault"])
        detail = f"fault {one['number']}: {one['fault']}: {effect}"
        end_of_it = end_s if until_s is None else until_s
        yield RecordedEvent(one["begun_s"], place, FAULT, cause, count=hits, until_s=end_of_it, detail=detail)


def _parts(text: str) -> tuple[str, str]:
    """Place and effect of a fault, without its time: ``TRN_SPEED`` and ``loss 30%``."""
    # A run without faults does not load their language.
    from railhil.faults.language import fault_text, parse
    from railhil.faults.notation import place_text

    try:
        fault = parse(text, "injected")
    except InputError:
        # Written by another version.
        place, _, rest = text.partition(" ")
        return place, rest
    place = place_text(fault.place)
    return place, fault_text(fault, judging=False).split(" @")[0].removeprefix(place).strip()


def faults_said(events: Sequence[RecordedEvent]) -> list[str]:
    """The faults that changed something, in words for the line of the verdict."""
    own = [event for event in events if event.kind == FAULT and event.count]
    said = [f"fault {event.source} {event.cause} from {event.time_s:.2f} s" for event in own[:_SAID_MAX]]
    return [*said, *([f"{len(own) - _SAID_MAX} more faults"] if len(own) > _SAID_MAX else [])]


#: Frames of other systems on a shared bus are no disturbance.
_FOREIGN = "unknown_id"


@dataclass(frozen=True, slots=True)
class Reaction:
    """The reaction of one watch in a run.

    ``first``: its first departure from normal; ``worst``: its first arrival at its strongest level. ``times``: number
    of arrivals at that level from a weaker one; ``seconds``: time at each level, weakest first.
    """

    watch: Watch
    first: RecordedEvent
    worst: RecordedEvent
    times: int
    seconds: dict[str, float]

    def sentence(self) -> str:
        """The strongest level with its first instant and cause, and the number of arrivals or its duration."""
        often = f"{self.times} times" if self.times > 1 else f"for {self.seconds[self.worst.level]:.2f} s"
        why = ", ".join(filter(None, (self.worst.detail, often)))
        level = level_shown(self.worst.level)
        return " ".join(
            filter(None, (self.watch.title, level, f"from {self.worst.time_s:.2f} s", f"({why})" if why else ""))
        )

    def as_json(self) -> dict[str, Any]:
        """Its entry under ``events.watches`` of ``score.json``."""
        return {
            "first": _entry(self.first),
            "worst": _entry(self.worst) | {"times": self.times},
            "seconds": {level: round(lasted_s, 4) for level, lasted_s in self.seconds.items()},
        }


def level_shown(level: str) -> str:
    """A level in readable form."""
    return level.upper().replace("_", " ")


def _entry(event: RecordedEvent) -> dict[str, Any]:
    return {"level": event.level, "time_s": event.time_s, "cause": event.cause, "detail": event.detail}


def reactions(scenario: AnyScenario, events: Sequence[RecordedEvent]) -> list[Reaction]:
    """The reactions of all watches that have left normal, in the order of the watches."""
    found = (_reaction(watch, events) for watch in judging_of(scenario).watches)
    return [reaction for reaction in found if reaction is not None]


def _reaction(watch: Watch, events: Sequence[RecordedEvent]) -> Reaction | None:
    own = [event for event in events if event.kind == LEVEL and event.source == watch.name]
    if not own:
        return None
    seconds: dict[str, float] = {}
    for event in sorted(own, key=lambda event: event.rank):
        seconds[event.level] = seconds.get(event.level, 0.0) + event.lasted_s
    worst = max(own, key=lambda event: event.rank)
    times = sum(
        event.rank == worst.rank and (before is None or before.rank != worst.rank or before.until_s != event.time_s)
        for before, event in zip([None, *own], own, strict=False)
    )
    return Reaction(watch, own[0], worst, times, seconds)


def _counts(events: Iterable[RecordedEvent], kind: str) -> dict[str, dict[str, int]]:
    found: dict[str, dict[str, int]] = {}
    for event in events:
        if event.kind == kind:
            causes = found.setdefault(event.source, {})
            causes[event.cause] = causes.get(event.cause, 0) + event.count
    return found


def counts_said(events: Iterable[RecordedEvent], kind: str) -> str:
    """Telegrams of a kind of event by port and cause, in words; empty without any."""
    return ", ".join(
        f"{port} {count} ({cause})" for port, causes in _counts(events, kind).items() for cause, count in causes.items()
    )


def summary(scenario: AnyScenario, events: Sequence[RecordedEvent]) -> dict[str, Any]:
    """``events`` of ``score.json``.

    ``watches``: for each watch its first and worst reaction, null if it stayed at normal; ``refused`` telegrams by port
    and cause; ``lost`` telegrams and ``missed_polls`` by port; ``faults`` that became active, in their order.
    """
    reacted = {reaction.watch.name: reaction.as_json() for reaction in reactions(scenario, events)}
    return {
        "watches": {watch.name: reacted.get(watch.name) for watch in judging_of(scenario).watches},
        "refused": _counts(events, REFUSED),
        "lost": {port: sum(causes.values()) for port, causes in _counts(events, LOST).items()},
        "missed_polls": {port: sum(causes.values()) for port, causes in _counts(events, MISSED_POLL).items()},
        "faults": [
            {"time_s": event.time_s, "until_s": event.until_s, "hits": event.count, "detail": event.detail}
            for event in events
            if event.kind == FAULT
        ],
    }


def why(scenario: AnyScenario, events: Sequence[RecordedEvent]) -> str:
    """One sentence on the reactions of the watches, or without reactions on telegrams that were refused, lost or
    missing; then on the injected faults.

    Empty for a healthy run.
    """
    found = [reaction.sentence() for reaction in reactions(scenario, events)]
    if not found:
        found = [
            f"{sum(causes.values())} {port} {said} ({', '.join(causes)})"
            for kind, said in ((REFUSED, "refused"), (LOST, "lost"), (MISSED_POLL, "polls missed"))
            for port, causes in _counts(events, kind).items()
            if _FOREIGN not in causes
        ]
    return "; ".join([*found, *faults_said(events)])


def explained(line: str, reason: str) -> str:
    """The line of a verdict with :func:`why`."""
    return " - ".join(filter(None, (line, reason)))
