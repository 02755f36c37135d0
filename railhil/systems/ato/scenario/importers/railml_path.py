"""A way along tracks of a railML 3 file, and where on it a location of the file lies.

Sources: railML 3 wiki, RTM:linearLocation, RTM:associatedNetElement, RTM:spotLocation and IS:netElement (3.1 to 3.3).
A place on a net element is given by ``pos`` (m), by ``intrinsicCoord`` (0 to 1) or by the measure of a linear
positioning system, in this order of preference.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from xml.etree.ElementTree import Element

import numpy as np

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.systems.ato.scenario.importers.railml_document import Document, label

_METRES = {**dict.fromkeys(("m", "metre", "metres", "meter", "meters"), 1.0)}
_METRES |= dict.fromkeys(("km", "kilometre", "kilometres", "kilometer", "kilometers"), 1000.0)
#: Ends of neighbouring pieces of track may differ by this much.
JOINT_M = 0.01
#: A place may lie this far outside its net element, by the rounding of its position.
_OUTSIDE_MAX_M = 1.0
_TRUTHS = {"true": True, "1": True, "false": False, "0": False}
#: Whether a net relation may be run from A to B, and from B to A.
_NAVIGABLE = {"Both": (True, True), "AB": (True, False), "BA": (False, True), "None": (False, False)}

#: A net element, and the positions on it (m) from which and to which a train runs.
_Run = tuple[str, float, float]
#: A net element, and its end: 0, 1, or -1 for a place between them.
_End = tuple[str, int]


@dataclass(frozen=True, slots=True)
class NetElement:
    """A piece of track: its length, and measure -> position on it (m), for each linear positioning system."""

    length_m: float
    measures: dict[str, list[tuple[float, float]]]


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of a net element, in its own positions (m).

    :ivar sign: 1 if the location runs as the net element, else -1.
    :ivar directions: the directions (1, -1) of the net element in which the location applies.
    """

    element: str
    low_m: float
    high_m: float
    sign: int
    directions: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class PathPart:
    """A part of the way: from one position on a net element to another, beginning at ``start_m`` of the way."""

    element: str
    from_m: float
    to_m: float
    start_m: float

    @property
    def sign(self) -> int:
        """1 if a train runs as the net element, else -1."""
        return 1 if self.to_m >= self.from_m else -1

    @property
    def end_m(self) -> float:
        """Position on the way at which this part ends."""
        return self.start_m + abs(self.to_m - self.from_m)

    def position_m(self, at_m: float) -> float:
        """Position on the way of a position on the net element; outside the part it is that of its nearer end."""
        return min(max(self.start_m + (at_m - self.from_m) * self.sign, self.start_m), self.end_m)


