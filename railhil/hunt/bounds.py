"""What a hunt may draw: faults of some places and words, at most so many, so long and so large.

They come from ``[hunt]`` of the scenario and from ``--what``. Their names are those of the fault language: a level
(``sensor``, also ``sensors``), a place (``adhesion``, ``TRN_SPEED``), a place with its word (``speed stuck``).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, did_you_mean
from railhil.faults.language import fault_text, parse
from railhil.faults.model import LEVELS, Fault, Place, Trigger, Word
from railhil.faults.notation import place_text
from railhil.faults.random_faults import Ports, names_of, words_drawn
from railhil.faults.words import PLACES, WORDS, word_of
from railhil.scenarios.layers import Layers
from railhil.scenarios.load import find
from railhil.scenarios.schema import HuntTable

#: Names of ``--what``: faults of every level, and the draws of ``[perturbations]``.
FAULTS, DRAWS = "faults", "draws"


@dataclass(frozen=True, slots=True)
class Bounds:
    """Bounds of the cases. ``what``, ``left_out``: names; ``faults_max``: of a case; ``longest_s``: of a fault, in s;
    None: those of random faults, also to the end of the run; ``largest``: values of faults by place and word."""

    what: tuple[str, ...] = (FAULTS,)
    left_out: tuple[str, ...] = ()
    faults_max: int = HuntTable().faults_max
    longest_s: float | None = None
    largest: tuple[Fault, ...] = ()

    def as_json(self) -> dict[str, Any]:
        """As in the identity of a hunt."""
        largest = [fault_text(one) for one in self.largest]
        return {**asdict(replace(self, largest=())), "largest": largest}

    def has(self, place: Place, word: str) -> bool:
        """Whether a word at a place is drawn."""
        names = set(_names(place, word))
        return bool(names & {*self.what}) and not names & {*self.left_out}

    def words(self) -> tuple[Word, ...]:
        """The words that are drawn, with those of their places that have them."""
        return tuple(narrow for word in words_drawn() for narrow in self._narrowed(word))

    def _narrowed(self, word: Word) -> Iterator[Word]:
        if word.level == "telegram":
            # Its places are the ports.
            yield word
            return
        names = names_of(word)
        kept = [name for name in names if self.has(Place(word.level, name), word.name)]
        if kept:
            yield word if kept == names else replace(word, names=tuple(kept))

    def ports(self, ports: Ports) -> Ports:
        """The ports on which faults of telegrams are drawn."""
        words = [word.name for word in words_drawn() if word.level == "telegram"]
        return {
            name: signals
            for name, signals in ports.items()
            if any(self.has(Place("telegram", name), word) for word in words)
        }

    def allows(self, text: str) -> bool:
        """Whether a fault of :meth:`words` and :meth:`ports` keeps to the bounds."""
        fault = parse(text)
        word = word_of(fault.place.level, fault.place.name, fault.place.part, fault.what)
        if word is None or not self.has(fault.place, fault.what):
            return False
        if self.longest_s is not None and word.lasts and fault.count is None:
            length_s = fault.duration_s
            if length_s is None or length_s > self.longest_s:
                return False
        return not any(_is_larger(fault, one) for one in self.largest)


def _names(place: Place, word: str) -> Iterator[str]:
    """The names of a word at a place, and of all that it belongs to."""
    text = place_text(replace(place, part=""))
    yield from (FAULTS, place.level, f"{place.level}s", text, f"{text} {word}")


def _is_larger(fault: Fault, other: Fault) -> bool:
    """Whether a value of a fault is larger, without its sign, than that of the same word at the same place."""
    if fault.what != other.what or replace(fault.place, part="") != replace(other.place, part=""):
        return False
    pairs = [(fault.values[name], bound) for name, bound in other.values.items()]
    return any(
        abs(value) > abs(bound)
        for value, bound in pairs
        if isinstance(value, int | float) and isinstance(bound, int | float)
    )


def _check(names: Sequence[str], ports: Ports, source: str | Path, key: str, more: tuple[str, ...] = ()) -> None:
    """Refuse a name that no fault has. Raises InputError."""
    places = {
        place_text(Place(level, name)): [word.name for word in WORDS if word.level == level]
        for level in LEVELS
        for name in (ports if level == "telegram" else PLACES[level])
    }
    levels = [name for level in LEVELS for name in (level, f"{level}s")]
    known = {*more, FAULTS, *levels, *places}
    for name in names:
        place, _, word = name.partition(" ")
        if name not in known and word not in places.get(place, ()):
            allowed = f"{', '.join((*more, FAULTS))}, a level ({', '.join(LEVELS)}), a place, or a place and its word"
            raise InputError(source, key, name, allowed, did_you_mean(name, known))


def read_bounds(scenario: str, settings: Sequence[str], what: Sequence[str], ports: Ports) -> Bounds:
    """The bounds of a scenario that has been checked, and of ``--what``.

    :param ports: of its system, on which faults may act.
    :raises InputError: a name or a fault that there is not, or nothing is left to be drawn.
    """
    layers = Layers(find(scenario), settings)
    table = HuntTable.model_validate(layers.merge().get("hunt", {}))
    _check(what, ports, "command line", "--what", (DRAWS,))
    _check(table.left_out, ports, layers.origin("hunt", "left_out"), "hunt.left_out")
    file = layers.origin("hunt", "largest")
    largest = tuple(parse(text, file, Trigger("manual")) for text in table.largest)
    wanted = tuple(dict.fromkeys(what)) or (FAULTS,)
    found = Bounds(wanted, tuple(table.left_out), table.faults_max, table.longest_s, largest)
    if wanted != (DRAWS,) and not any(word.level != "telegram" for word in found.words()) and not found.ports(ports):
        raise InputError("command line", "--what", ", ".join(wanted), "names of which [hunt] leaves some fault")
    return found
