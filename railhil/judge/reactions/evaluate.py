"""The reaction of a run with a fault of the catalogue, compared with the required one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from railhil.common.digits import text_beside_limit
from railhil.common.exit_codes import FAIL, INVALID, PASS, TOOL_ERROR
from railhil.faults.model import WATCH_LEVELS
from railhil.judge.events.event import LEVEL, MISSED_POLL, REFUSED, RecordedEvent
from railhil.judge.reactions.catalogue import Entry
from railhil.judge.reactions.shown import find_states, first_s

if TYPE_CHECKING:
    from railhil.judge.declared import Watch
    from railhil.judge.requirements.outcome import Outcome
    from railhil.judge.result import Result
    from railhil.record.trace import FloatArray

VERDICTS = {PASS: "PASS", FAIL: "FAIL", INVALID: "INVALID", TOOL_ERROR: "TOOL ERROR"}
#: Beginning of the sentence for a broken rule of every run (:mod:`railhil.systems.ato.judge.invariants`).
RULE = "invariant"
#: Decimals of a delay in ms; the bench counts in µs.
_DIGITS = 6
#: Time at NORMAL before the end of the record after which a watch counts as resumed.
RESUMED_S = 1.0


@dataclass(frozen=True, slots=True)
class Seen:
    """The facts of one run.

    ``begun_s``: the first fault became active; ``effective_s``: it first changed something; None: never. ``events``:
    those of the run. ``stands_s``: since when the train stands at the end of the record, ``end_s``; None: it moves.
    ``ended``: the milestone that ended the run. ``verdict``: PASS, FAIL, INVALID or TOOL ERROR; ``line``: its reason;
    ``broken``: failures of its score. ``states``: the instants of the states that the entry names
    (:mod:`railhil.judge.reactions.shown`).
    """

    begun_s: float | None
    effective_s: float | None
    events: Sequence[RecordedEvent]
    stands_s: float | None
    end_s: float
    ended: str
    verdict: str
    line: str = ""
    broken: Sequence[str] = ()
    states: Mapping[str, Sequence[float]] = field(default_factory=dict)


def _first_s(times_s: Iterable[float | None]) -> float | None:
    return min((time_s for time_s in times_s if time_s is not None), default=None)


def seen_in(result: Result, entry: Entry) -> Seen:
    """The effects of a run that was made for an entry."""
    trace, truth = result.trace, result.scenario.installed_system.truth
    end_s = trace.times_s(result.judging.truth)
    speed_mps = trace.values(truth.port, truth.speed) if truth and trace.has(truth.port, truth.speed) else end_s[:0]
    return Seen(
        begun_s=_first_s(one.begun_s for one in result.faults),
        effective_s=_first_s(one.effect_s for one in result.faults),
        events=[_as_reaction(event, result.judging.watches) for event in result.events],
        stands_s=_stands_s(end_s, speed_mps),
        end_s=float(end_s[-1]) if len(end_s) else 0.0,
        ended=result.score.ended,
        verdict=VERDICTS.get(result.exit_code, f"exit code {result.exit_code}"),
        line=result.line,
        broken=result.score.failures,
        states=find_states(trace, entry.signs),
    )


def _stands_s(times_s: FloatArray, speed_mps: FloatArray) -> float | None:
    """Since when a train stands at the end of its record, s; None: it moves there, or nothing is known."""
    if not len(speed_mps) or speed_mps[-1] != 0.0:
        return None
    moves = np.flatnonzero(speed_mps)
    return float(times_s[moves[-1] + 1 if len(moves) else 0])


def _as_reaction(event: RecordedEvent, watches: Sequence[Watch]) -> RecordedEvent:
    """The event with the strength of its level as its rank."""
    rungs = next((watch.rungs for watch in watches if watch.name == event.source and event.kind == LEVEL), ())
    return replace(event, rank=rungs[event.rank]) if rungs else event


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table of reactions. Times in s of simulation; None: did not happen.

    ``detected_by``: cause or refusal that showed first, ``detected_s`` when; ``reaction``: strongest level after the
    first effect, ``reaction_s``: when the level that the entry demands was first reached, or the strongest one if it
    demands none; ``safe_s``: since when the state that the entry demands at the end holds (the train
    stands, or no watch is above NORMAL); None: the entry demands none, or it never left it. ``failures``: deviations of
    the run from the entry, empty if there are none. ``refused``: reason for which the entry cannot be run on this
    transport. ``shown_s``: when it first showed each sign that the entry demands. ``requirements``: verdicts by id of
    the sentences that the run has decided (:func:`decided`).
    """

    entry: Entry
    begun_s: float | None = None
    effective_s: float | None = None
    detected_by: str = ""
    detected_s: float | None = None
    reaction: str = "NORMAL"
    reaction_s: float | None = None
    verdict: str = ""
    failures: list[str] = field(default_factory=list)
    refused: str = ""
    shown_s: dict[str, float | None] = field(default_factory=dict)
    safe_s: float | None = None
    requirements: Mapping[str, str] = field(default_factory=dict)

    @property
    def made(self) -> bool:
        """Whether there was a run."""
        return bool(self.verdict)

    def as_json(self) -> dict[str, Any]:
        """All fields, with the delays in ms, and the demands of the entry as ``demanded``."""
        found = asdict(self) | {"entry": self.entry.id, "faults": list(self.entry.faults)}
        found["demanded"] = self.entry.model_dump(mode="json", exclude_defaults=True)
        return found | {"after_ms": self.after_ms, "margin_ms": self.margin_ms, "within_ms": self.entry.within_ms}

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Row:
        """The row of :meth:`as_json`, read by :func:`railhil.record.documents.read_fault_table`.

        :raises ValueError: its demands are not those of an entry.
        """
        own = {one.name: document[one.name] for one in fields(cls) if one.name in document}
        return cls(**{**own, "entry": Entry.model_validate(document["demanded"])})

    @property
    def tightest(self) -> tuple[float, int] | None:
        """Delay and bound, in ms, of the sign with the smallest margin; None: the entry demands none, or one is
        missing."""
        if self.effective_s is None or None in self.shown_s.values():
            return None
        bounds_ms = self.entry.shows
        delays = (
            ((at_s - self.effective_s) * 1e3, bounds_ms[sign])
            for sign, at_s in self.shown_s.items()
            if at_s is not None
        )
        return min(delays, key=lambda one: one[1] - one[0], default=None)

    @property
    def after_ms(self) -> float | None:
        """From the first effect to the reaction, in ms."""
        if self.reaction_s is None or self.effective_s is None:
            return None
        return (self.reaction_s - self.effective_s) * 1e3

    @property
    def margin_ms(self) -> float | None:
        """Margin to the bound, in ms; None without a bound or a reaction."""
        after_ms = self.after_ms
        return None if after_ms is None or self.entry.within_ms is None else self.entry.within_ms - after_ms

    @property
    def said_reaction(self) -> str:
        """The level for the time beside it, with the strongest level if that is another."""
        wanted = self.entry.reaction
        if wanted is None or self.reaction_s is None or wanted == self.reaction:
            return self.reaction
        return f"{wanted} (up to {self.reaction})"

    @property
    def bound(self) -> tuple[float | None, int | None]:
        """Delay and bound of the reaction in ms, or those of the sign with the smallest margin; None: not known."""
        after_ms, within_ms = self.after_ms, self.entry.within_ms
        if within_ms is None and self.tightest is not None:
            after_ms, within_ms = self.tightest
        # A difference of two times: 70 ms are no 70.000000000003.
        return None if after_ms is None else round(after_ms, _DIGITS), within_ms


