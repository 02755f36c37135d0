"""What became of the faults of a run, and when its watches reacted."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from railhil.faults.model import WATCH_LEVELS
from railhil.judge.events.event import LEVEL, RecordedEvent


@dataclass(frozen=True, slots=True)
class Injected:
    """One fault of a run. Times are simulation time in s; None: it did not.

    ``text``: in the fault language, with all values drawn. ``begun_s``: it became active; ``effect_s``: it first
    changed something; ``ended_s``. ``hits``: how many telegrams, samples or processes it has changed.
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


def _flat(level: str) -> str:
    return level.replace(" ", "_").casefold()


def watch_times_s(events: Sequence[RecordedEvent], level: str) -> list[tuple[float, float]]:
    """Begin and end of each time in which a watch was at a level or above it, in s.

    :raises ValueError: no watch has this level.
    """
    reactions = [event for event in events if event.kind == LEVEL]
    ranks = {_flat(name): rank for rank, name in enumerate(WATCH_LEVELS)} | {
        _flat(one.level): one.rank for one in reactions
    }
    if _flat(level) not in ranks:
        raise ValueError(f"no level {level!r} of the watches, allowed {', '.join(WATCH_LEVELS[1:])}")
    wanted = ranks[_flat(level)]
    return [(one.time_s, one.until_s or one.time_s) for one in reactions if one.rank >= wanted]


class Reaction:
    """When the watches were at a level or above it.

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
        """When a watch first came to the level; infinite if none did."""
        return min((begun_s for begun_s, _ in self.times_s), default=math.inf)

    def after_s(self, fault: str | int | Injected) -> float:
        """Time from the first effect of a fault until a watch came to the level; infinite if none did, so that no bound
        is met; 0 if one was there already.

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
