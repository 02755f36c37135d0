"""The names of a scenario's values: columns of ``signals.csv``, signals of the port table, scores, levels, events."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property, partial
from typing import Any, TypeAlias

import numpy as np

from railhil.bus.schedule import Schedule
from railhil.dbc import Contract, Signal
from railhil.faults.model import WATCH_LEVELS
from railhil.judge.criteria import STOP_ERROR_KEY
from railhil.judge.declared import Watch, ranks, reports
from railhil.judge.judging import Judging, judging_of
from railhil.judge.requirements.grid import Grid, event_names
from railhil.judge.requirements.units import NUMBER, STEPS, Unit, unit_of
from railhil.record.notes import ReportedNote, note_values
from railhil.record.trace import FloatArray, Trace

Values: TypeAlias = Callable[[Grid], FloatArray]
#: Resolution of places (m) and instants (s) in RUN_EVENT.
_STAMP_STEP = 1e-4
_TIME_ERROR_KEY = "time_error_s"
#: Scores that each stop has for itself, with their attributes there.
_OF_STOPS = {STOP_ERROR_KEY: "error_m", _TIME_ERROR_KEY: "late_s"}
#: A value table with fewer words names exceptions of a number.
_WORDS_MIN = 2


@dataclass(frozen=True, slots=True, eq=False)
class Quantity:
    """A value of a sentence.

    ``values``: from a grid, shape (ticks,), in ``unit``. ``step``: resolution on the wire, in ``unit``; 0: none.
    ``periods_ns``: of the periodic ports that it comes from. ``words``: of a level, by word its value; ``ordered``: the
    levels are those of a ladder. ``constant``: the value that never changes.
    """

    unit: Unit
    values: Values
    step: float = 0.0
    periods_ns: Mapping[str, int] = field(default_factory=dict)
    words: Mapping[str, int] = field(default_factory=dict)
    ordered: bool = False
    constant: Fraction | None = None


def suffix_of(unit: str) -> str:
    """The end of a column's name that tells its unit, such as ``_mps2``; empty for a number."""
    found = unit.lower().replace("km/h", "kmh").replace("/s", "ps").replace("/", "_per_").replace("%", "percent")
    return f"_{found}" if found and found not in ("1", STEPS.text) else ""


