"""A way along tracks of a railML 3 file, and where on it a location of the file lies.

Sources: railML 3 wiki, RTM:linearLocation, RTM:associatedNetElement, RTM:spotLocation and IS:netElement (3.1 to 3.3).
A place on a net element is given by ``pos`` (m), by ``intrinsicCoord`` (0 to 1) or by the measure of a linear
positioning system, in this order of preference.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

import numpy as np

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.common.user_files import given_bytes, refuse_unreadable

_NAMESPACE = "https://www.railml.org/schemas/3."
_EXPECTED = "infrastructure in railML 3"
_METRES = {**dict.fromkeys(("m", "metre", "metres", "meter", "meters"), 1.0)}
_METRES |= dict.fromkeys(("km", "kilometre", "kilometres", "kilometer", "kilometers"), 1000.0)
#: Ends of neighbouring pieces of track may differ by this much.
JOINT_M = 0.01
#: A place may lie this far outside its net element, by the rounding of its position.
_OUTSIDE_MAX_M = 1.0
_TRUE = ("true", "1")


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


def read_railml(file: Path) -> Element:
    """The document, names of elements without their namespace.

    A document type (and so every entity of its own) is refused.

    :raises InputError: it is no XML, or not railML 3.
    """
    with refuse_unreadable(file, _EXPECTED):
        content = given_bytes(file)
    builder = TreeBuilder()
    parser = expat.ParserCreate(namespace_separator=" ")

    def refuse_type(name: str, *_: object) -> None:
        raise InputError(file, f"<!DOCTYPE {name}>", Words("has a document type"), f"{_EXPECTED} without one")

    parser.StartDoctypeDeclHandler = refuse_type
    parser.StartElementHandler = lambda name, attributes: builder.start(_local(name), attributes)
    parser.EndElementHandler = lambda name: builder.end(_local(name))
    try:
        parser.Parse(content, True)
    except (expat.ExpatError, LookupError) as error:
        # A LookupError is an encoding that Python does not know.
        raise InputError(file, "", Words("is no XML"), _EXPECTED, str(error)) from None
    root = builder.close()
    if root.tag != "railML":
        raise InputError(file, "", Words(f"begins with <{root.tag.rpartition(' ')[2]}>"), f"{_EXPECTED}: <railML>")
    return root


def _local(name: str) -> str:
    """Name of an element of railML 3 without its namespace, any other as it is."""
    return name.rpartition(" ")[2] if name.startswith(_NAMESPACE) else name


def label(item: Element) -> str:
    """How errors name an element."""
    return f"{item.tag} {item.get('id', '')}".rstrip()


class Network:
    """Net elements and their connections."""

    def __init__(self, file: Path, root: Element) -> None:
        self.file = file
        self._scale = {item.get("id", ""): item.get("units", "m") for item in root.iter("linearPositioningSystem")}
        elements = list(root.iterfind("infrastructure/topology/netElements/netElement"))
        if not elements:
            raise InputError(file, "infrastructure/topology/netElements", Words(), "net elements")
        #: Net elements that consist of others.
        self.groups = {
            item.get("id", "")
            for item in elements
            if item.find("elementCollectionOrdered") is not None or item.find("elementCollectionUnordered") is not None
        }
        self._elements = {
            item.get("id", ""): self._net_element(item) for item in elements if item.get("id", "") not in self.groups
        }
        self._joints: set[frozenset[tuple[str, int]]] = set()
        for relation in root.iterfind("infrastructure/topology/netRelations/netRelation"):
            ends = [
                (end.get("ref", ""), int(relation.get(place) == "1"))
                for tag, place in (("elementA", "positionOnA"), ("elementB", "positionOnB"))
                for end in relation.iterfind(tag)
            ]
            if relation.get("navigability") != "None":
                self._joints.add(frozenset(ends))

    def number(self, item: Element, key: str, named: Element | None = None) -> float:
        """A finite number of an attribute that is there. Raises :class:`InputError`."""
        text = item.get(key)
        where = f"{label(item if named is None else named)} {key}"
        if text is None:
            raise InputError(self.file, where, Words(), "a number")
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(self.file, where, text, "a number")
        return value

    def _net_element(self, item: Element) -> NetElement:
        ends: dict[str, list[tuple[float, float]]] = {}
        for place in item.iterfind("associatedPositioningSystem/intrinsicCoordinate"):
            for coordinate in place.iterfind("linearCoordinate"):
                system, measure_m = self._measure(item, coordinate)
                ends.setdefault(system, []).append((measure_m, self.number(place, "intrinsicCoord")))
        if item.get("length") is not None:
            length_m = self.number(item, "length")
        else:
            spans = [abs(rows[-1][0] - rows[0][0]) for rows in ends.values() if rows[0][1] == 0 and rows[-1][1] == 1]
            length_m = spans[0] if spans else math.nan
        measures = {system: sorted((m, share * length_m) for m, share in rows) for system, rows in ends.items()}
        return NetElement(length_m, {system: rows for system, rows in measures.items() if len(rows) > 1})

    def _measure(self, item: Element, coordinate: Element) -> tuple[str, float]:
        """Positioning system and measure in m."""
        system = coordinate.get("positioningSystemRef", "")
        units = self._scale.get(system, "m")
        if units.lower() not in _METRES:
            raise InputError(self.file, f"linearPositioningSystem {system} units", units, "m or km")
        return system, self.number(coordinate, "measure", item) * _METRES[units.lower()]

    def element(self, item: Element, place: Element) -> tuple[str, NetElement] | None:
        """The net element on which an item has a location; None for a group of net elements."""
        name = place.get("netElementRef", "")
        if name in self.groups:
            return None
        if name not in self._elements:
            hint = did_you_mean(name, self._elements)
            raise InputError(self.file, f"{label(item)} netElementRef", name, "the id of a net element", hint)
        if not self._elements[name].length_m > 0:
            raise InputError(self.file, f"netElement {name} length", Words(), "a length, or measures of both ends")
        return name, self._elements[name]

    def _offset_m(self, item: Element, place: Element, suffix: str, one: NetElement) -> float | None:
        """Position on a net element; None if the location does not say.

        :raises InputError: it lies outside.
        """
        at_m = self._given_m(item, place, suffix, one)
        if at_m is None:
            return None
        if not -_OUTSIDE_MAX_M <= at_m <= one.length_m + _OUTSIDE_MAX_M:
            allowed = f"from 0 to {one.length_m:g}, the length of {place.get('netElementRef')}"
            raise InputError(self.file, f"{label(item)} pos{suffix}", at_m, allowed)
        return min(max(at_m, 0.0), one.length_m)

    def _given_m(self, item: Element, place: Element, suffix: str, one: NetElement) -> float | None:
        if place.get(f"pos{suffix}") is not None:
            return self.number(place, f"pos{suffix}", item)
        if place.get(f"intrinsicCoord{suffix}") is not None:
            return self.number(place, f"intrinsicCoord{suffix}", item) * one.length_m
        for coordinate in place.iterfind(f"linearCoordinate{suffix}"):
            system, measure_m = self._measure(item, coordinate)
            if system in one.measures:
                known_m, at_m = zip(*one.measures[system], strict=True)
                return float(np.interp(measure_m, known_m, at_m))
        return None

    def stretches(self, item: Element) -> Iterator[Stretch]:
        """The parts of net elements that a linear location covers, in its order."""
        for location in item.iterfind("linearLocation"):
            parts = location.findall("associatedNetElement")
            if all(part.get("sequence") for part in parts):
                parts.sort(key=lambda part: self.number(part, "sequence", item))
            for part in parts:
                found = self.element(item, part)
                if found is None:
                    continue
                name, one = found
                keeps = part.get("keepsOrientation", "true") in _TRUE
                begin_m = self._offset_m(item, part, "Begin", one)
                end_m = self._offset_m(item, part, "End", one)
                begin_m = (0.0 if keeps else one.length_m) if begin_m is None else begin_m
                end_m = (one.length_m if keeps else 0.0) if end_m is None else end_m
                # Positions that fall say more than the flag: exporters set it to true beside them.
                sign = -1 if begin_m > end_m or not keeps else 1
                low_m, high_m = sorted((begin_m, end_m))
                yield Stretch(name, low_m, high_m, sign, _directions(location, (sign,), sign))

    def spots(self, item: Element) -> Iterator[Stretch]:
        """The points at which an item stands (``low_m`` and ``high_m`` are equal)."""
        for place in item.iterfind("spotLocation"):
            found = self.element(item, place)
            if found is None:
                continue
            name, one = found
            at_m = self._offset_m(item, place, "", one)
            if at_m is None:
                raise InputError(self.file, f"{label(item)} spotLocation", Words(), "pos, intrinsicCoord or a measure")
            yield Stretch(name, at_m, at_m, 1, _directions(place, (1, -1), 1))

    def way(self, tracks: Sequence[Element], *, reverse: bool) -> tuple[PathPart, ...]:
        """The way along tracks in this order, the first one as it runs or against.

        :raises InputError: a track does not begin or end where the one before it ends.
        """
        parts: list[PathPart] = []
        for track in tracks:
            own = [(one.element, *self._ends(one)) for one in self.stretches(track)]
            if not own:
                raise InputError(self.file, f"{label(track)} linearLocation", Words(), "net elements")
            turned = [(element, to_m, from_m) for element, from_m, to_m in reversed(own)]
            if not parts:
                chosen = turned if reverse else own
            else:
                last = parts[-1]
                fitting = [one for one in (own, turned) if self._joined((last.element, last.to_m), one[0][:2])]
                if not fitting:
                    allowed = f"a track that begins or ends where {last.element} is left, at {last.to_m:g} m"
                    raise InputError(self.file, label(track), Words("is not connected"), allowed)
                chosen = fitting[0]
            for element, from_m, to_m in chosen:
                parts.append(PathPart(element, from_m, to_m, parts[-1].end_m if parts else 0.0))
        return tuple(parts)

    @staticmethod
    def _ends(one: Stretch) -> tuple[float, float]:
        return (one.low_m, one.high_m) if one.sign > 0 else (one.high_m, one.low_m)

    def _joined(self, here: tuple[str, float], there: tuple[str, float]) -> bool:
        if here[0] == there[0] and abs(here[1] - there[1]) < JOINT_M:
            return True
        return frozenset((self._end(*here), self._end(*there))) in self._joints

    def _end(self, name: str, at_m: float) -> tuple[str, int]:
        """The end of a net element at a position on it; a place that is none is end -1."""
        if at_m < JOINT_M:
            return name, 0
        return name, 1 if at_m > self._elements[name].length_m - JOINT_M else -1


def _directions(place: Element, absent: tuple[int, ...], sign: int) -> tuple[int, ...]:
    """Directions of the net element in which a location applies, which itself runs in direction ``sign``."""
    given = {"normal": (sign,), "reverse": (-sign,), "both": (1, -1)}
    return given.get(place.get("applicationDirection", ""), absent)
