"""From a case that violates a requirement to a smaller one that violates the same.

Passes, repeated until nothing changes (at most :data:`ROUNDS_MAX` rounds): drop faults, each alone and then in pairs;
make them shorter (bisection; counts like lengths); let them begin later; make their values milder; seed 0. A candidate
counts only if it violates the same requirement in a valid run. Every answer is cached by the candidate's text. Source
of the method: delta debugging (Zeller and Hildebrandt, IEEE TSE 28, 2002); the order of the passes is chosen.

Bisection assumes that more is worse. This is not always so, hence longer versions of the result are tried in the end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from types import MappingProxyType

from railhil.faults.language import fault_text, parse
from railhil.faults.model import COUNT, NAME, NUMBER, PPM, Fault, Parameter
from railhil.faults.words import word_of

ROUNDS_MAX = 3
#: Length of a fault that lasts to the end, where this is enough, in s.
_FIRST_LENGTH_S = 10.0
#: Grid of lengths and instants, in s.
_GRID_S = 0.01
#: Steps of a bisection, and of the coarse grid over the instants that comes before it.
_STEPS, _INSTANTS = 8, 8
#: A length found by bisection is known to this share.
_LENGTH_SHARE = 0.03
#: Shares of a value that are tried, from its neutral value.
_MILDER = (0.125, 0.5)
#: Values of less than this from the neutral one are not tried, in the base unit; of counts and ppm 1.
_LEAST_EFFECT = 0.01
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
        for one_pass in (_drop, _shorten, _delay, _soften, _simplify):
            one_pass(search)
    longer = tuple(_longer_that_pass(search))
    return Shrunk(search.faults, search.seed, len(search.answers) - 1, search.rounds, _saved_at_s(search), longer)


def _drop(search: _Search) -> None:
    """Leave out each fault alone, and then pairs of them."""
    place = 0
    while place < len(search.faults):
        if len(search.faults) < 2 or not search.takes(search.faults[:place] + search.faults[place + 1 :]):
            place += 1
    for pair in combinations(search.places(), 2):
        rest = tuple(text for place, text in enumerate(search.faults) if place not in pair)
        if rest and search.takes(rest):
            return


def _shorten(search: _Search) -> None:
    """The shortest length, or the smallest count, of each fault."""
    for place in search.places():
        fault = search.at(place)
        if fault.count is not None:
            _shorten_count(search, place, fault)
            continue
        word = word_of(fault.place.level, fault.place.name, fault.place.part, fault.what)
        if word is None or not word.lasts or fault.until:
            continue
        if fault.duration_s is None and not search.takes(
            search.with_fault(place, replace(fault, duration_s=_FIRST_LENGTH_S))
        ):
            continue
        _shorten_length(search, place)


def _shorten_count(search: _Search, place: int, fault: Fault) -> None:
    low, high = 0, fault.count or 0
    while high - low > 1:
        middle = max(low + 1, (low + high) // 2) if low else max(1, high // 4)
        if search.takes(search.with_fault(place, replace(fault, count=middle))):
            high = middle
        else:
            low = middle


def _shorten_length(search: _Search, place: int) -> None:
    fault = search.at(place)
    high_s, low_s = fault.duration_s or _FIRST_LENGTH_S, 0.0
    if search.rounds > 1:
        little_s = _on_grid(high_s - max(_GRID_S, _LENGTH_SHARE * high_s))
        if little_s >= high_s or not search.takes(search.with_fault(place, replace(fault, duration_s=little_s))):
            return
        high_s = little_s
    for _ in range(_STEPS):
        if high_s - low_s <= max(_GRID_S, _LENGTH_SHARE * high_s) + 1e-9:
            return
        # Lengths differ by their ratio: the first steps go down fast.
        middle_s = _on_grid(high_s / 4 if low_s == 0.0 else (low_s * high_s) ** 0.5)
        middle_s = min(max(middle_s, low_s + _GRID_S), high_s - _GRID_S)
        middle_s = _on_grid(middle_s)
        if search.takes(search.with_fault(place, replace(fault, duration_s=middle_s))):
            high_s = middle_s
        else:
            low_s = middle_s


def _on_grid(time_s: float) -> float:
    return max(_GRID_S, round(round(time_s / _GRID_S) * _GRID_S, 2))


def _delay(search: _Search) -> None:
    """The latest instant: of all faults together, then of each. A coarse grid comes before the bisection, because a
    later fault need not be milder."""
    _delay_some(search, list(search.places()))
    if len(search.faults) > 1:
        for place in search.places():
            _delay_some(search, [place])


def _delay_some(search: _Search, places: Sequence[int]) -> None:
    begins_s = {place: _begin_s(search.at(place)) for place in places}
    timed = {place: begin_s for place, begin_s in begins_s.items() if begin_s is not None}
    if not timed:
        return
    room_s = search.horizon_s - max(timed.values())
    before = search.faults

    def later(by_s: float) -> tuple[str, ...]:
        found = list(before)
        for place, begin_s in timed.items():
            fault = parse(before[place])
            trigger = replace(fault.trigger, value=round(begin_s + by_s, 2))
            found[place] = fault_text(replace(fault, trigger=trigger))
        return tuple(found)

    step_s = room_s / _INSTANTS
    if step_s < _GRID_S:
        return
    best = next((count for count in range(_INSTANTS, 0, -1) if search.takes(later(_on_grid(count * step_s)))), 0)
    low_s, high_s = best * step_s, (best + 1) * step_s
    if best == _INSTANTS:
        return
    for _ in range(_STEPS // 2):
        middle_s = _on_grid((low_s + high_s) / 2)
        if high_s - low_s <= 2 * _GRID_S:
            return
        if search.takes(later(middle_s)):
            low_s = middle_s
        else:
            high_s = middle_s


def _begin_s(fault: Fault) -> float | None:
    """Its instant; None: another condition begins it."""
    return float(fault.trigger.value) if fault.trigger.kind == "time" else None


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


def _simplify(search: _Search) -> None:
    """Seed 0; a single fault has nothing to be combined with."""
    if search.seed:
        search.takes(search.faults, 0)
    if len(search.faults) == 1 and search.at(0).combine:
        search.takes(search.with_fault(0, replace(search.at(0), combine=False)))


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
    begin_s, length_s = _begin_s(fault), fault.duration_s
    if begin_s is None or length_s is None:
        return None
    found = [
        other.duration_s
        for (faults, seed), violated in search.answers.items()
        if not violated and seed == search.seed and len(faults) == 1
        for other in [parse(faults[0])]
        if other.duration_s is not None and other.duration_s < length_s and replace(other, duration_s=length_s) == fault
    ]
    return round(begin_s + max(found), 2) if found else None
