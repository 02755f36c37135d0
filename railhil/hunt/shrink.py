"""From a case that violates a requirement to a smaller one that violates the same.

Passes, repeated until nothing changes (at most :data:`ROUNDS_MAX` rounds): drop faults, in groups, alone and in pairs;
simpler words and seed 0; make the faults shorter (counts like lengths); let them begin later; make their values
milder. A candidate counts only if it violates the same requirement in a valid run. Every answer is cached by the
candidate's text. Source of the method: delta debugging (Zeller and Hildebrandt, IEEE TSE 28, 2002); passes, their order
and their steps are chosen.

A pass tries large steps first, each as often as it succeeds, then smaller ones. Its candidates depend on the case at
hand alone. The last round has changed nothing, so making its result smaller again asks the same and changes nothing.
Large steps assume that more is worse. This is not always so, hence longer versions of the result are tried in the end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from types import MappingProxyType

from railhil.faults.language import fault_text, parse
from railhil.faults.model import COUNT, NAME, NUMBER, PPM, Fault, Parameter, Word
from railhil.faults.random_faults import words_drawn
from railhil.faults.words import word_of, words_at

ROUNDS_MAX = 10
#: Length of a fault that lasts to the end, where this is enough, in s.
_FIRST_LENGTH_S = 10.0
#: Grid of lengths and instants, in s.
_GRID_S = 0.01
#: Shares of a length or count that are tried; the last one is the accuracy of the result.
_SHORTER = (0.125, 0.5, 0.8, 0.95)
#: Steps to a later instant: the horizon halved so many times.
_STEPS = 6
#: Shares of a value that are tried, from its neutral value.
_MILDER = (0.125, 0.5)
#: Values of less than this from the neutral one are not tried, in the base unit; of counts and ppm 1.
_LEAST_EFFECT = 0.01
#: Simpler words of a place that are tried in the place of one.
_WORDS_MAX = 2
#: Longer versions that are tried in the end.
_LONGER = (1.3, 2.0, 3.0, 5.0)
_DIGITS = 3

#: (faults, seed of the run) -> whether the requirement is violated in a valid run.
Violates = Callable[[tuple[str, ...], int], bool]


@dataclass(frozen=True, slots=True)
class Shrunk:
    """The smallest case found. ``runs``: made for it; ``rounds``: of all passes. ``saved_at_s``: the latest end of the
    only fault, in s of simulation time, at which the requirement was seen kept; None: not known. ``longer_pass``:
    factors by which longer versions of a fault do not violate it: it is not monotone."""

    faults: tuple[str, ...]
    seed: int
    runs: int
    rounds: int
    saved_at_s: float | None = None
    longer_pass: tuple[float, ...] = ()


@dataclass
class _Search:
    """The case at hand, and what was tried."""

    faults: tuple[str, ...]
    seed: int
    violates: Violates
    horizon_s: float
    rounds: int = 0
    answers: dict[tuple[tuple[str, ...], int], bool] = field(default_factory=dict)

    def asks(self, faults: Sequence[str], seed: int | None = None) -> bool:
        """Whether a candidate violates the requirement."""
        key = (tuple(faults), self.seed if seed is None else seed)
        if key not in self.answers:
            self.answers[key] = self.violates(*key)
        return self.answers[key]

    def takes(self, faults: Sequence[str], seed: int | None = None) -> bool:
        """Whether a candidate violates the requirement; if so it is the case at hand."""
        if not self.asks(faults, seed):
            return False
        self.faults, self.seed = tuple(faults), self.seed if seed is None else seed
        return True

    def with_fault(self, place: int, fault: Fault) -> tuple[str, ...]:
        """The case at hand with another fault in a place."""
        return (*self.faults[:place], fault_text(fault), *self.faults[place + 1 :])

    def at(self, place: int) -> Fault:
        """A fault of the case at hand."""
        return parse(self.faults[place])

    def places(self) -> range:
        """The places of its faults."""
        return range(len(self.faults))


def shrink(faults: Sequence[str], seed: int, violates: Violates, horizon_s: float) -> Shrunk:
    """Make a case that violates a requirement smaller.

    :param faults: of the case; it violates the requirement.
    :param horizon_s: latest instant at which a fault may begin, in s.
    """
    search = _Search(tuple(faults), seed, violates, horizon_s)
    search.answers[search.faults, seed] = True
    before = None
    while search.rounds < ROUNDS_MAX and before != (search.faults, search.seed):
        before = (search.faults, search.seed)
        search.rounds += 1
        for one_pass in (_drop, _simplify, _shorten, _delay, _soften):
            one_pass(search)
    longer = tuple(_longer_that_pass(search))
    return Shrunk(search.faults, search.seed, len(search.answers) - 1, search.rounds, _saved_at_s(search), longer)


def _drop(search: _Search) -> None:
    """Leave out faults: neighbours, half of all and less, then each alone, and then pairs of them."""
    size = len(search.faults) // 2
    while size:
        place = 0
        while place < len(search.faults):
            rest = search.faults[:place] + search.faults[place + size :]
            if not rest or not search.takes(rest):
                place += size
        size //= 2
    for pair in combinations(search.places(), 2):
        rest = tuple(text for place, text in enumerate(search.faults) if place not in pair)
        if rest and search.takes(rest):
            return


def _simplify(search: _Search) -> None:
    """Seed 0; a word that comes before in the table of words and needs no value; a single fault has nothing to be
    combined with."""
    if search.seed:
        search.takes(search.faults, 0)
    if len(search.faults) == 1 and search.at(0).combine:
        search.takes(search.with_fault(0, replace(search.at(0), combine=False)))
    for place in search.places():
        fault = search.at(place)
        for word in _simpler_words(fault):
            values = MappingProxyType({one.name: one.usual for one in word.parameters if one.usual is not None})
            if search.takes(search.with_fault(place, replace(fault, what=word.name, values=values, after=""))):
                break


def _simpler_words(fault: Fault) -> Iterator[Word]:
    """The first words of the fault's place in the table, up to its own."""
    drawn = {(word.level, word.name, word.part) for word in words_drawn()}
    for word in words_at(fault.place.level, fault.place.name, fault.place.part)[:_WORDS_MAX]:
        if word.name == fault.what:
            return
        is_usual = all(one.usual is not None for one in word.parameters)
        has_length = word.lasts or (fault.duration_s is None and fault.count is None)
        if is_usual and has_length and (word.level, word.name, word.part) in drawn:
            yield word


