"""The result of one run of a test: lost, refused or reordered frames, its faults, the reactions of its watches."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from railhil.common.digits import rounded
from railhil.faults.model import WATCH_LEVELS
from railhil.judge.events.event import LEVEL, LOST, REFUSED, RecordedEvent
from railhil.judge.stops import ScoredStop
from railhil.library import Outcome, Signals
from railhil.scenarios.run_spec import RunSpec


@dataclass(frozen=True, slots=True)
class Injected:
    """One fault of a run. Times are simulation time in s; None: it did not happen.

    ``text``: in the fault language, with all values drawn. ``begun_s``: it became active; ``effect_s``: it first
    changed something; ``ended_s``. ``hits``: number of telegrams, samples or processes that it has changed.
    """

    text: str
    begun_s: float | None
    effect_s: float | None
    ended_s: float | None
    hits: int

    @property
    def fired(self) -> bool:
        """True if it began and changed something."""
        return self.hits > 0


def injected(folder: Path) -> tuple[Injected, ...]:
    """The faults of a run, from ``score.json`` of its folder."""
    rows = json.loads((folder / "score.json").read_text(encoding="utf-8"))["faults"]
    return tuple(Injected(row["fault"], row["begun_s"], row["effect_s"], row["ended_s"], row["hits"]) for row in rows)


def fold_word(level: str) -> str:
    """The form in which words of the bench and of a test are compared."""
    return level.replace(" ", "_").casefold()


def watch_times_s(events: Sequence[RecordedEvent], level: str) -> list[tuple[float, float]]:
    """Begin and end of each time in which a watch was at a level or above it, in s.

    :raises ValueError: no watch has this level.
    """
    reactions = [event for event in events if event.kind == LEVEL]
    ranks = {fold_word(name): rank for rank, name in enumerate(WATCH_LEVELS)} | {
        fold_word(one.level): one.rank for one in reactions
    }
    if fold_word(level) not in ranks:
        raise ValueError(f"no level {level!r} of the watches, allowed {', '.join(WATCH_LEVELS[1:])}")
    wanted = ranks[fold_word(level)]
    return [(one.time_s, one.until_s or one.time_s) for one in reactions if one.rank >= wanted]


class Reaction:
    """Times in which the watches were at a level or above it.

    :param times_s: begin and end of each time.
    :param effect_s: fault -> simulation time of its first effect.
    """

    def __init__(self, level: str, times_s: Sequence[tuple[float, float]], effect_s: Callable[..., float]) -> None:
        self.level = level
        self.times_s = tuple(times_s)
        self._effect_s = effect_s

    @property
    def happened(self) -> bool:
        """True if a watch came to the level."""
        return bool(self.times_s)

    @property
    def time_s(self) -> float:
        """Time at which a watch first came to the level; infinite if none did."""
        return min((begun_s for begun_s, _ in self.times_s), default=math.inf)

    def after_s(self, fault: str | int | Injected) -> float:
        """Time from the first effect of a fault until a watch came to the level. It is infinite if none did, so that no
        bound is met, and 0 if a watch was there already.

        :param fault: its text as given to the run, its place in ``run.faults``, or one of these.
        :raises AssertionError: the fault has changed nothing.
        :raises ValueError: it is not a fault of the run.
        """
        effect_s = self._effect_s(fault)
        return min(
            (max(begun_s - effect_s, 0.0) for begun_s, end_s in self.times_s if end_s > effect_s), default=math.inf
        )

    def __repr__(self) -> str:
        return f"<{self.level}: {f'first at {self.time_s:.2f} s' if self.happened else 'never'}>"


#: Counters of a node that do not indicate a fault.
_HEALTHY = ("sent", "received", "accepted", "polls", "unknown_id", "no_mailbox", "send_retries")


def disturbed(counters: Mapping[str, int]) -> dict[str, int]:
    """The counters that must be 0 on a healthy bus but are not."""
    return {cause: count for cause, count in counters.items() if count and cause not in _HEALTHY}


def disturbed_events(events: Iterable[RecordedEvent]) -> dict[str, int]:
    """Telegrams that the record shows as lost or refused, by event, port and cause; empty for a healthy bus.

    The counters of the nodes show neither a telegram that was changed before all nodes nor one that another node of the
    bus should have taken.
    """
    found: Counter[str] = Counter()
    for event in events:
        if event.kind in (LOST, REFUSED):
            found[f"{event.kind} {event.source} ({event.cause})"] += event.count
    return dict(found)


def disturbed_run(folder: Path) -> dict[str, int]:
    """Counters of lost, refused or reordered frames of a run, from ``score.json`` of its folder.

    In real time a poll may be missed because the machine is busy; the verdict on the timing covers that.
    """
    run = json.loads((folder / "score.json").read_text(encoding="utf-8"))["run"]
    counters = dict(run["counters"])
    if run["pace"] == "lockstep" and run["timing"] is not None:
        counters["missed_polls"] = run["timing"]["missed_polls"]
    return disturbed(counters)


class Score:
    """Scores of a run as attributes: with their sign if they have one, NaN where the run has none.

    No comparison with NaN is true, so that a limit is not met by a train that has not stopped.
    """

    def __init__(self, scores: Mapping[str, float | None], signed: Mapping[str, float | None]) -> None:
        self._values = {**scores, **signed}

    def __getattr__(self, name: str) -> float:
        values = self.__dict__.get("_values", {})
        if name not in values:
            raise AttributeError(f"no score {name!r}: this run has {', '.join(sorted(values))}")
        value = values[name]
        return math.nan if value is None else value

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._values})

    def __repr__(self) -> str:
        return f"Score({rounded(self._values)})"


class Run:
    """One recorded run: verdict, scores, events, evidence. ``outcome``: the same as of :func:`railhil.run`."""

    def __init__(self, outcome: Outcome) -> None:
        self.outcome = outcome

    @property
    def passed(self) -> bool:
        """True for the verdict PASS."""
        return self.outcome.passed

    @property
    def verdict(self) -> str:
        """PASS, FAIL or INVALID."""
        return self.outcome.verdict

    @property
    def reasons(self) -> tuple[str, ...]:
        """One sentence per limit missed, or why the run is INVALID."""
        return self.outcome.reasons

    @property
    def score(self) -> Score:
        """Scores as attributes, ``run.score.stop_error_m``."""
        return Score(self.outcome.scores, self.outcome.signed)

    @property
    def scores(self) -> Mapping[str, float | None]:
        """Scores by name, without sign; None where the run has none."""
        return self.outcome.scores

    @property
    def stops(self) -> tuple[ScoredStop, ...]:
        """The planned stops with what the run made of each: ``planned.name``, ``error_m``, ``late_s``, ``verdict``."""
        return self.outcome.stops

    @property
    def events(self) -> tuple[RecordedEvent, ...]:
        """The events of the run, in order."""
        return self.outcome.events

    @cached_property
    def faults(self) -> tuple[Injected, ...]:
        """The faults of the run and their effects: first the scenario's faults, then the test's."""
        return injected(self.folder)

    def reaction(self, level: str) -> Reaction:
        """Times in which the watches were at a level, or above it.

        :param level: ``HOLD``, ``TRACTION CUT``, ``SERVICE BRAKE``, ``EMERGENCY``, or a word of the system's watches.
        :raises ValueError: no watch has this level.
        """
        return Reaction(level, watch_times_s(self.events, level), self._effect_s)

    def _effect_s(self, fault: str | int | Injected) -> float:
        """First effect of a fault, named by its text as given to the run, by its place in :attr:`faults`, or itself."""
        if isinstance(fault, str):
            texts = self.spec.faults
            if fault not in texts:
                raise ValueError(f"no fault {fault!r} in this run, which has {', '.join(map(repr, texts)) or 'none'}")
            fault = len(self.faults) - len(texts) + texts.index(fault)
        found = self.faults[fault] if isinstance(fault, int) else fault
        if found.effect_s is None:
            raise AssertionError(
                f"fault {found.text!r} {'changed nothing' if found.begun_s is not None else 'never began'}"
            )
        return found.effect_s

    @property
    def signals(self) -> Signals:
        """Columns of ``signals.csv``."""
        return self.outcome.signals

    @property
    def spec(self) -> RunSpec:
        """The description of the run; ``railhil.run(run.spec)`` repeats it."""
        return self.outcome.spec

    @property
    def folder(self) -> Path:
        """The run folder."""
        return self.outcome.folder

    @property
    def certificate(self) -> Mapping[str, Any]:
        """Content of ``certificate.json``."""
        return self.outcome.certificate

    @property
    def frames_sha256(self) -> str:
        """SHA-256 of ``frames.log``."""
        return self.outcome.frames_sha256

    @property
    def disturbed(self) -> dict[str, int]:
        """Frames lost, refused or out of order, by cause; empty on a healthy bus.

        They come from the counters of the nodes, and in lockstep also from the events of the record: in real time a
        frame may be late because the machine is busy.
        """
        shown = {} if self.spec.is_realtime else disturbed_events(self.events)
        return {**disturbed_run(self.folder), **shown}

    def __repr__(self) -> str:
        reasons = "".join(f", {reason}" for reason in self.reasons)
        return f"<run of {self.outcome.scenario.name}: {self.verdict}{reasons}; {self.folder}>"