class Names:
    """The names that sentences on runs of a scenario may use.

    :param trace: of the record; one without telegrams before the run.
    :param notes: the law's declaration of its notes, as in the certificate; None: not known.
    """

    def __init__(self, scenario: Any, trace: Trace, notes: Any = None) -> None:
        self.scenario = scenario
        self.contract: Contract = trace.contract
        self.judging: Judging = judging_of(scenario)
        self._trace, self._notes = trace, notes
        timing = scenario.timing
        self.tick_ns: int = timing.base_tick_ns
        self._schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, self.contract)

    def __contains__(self, name: str) -> bool:
        """Whether a value, score, level or event has this name."""
        return any(name in known for known in (self.values, self.scores, self.levels, self.events))

    @cached_property
    def values(self) -> Mapping[str, Quantity]:
        """The columns of ``signals.csv`` by name, with the end that tells the unit and without it."""
        found: dict[str, Quantity] = {}
        for name, quantity in self._columns():
            for known in (name, name.removesuffix(suffix_of(quantity.unit.text))):
                found.setdefault(known, quantity)
        return found

    def _columns(self) -> Iterator[tuple[str, Quantity]]:
        judging, trace = self.judging, self._trace
        for header, port, signal in (*judging.columns, *judging.shown):
            if self.contract.has(port, signal):
                yield header, self.signal(port, signal)
        for watch in judging.watches:
            if reports(trace, watch):
                yield f"{watch.name}_level", self._level(watch)
        for status in judging.status.every if judging.status else ():
            for note in status.recorded(trace, self._notes):
                yield note.name, self._note(status.port, note)
        for header, port, _ in judging.told(trace, self._notes):
            yield header, self._made(header, NUMBER, port, lambda grid: judging.told(grid.trace, self._notes))
        for columns in (judging.reckoned, judging.quantities):
            for header, unit, _ in columns(self.scenario, trace):
                made = partial(_titled, columns, self.scenario)
                yield header, self._made(header, unit_of(unit), judging.truth, made)
        if (end_m := judging.ends_at_m(self.scenario)) is not None:
            yield "board", constant(Fraction(repr(end_m)), unit_of("m"))

    def _note(self, port: str, note: ReportedNote) -> Quantity:
        def values(grid: Grid) -> FloatArray:
            return grid.held(port, note_values(grid.trace, note, port))

        return Quantity(unit_of(note.unit), values, note.scale, self.periods_ns(port))

    def _made(self, header: str, unit: Unit, port: str, columns: Callable[[Grid], Iterable[Any]]) -> Quantity:
        """A column that the system computes from the telegrams of a port."""

        def values(grid: Grid) -> FloatArray:
            return grid.held(port, next(found for name, _, found in columns(grid) if name == header))

        return Quantity(unit, values, periods_ns=self.periods_ns(port))

    def periods_ns(self, port: str) -> dict[str, int]:
        """The period of a port that sends on it; none for one that sends when something happens."""
        if self.contract.port(port).mode == "event" or port not in self._schedule.periods_ns:
            return {}
        return {port: self._schedule.ticks(port) * self.tick_ns}

    def signal(self, port: str, name: str) -> Quantity:
        """A signal of the port table.

        :raises KeyError: there is no such port or signal.
        """
        entry: Signal = self.contract.port(port).signal(name)
        words = {word: raw for raw, word in entry.values.items()} if not entry.unit else {}
        if len(words) < _WORDS_MIN:
            words = {}

        def values(grid: Grid) -> FloatArray:
            return grid.signal(port, name)

        unit = STEPS if words else unit_of(entry.unit)
        return Quantity(unit, values, entry.scale, self.periods_ns(port), words)

    def _level(self, watch: Watch) -> Quantity:
        words: dict[str, int] = {}
        named = self.contract.port(watch.port).signal(watch.level).values
        for rank, raw in enumerate(watch.ladder):
            strength = watch.rungs[rank] if watch.rungs else rank
            words.setdefault(named.get(raw, str(raw)), rank)
            if strength < len(WATCH_LEVELS):
                words.setdefault(WATCH_LEVELS[strength].lower().replace(" ", "_"), rank)

        def values(grid: Grid) -> FloatArray:
            found = grid.kept.get(watch.name)
            if found is None:
                found = grid.kept[watch.name] = grid.held(watch.port, ranks(grid.trace, watch))
            return found

        return Quantity(STEPS, values, 1.0, self.periods_ns(watch.port), words, ordered=True)

    @cached_property
    def levels(self) -> Mapping[str, list[Quantity]]:
        """Words of the levels, each with the watches whose ladders have it."""
        found: dict[str, list[Quantity]] = {}
        for watch in self.judging.watches:
            if reports(self._trace, watch):
                level = self._level(watch)
                for word in level.words:
                    found.setdefault(word, []).append(level)
        return found

    @cached_property
    def events(self) -> frozenset[str]:
        """Milestones and faults."""
        return frozenset(event_names(self.scenario))

    @cached_property
    def scores(self) -> Mapping[str, Quantity]:
        """The scores, which a record has at the event to which they belong."""
        given = {one.signed or one.key: one.unit for one in self.judging.criteria if one.applies(self.scenario)}
        if STOP_ERROR_KEY in given:
            # Each stop of a timetable has its own, whether or not it is a criterion of the run.
            given.setdefault(_TIME_ERROR_KEY, "s")
        return {
            key.removesuffix(suffix_of(unit)): Quantity(
                unit_of(unit), self.score_values(key), _STAMP_STEP if unit in ("m", "s") else 0.0
            )
            for key, unit in given.items()
        }

    def score_values(self, key: str) -> Values:
        """The values of a score on a grid."""
        return _score_values(key)


def _titled(columns: Callable[[Any, Trace], Sequence[Any]], scenario: Any, grid: Grid) -> Iterable[Any]:
    """Columns of a system as header, unit and values."""
    return columns(scenario, grid.trace)


def _score_values(key: str) -> Values:
    def values(grid: Grid) -> FloatArray:
        """At the tick of each stop its own value, and that of the run at the last stop and the last tick; the score of
        a run without stops at every tick."""
        score = grid.record.score
        of_run = score.signed[key] if key in score.signed else score.values.get(key)
        whole = np.nan if of_run is None else of_run
        if not score.stops:
            return np.full(grid.count, whole)
        own, found = _OF_STOPS.get(key), np.full(grid.count, np.nan)
        found[-1] = whole
        for stop in score.stops:
            value = getattr(stop, own) if own else whole if stop is score.stops[-1] else None
            if stop.standstill is not None and value is not None:
                found[min(grid.tick_at(stop.standstill.instant_s), grid.count - 1)] = value
        return found

    return values


def constant(value: Fraction, unit: Unit) -> Quantity:
    """A value that never changes."""
    return Quantity(unit, lambda grid: np.full(grid.count, float(value)), constant=value)