def _cause(event: RecordedEvent) -> str:
    if event.kind == LEVEL:
        return event.cause
    return f"refused:{event.cause}" if event.kind == REFUSED else "missed_polls" if event.kind == MISSED_POLL else ""


def _first(levels: Sequence[RecordedEvent], level: str) -> RecordedEvent | None:
    """The first event at a level or above."""
    wanted = WATCH_LEVELS.index(level)
    return next((event for event in levels if event.rank >= wanted), None)


def decided(outcomes: Iterable[Outcome]) -> dict[str, str]:
    """Verdicts by id of the sentences that a fault has put to the test: those that demand a reaction and whose
    antecedent came, and all that the run violates."""
    demands = (one for one in outcomes if one.violated or (one.kept and "whenever" in one.says.split()))
    return {one.id: one.verdict for one in demands}


def evaluated(entry: Entry, seen: Seen) -> Row:
    """The row of an entry for the run that was made for it."""
    failures = [text for text in seen.broken if text.startswith(RULE)]
    if entry.verdict and seen.verdict != entry.verdict:
        why = f" ({seen.line})" if seen.line else ""
        failures.append(f"verdict {seen.verdict}{why}, expected {entry.verdict}")
    if not entry.verdict and seen.verdict not in ("PASS", "FAIL"):
        failures.append(f"verdict {seen.verdict}: {seen.line}")
    if not entry.is_judged:
        if seen.verdict == entry.verdict and entry.said not in seen.line:
            failures.append(f"{seen.line}: nothing of {entry.said!r}")
        return Row(entry, seen.begun_s, seen.effective_s, verdict=seen.verdict, failures=failures)
    if seen.begun_s is None:
        return Row(entry, refused="its trigger does not occur in this run")
    if seen.effective_s is None and entry.idle:
        return Row(entry, seen.begun_s, refused=entry.idle)
    if seen.effective_s is None:
        return Row(entry, seen.begun_s, verdict=seen.verdict, failures=[*failures, "the fault changed nothing"])
    after = [event for event in seen.events if (event.until_s or event.time_s) >= seen.effective_s]
    levels = [event for event in after if event.kind == LEVEL and event.time_s >= seen.effective_s]
    strongest = max(levels, key=lambda event: event.rank, default=None)
    # The catalogue refuses an entry without them.
    assert entry.reaction is not None
    assert entry.at_most is not None
    reached = _first(levels, entry.reaction)
    if reached is None and entry.reaction != "NORMAL":
        failures.append(f"reached {WATCH_LEVELS[strongest.rank] if strongest else 'NORMAL'}, expected {entry.reaction}")
    for level, within_ms in entry.steps.items():
        step = _first(levels, level)
        after_ms = None if step is None else (step.time_s - seen.effective_s) * 1e3
        if after_ms is not None and after_ms > within_ms + 1e-6:
            failures.append(f"{level} after {after_ms:.0f} ms, allowed {within_ms} ms")
    shown = reached if entry.reaction != "NORMAL" else strongest
    if strongest is not None and strongest.rank > WATCH_LEVELS.index(entry.at_most):
        failures.append(f"reached {WATCH_LEVELS[strongest.rank]} at {strongest.time_s:.2f} s, allowed {entry.at_most}")
    shown_s = {sign: first_s(sign, seen.events, seen.states, seen.effective_s) for sign in entry.shows}
    failures += _unshown(entry, shown_s, seen)
    causes = [(max(event.time_s, seen.effective_s), _cause(event)) for event in after]
    # An undetected fault may still cause a reaction, at an allowed level.
    of_entry = [(at_s, cause) for at_s, cause in causes if cause and (entry.is_undetected or cause in entry.detected)]
    signs = [(first_s(sign, seen.events, seen.states, seen.effective_s), sign) for sign in entry.detected]
    of_entry += [(at_s, sign) for at_s, sign in signs if at_s is not None]
    detected_s, detected_by = min(of_entry, default=(None, ""))
    if detected_s is None and not entry.is_undetected:
        failures.append(f"not detected by {' or '.join(entry.detected)}")
    row = Row(
        entry,
        seen.begun_s,
        seen.effective_s,
        detected_by,
        detected_s,
        WATCH_LEVELS[strongest.rank] if strongest is not None else "NORMAL",
        shown.time_s if shown is not None else None,
        seen.verdict,
        failures,
        shown_s=shown_s,
        safe_s=_safe_s(entry, seen, levels),
    )
    margin_ms = row.margin_ms
    if margin_ms is not None and entry.within_ms is not None and margin_ms < -1e-6:
        took = text_beside_limit(entry.within_ms - margin_ms, entry.within_ms, 0)
        failures.append(f"{entry.reaction} after {took} ms, allowed {entry.within_ms} ms")
    failures += _ending(entry, seen, levels)
    return row