class Network:
    """Net elements and their connections."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._file = document.file
        self._systems = document.by_id(document.root.iter("linearPositioningSystem"))
        elements = document.by_id(document.root.iterfind("infrastructure/topology/netElements/netElement"))
        if not elements:
            raise InputError(self._file, "infrastructure/topology/netElements", Words(), "net elements")
        #: Net elements that consist of others.
        self.groups = {
            name
            for name, item in elements.items()
            if item.find("elementCollectionOrdered") is not None or item.find("elementCollectionUnordered") is not None
        }
        self._elements = {name: self._net_element(item) for name, item in elements.items() if name not in self.groups}

    def _net_element(self, item: Element) -> NetElement:
        ends: dict[str, list[tuple[float, float]]] = {}
        for place in item.iterfind("associatedPositioningSystem/intrinsicCoordinate"):
            for coordinate in place.iterfind("linearCoordinate"):
                system, measure_m = self._measure(item, coordinate)
                share = self._document.number(place, "intrinsicCoord")
                if not 0 <= share <= 1:
                    raise InputError(self._file, f"{label(place)} intrinsicCoord", share, "from 0 to 1")
                ends.setdefault(system, []).append((measure_m, share))
        if item.get("length") is not None:
            length_m = self._document.number(item, "length")
        else:
            spans = [abs(rows[-1][0] - rows[0][0]) for rows in ends.values() if rows[0][1] == 0 and rows[-1][1] == 1]
            length_m = spans[0] if spans else math.nan
        measures = {system: sorted((m, share * length_m) for m, share in rows) for system, rows in ends.items()}
        return NetElement(length_m, {system: rows for system, rows in measures.items() if len(rows) > 1})

    def _measure(self, item: Element, coordinate: Element) -> tuple[str, float]:
        """Positioning system and measure in m."""
        system = coordinate.get("positioningSystemRef", "")
        if system not in self._systems:
            hint = did_you_mean(system, self._systems)
            where, found = f"{label(item)} positioningSystemRef", system or Words()
            raise InputError(self._file, where, found, "the id of a linear positioning system", hint)
        units = self._systems[system].get("units")
        if units is None or units.lower() not in _METRES:
            where, found = f"linearPositioningSystem {system} units", Words() if units is None else units
            raise InputError(self._file, where, found, "m or km")
        return system, self._document.number(coordinate, "measure", item) * _METRES[units.lower()]

    def element(self, item: Element, place: Element) -> tuple[str, NetElement] | None:
        """The net element on which an item has a location; None for a group of net elements."""
        name = place.get("netElementRef", "")
        if name in self.groups:
            return None
        if name not in self._elements:
            hint = did_you_mean(name, self._elements)
            raise InputError(self._file, f"{label(item)} netElementRef", name, "the id of a net element", hint)
        length_m = self._elements[name].length_m
        if not length_m > 0:
            found = Words() if math.isnan(length_m) else length_m
            raise InputError(self._file, f"netElement {name} length", found, "a length, or measures of both ends")
        return name, self._elements[name]

    def _offset_m(self, item: Element, place: Element, suffix: str, one: NetElement) -> float | None:
        """Position on a net element; None if the location does not say.

        :raises InputError: it lies outside, or is said in a way that is not read.
        """
        name = place.get("netElementRef")
        # A position in m, or a share of the length.
        for key, most, scale_m in ((f"pos{suffix}", one.length_m, 1.0), (f"intrinsicCoord{suffix}", 1.0, one.length_m)):
            if place.get(key) is not None:
                given = self._document.number(place, key, item)
                outside_max = _OUTSIDE_MAX_M / scale_m
                if not -outside_max <= given <= most + outside_max:
                    allowed = f"from 0 to {most:g} on {name}, which is {one.length_m:g} m long"
                    raise InputError(self._file, f"{label(item)} {key}", given, allowed)
                return min(max(given, 0.0), most) * scale_m
        for coordinate in place.iterfind(f"linearCoordinate{suffix}"):
            system, measure_m = self._measure(item, coordinate)
            if system in one.measures:
                known_m, at_m = self._measures(place, one, system)
                if not known_m[0] - _OUTSIDE_MAX_M <= measure_m <= known_m[-1] + _OUTSIDE_MAX_M:
                    allowed = f"from {known_m[0]:g} to {known_m[-1]:g} m, the measures of {name}"
                    raise InputError(self._file, f"{label(item)} measure", measure_m, allowed)
                return float(np.interp(measure_m, known_m, at_m))
        for unread in (f"linearCoordinate{suffix}", f"geometricCoordinate{suffix}"):
            if place.find(unread) is not None:
                found = Words(f"gives no place on {name}")
                raise InputError(self._file, f"{label(item)} {unread}", found, "pos, intrinsicCoord or a measure of it")
        return None

    def _measures(self, place: Element, one: NetElement, system: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Rising measures of a system on a net element, and their positions."""
        known_m, at_m = zip(*one.measures[system], strict=True)
        steps_m = np.diff(at_m)
        if not (np.diff(known_m) > 0).all() or not ((steps_m > 0).all() or (steps_m < 0).all()):
            where = f"netElement {place.get('netElementRef')} associatedPositioningSystem"
            raise InputError(self._file, where, Words(f"has measures of {system} out of order"), "one place for each")
        return known_m, at_m

    def stretches(self, item: Element) -> Iterator[Stretch]:
        """The parts of net elements that a linear location covers, in its order."""
        for location in item.iterfind("linearLocation"):
            parts = location.findall("associatedNetElement")
            if all(part.get("sequence") for part in parts):
                parts.sort(key=lambda part: self._document.number(part, "sequence", item))
            for part in parts:
                found = self.element(item, part)
                if found is None:
                    continue
                name, one = found
                keeps = self._document.choice(part, "keepsOrientation", _TRUTHS, absent=True, named=item)
                begin_m = self._offset_m(item, part, "Begin", one)
                end_m = self._offset_m(item, part, "End", one)
                begin_m = (0.0 if keeps else one.length_m) if begin_m is None else begin_m
                end_m = (one.length_m if keeps else 0.0) if end_m is None else end_m
                # Positions that fall say more than the flag: exporters set it to true beside them.
                sign = -1 if begin_m > end_m or not keeps else 1
                low_m, high_m = sorted((begin_m, end_m))
                yield Stretch(name, low_m, high_m, sign, self._directions(item, location, (sign,), sign))

    def spots(self, item: Element) -> Iterator[Stretch]:
        """The points at which an item stands (``low_m`` and ``high_m`` are equal)."""
        for place in item.iterfind("spotLocation"):
            found = self.element(item, place)
            if found is None:
                continue
            name, one = found
            at_m = self._offset_m(item, place, "", one)
            if at_m is None:
                raise InputError(self._file, f"{label(item)} spotLocation", Words(), "pos, intrinsicCoord or a measure")
            yield Stretch(name, at_m, at_m, 1, self._directions(item, place, (1, -1), 1))

    def _directions(self, item: Element, place: Element, absent: tuple[int, ...], sign: int) -> tuple[int, ...]:
        """Directions of the net element in which a location applies, which itself runs in direction ``sign``."""
        meanings = {"normal": (sign,), "reverse": (-sign,), "both": (1, -1)}
        return self._document.choice(place, "applicationDirection", meanings, absent=absent, named=item)

    def way(self, tracks: Sequence[Element], *, reverse: bool) -> tuple[PathPart, ...]:
        """The way along tracks in this order, the first one as it runs or against.

        A later one is run in its direction if both directions are connected.

        :raises InputError: a track has no length, or does not begin or end where the one before it ends.
        """
        runs = [self._runs(track) for track in tracks]
        joints = self._joints({element for own in runs for element, _, _ in own})
        whole: list[_Run] = []
        for track, own in zip(tracks, runs, strict=True):
            turned: list[_Run] = [(element, to_m, from_m) for element, from_m, to_m in reversed(own)]
            choices = [own, turned] if whole else [turned if reverse else own]
            fitting = [
                one
                for one in choices
                if all(self._is_joined(here, there, joints) for here, there in pairwise([*whole[-1:], *one]))
            ]
            if not fitting:
                allowed = "a track whose net elements are joined by net relations in the direction of running"
                if whole:
                    element, _, left_m = whole[-1]
                    allowed = f"a track that begins or ends where {element} is left, at {left_m:g} m"
                raise InputError(self._file, label(track), Words("is not connected"), allowed)
            whole += fitting[0]
        parts: list[PathPart] = []
        for element, from_m, to_m in whole:
            parts.append(PathPart(element, from_m, to_m, parts[-1].end_m if parts else 0.0))
        return tuple(parts)

    def _runs(self, track: Element) -> list[_Run]:
        """The net elements of a track in its direction."""
        stretches = list(self.stretches(track))
        where = f"{label(track)} linearLocation"
        if not stretches:
            raise InputError(self._file, where, Words(), "net elements")
        if any(one.high_m - one.low_m < JOINT_M for one in stretches):
            raise InputError(self._file, where, Words("has no length"), "a way to run on")
        return [
            (one.element, one.low_m, one.high_m) if one.sign > 0 else (one.element, one.high_m, one.low_m)
            for one in stretches
        ]

    def _joints(self, elements: set[str]) -> set[tuple[_End, _End]]:
        """The ends of these net elements that may be run over, each as (end that is left, end that is entered)."""
        joints: set[tuple[_End, _End]] = set()
        for relation in self._document.root.iterfind("infrastructure/topology/netRelations/netRelation"):
            names = [end.get("ref", "") for side in "AB" for end in relation.iterfind(f"element{side}")]
            if len(names) != 2 or not elements.issuperset(names):
                continue
            ends = [
                (name, self._document.choice(relation, f"positionOn{side}", {"0": 0, "1": 1}))
                for name, side in zip(names, "AB", strict=True)
            ]
            forwards, backwards = self._document.choice(relation, "navigability", _NAVIGABLE)
            if forwards:
                joints.add((ends[0], ends[1]))
            if backwards:
                joints.add((ends[1], ends[0]))
        return joints

    def _is_joined(self, here: _Run, there: _Run, joints: set[tuple[_End, _End]]) -> bool:
        """Whether a train that has run ``here`` goes on ``there`` without turning round."""
        if here[0] == there[0] and abs(here[2] - there[1]) < JOINT_M:
            return (here[1] < here[2]) == (there[1] < there[2])
        left, entered = self._end(here[0], here[2]), self._end(there[0], there[1])
        return (left, entered) in joints

    def _end(self, name: str, at_m: float) -> _End:
        if at_m < JOINT_M:
            return name, 0
        return name, 1 if at_m > self._elements[name].length_m - JOINT_M else -1