def _shorten(search: _Search) -> None:
    """The shortest length, or the smallest count, of each fault."""
    for place in search.places():
        fault = search.at(place)
        word = word_of(fault.place.level, fault.place.name, fault.place.part, fault.what)
        if fault.count is not None:
            _shorten_count(search, place)
        elif word is not None and word.lasts and not fault.until:
            limited = replace(fault, duration_s=_FIRST_LENGTH_S)
            if fault.duration_s is not None or search.takes(search.with_fault(place, limited)):
                _shorten_length(search, place)


def _shorten_count(search: _Search, place: int) -> None:
    for share in _SHORTER:
        while (count := search.at(place).count or 1) > 1:
            less = max(1, min(round(count * share), count - 1))
            if not search.takes(search.with_fault(place, replace(search.at(place), count=less))):
                break


def _shorten_length(search: _Search, place: int) -> None:
    for share in _SHORTER:
        while (length_s := search.at(place).duration_s or _GRID_S) > _GRID_S:
            less_s = min(_on_grid(length_s * share), _on_grid(length_s - _GRID_S))
            if not search.takes(search.with_fault(place, replace(search.at(place), duration_s=less_s))):
                break


def _on_grid(time_s: float) -> float:
    return max(_GRID_S, round(round(time_s / _GRID_S) * _GRID_S, 2))


def _delay(search: _Search) -> None:
    """The latest instant: of all faults together, then of each."""
    _delay_some(search, search.places())
    if len(search.faults) > 1:
        for place in search.places():
            _delay_some(search, [place])


def _delay_some(search: _Search, places: Sequence[int]) -> None:
    for halvings in range(1, _STEPS + 1):
        step_s = _on_grid(search.horizon_s / 2**halvings)
        while (later := _later(search, places, step_s)) and search.takes(later):
            pass


def _later(search: _Search, places: Sequence[int], by_s: float) -> tuple[str, ...]:
    """The case at hand with some faults later, those that begin at a time; empty: one would be behind the horizon."""
    found = list(search.faults)
    timed = [place for place in places if search.at(place).trigger.kind == "time"]
    for place in timed:
        fault = search.at(place)
        begin_s = round(float(fault.trigger.value) + by_s, 2)
        if begin_s > search.horizon_s:
            return ()
        found[place] = fault_text(replace(fault, trigger=replace(fault.trigger, value=begin_s)))
    return tuple(found) if timed else ()


def _soften(search: _Search) -> None:
    """Values nearer to the neutral one of their parameter; usual ones, which no text has to name, stay."""
    for place in search.places():
        fault = search.at(place)
        word = word_of(fault.place.level, fault.place.name, fault.place.part, fault.what)
        for parameter in () if word is None else word.parameters:
            value = fault.values.get(parameter.name)
            if parameter.unit == NAME or parameter.name == "only" or not isinstance(value, int | float):
                continue
            while float(value) != parameter.usual:
                for milder in _milder_values(parameter, float(value)):
                    values = MappingProxyType({**fault.values, parameter.name: milder})
                    if search.takes(search.with_fault(place, replace(fault, values=values))):
                        fault, value = search.at(place), milder
                        break
                else:
                    break


def _milder_values(parameter: Parameter, value: float) -> Iterator[float]:
    """Values between the neutral one, which has no effect, and this one; the mildest first."""
    neutral = 1.0 if parameter.unit == NUMBER and parameter.name == "factor" else 0.0
    if parameter.name == "coefficient":
        # Of adhesion: the larger, the milder.
        neutral = parameter.high
    least = 1.0 if parameter.unit in (COUNT, PPM) else _LEAST_EFFECT
    for share in _MILDER:
        milder = neutral + (value - neutral) * share
        milder = float(round(milder)) if parameter.unit == COUNT else float(f"{milder:.{_DIGITS}g}")
        if parameter.low <= milder <= parameter.high and milder != value and abs(milder - neutral) >= least:
            yield milder


def _longer_that_pass(search: _Search) -> Iterator[float]:
    """Factors by which a longer version of a fault does not violate the requirement."""
    for factor in _LONGER:
        for place in search.places():
            fault = search.at(place)
            if fault.duration_s is None:
                continue
            longer = replace(fault, duration_s=_on_grid(fault.duration_s * factor))
            if not search.asks(search.with_fault(place, longer)):
                yield factor
                break


def _saved_at_s(search: _Search) -> float | None:
    """The latest end of the only fault at which the requirement was kept, of those that were tried."""
    if len(search.faults) != 1:
        return None
    fault = search.at(0)
    length_s = fault.duration_s
    if fault.trigger.kind != "time" or length_s is None:
        return None
    found = [
        other.duration_s
        for (faults, seed), violated in search.answers.items()
        if not violated and seed == search.seed and len(faults) == 1
        for other in [parse(faults[0])]
        if other.duration_s is not None and other.duration_s < length_s and replace(other, duration_s=length_s) == fault
    ]
    return round(float(fault.trigger.value) + max(found), 2) if found else None