def _unshown(entry: Entry, shown_s: Mapping[str, float | None], seen: Seen) -> Iterator[str]:
    """Signs that the run lacks, shows too late, or must not show."""
    from_s = seen.effective_s
    assert from_s is not None
    for sign, within_ms in entry.shows.items():
        at_s = shown_s[sign]
        if at_s is None:
            yield f"does not show {sign}"
        elif (at_s - from_s) * 1e3 > within_ms + 1e-6:
            yield f"{sign} after {(at_s - from_s) * 1e3:.0f} ms, allowed {within_ms} ms"
    for sign, for_ms in entry.never.items():
        at_s = first_s(sign, seen.events, seen.states, from_s)
        if at_s is not None and (at_s - from_s) * 1e3 <= for_ms:
            yield f"shows {sign} at {at_s:.2f} s"


def _safe_s(entry: Entry, seen: Seen, levels: Sequence[RecordedEvent]) -> float | None:
    """See :attr:`Row.safe_s`."""
    if entry.ends != "resumes":
        return seen.stands_s if entry.ends else None
    return max((event.until_s or event.time_s for event in levels if event.rank), default=None)


def _ending(entry: Entry, seen: Seen, levels: Sequence[RecordedEvent]) -> list[str]:
    """Deviation of the end of the run from the expected one."""
    if entry.ends == "resumes":
        late = [event for event in levels if (event.until_s or event.time_s) > seen.end_s - RESUMED_S]
        if late:
            return [f"{late[-1].source} at {WATCH_LEVELS[late[-1].rank]} until the end"]
        return [] if seen.ended == "ended_complete" else [f"run {seen.ended}, expected to go on and stop"]
    if entry.ends and seen.stands_s is None:
        return ["the train does not stand at the end"]
    if entry.ends == "lost" and seen.ended != "ended_controller_lost":
        # A train that has stopped by itself ends the run complete; the verdict names the lost controller.
        return [] if "controller" in seen.line else [f"run {seen.ended}: {seen.line}, expected the controller lost"]
    return []
