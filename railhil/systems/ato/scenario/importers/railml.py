"""Lines from infrastructure of railML 3 (3.1 to 3.3): tracks, grades, speed limits, balises and stopping places.

A speed limit is the lowest of all speed sections that apply in the direction of running, whatever their speed profile.
A vertical curve (``deltaGradient``, or no ``gradient``) has the grades of its neighbours up to its middle. Sources:
railML 3 wiki, IS:gradientCurve, IS:speedSection, IS:balise, IS:stoppingPlace.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from xml.etree.ElementTree import Element

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.scenarios.profiles import Profile, merge_profiles
from railhil.systems.ato.scenario.importers.railml_document import Document, label, read_railml
from railhil.systems.ato.scenario.importers.railml_path import JOINT_M, Network, PathPart, Stretch
from railhil.systems.ato.scenario.importers.section import Stop, StopLine, list_unused
from railhil.systems.ato.scenario.model import Balise, Line

_FUNCTIONAL = "infrastructure/functionalInfrastructure"
_GEOMETRY = "infrastructure/geometry"
_LINEAR = "linearLocation/associatedNetElement"
_SPOT = "spotLocation"
#: Containers that are read: what is read of them, and by what it has its place.
_USED = {
    "tracks": ("track", _LINEAR),
    "speeds": ("speedSection", _LINEAR),
    "gradientCurves": ("gradientCurve", _LINEAR),
    "balises": ("balise", _SPOT),
    "baliseGroups": ("baliseGroup", _SPOT),
    "stoppingPlaces": ("stoppingPlace", _SPOT),
    "operationalPoints": ("operationalPoint", _SPOT),
}
#: Balises are numbered downwards from here: the balises of stops are numbered upwards from 1 (``section.py``).
_BALISES_NUMBERED = 255

#: A value between two positions of the way (m).
_Piece = tuple[float, float, float]


def load_line(
    file: str | Path,
    *,
    track_ids: Sequence[str] = (),
    reverse: bool = False,
    default_limit_mps: float | None = None,
) -> StopLine:
    """The way along tracks as a line; positions in m from its beginning.

    Stops are ``start``, ``end``, and the stopping places and operational points that stand on its tracks.

    :param track_ids: the tracks in the order of running; none for the only track of a file.
    :param reverse: run along the first track against its direction; the others follow from their connections.
    :param default_limit_mps: limit where the file has no speed section.
    :raises InputError: the file is wrong, tracks are unknown or not connected, or a limit is missing.
    """
    document = read_railml(Path(file))
    network = Network(document)
    tracks = _choose_tracks(document, track_ids)
    way = network.way(tracks, reverse=reverse)
    grades, level = _grades(document, network, way)
    limits, unlimited = _limits(document, network, way, default_limit_mps)
    stops, numbered = _stops(document, network, way)
    remarks = list(list_unused(_unused(document, network)))
    if level:
        remarks.append(f"level where its file has no gradient: {_list_stretches(level)}")
    if unlimited and default_limit_mps is not None:
        limit = f"limit of {default_limit_mps * 3.6:g} km/h where its file has no speed section"
        remarks.append(f"{limit}: {_list_stretches(unlimited)}")
    turned = _turned(document, network, way)
    if turned:
        remarks.append(f"direction counted along the place, which runs against its net element: {', '.join(turned)}")
    if numbered:
        remarks.append(f"numbered because their names stand twice: {', '.join(numbered)}")
    line = Line(", ".join(track.get("id", "") for track in tracks), grades, limits, _balises(document, network, way))
    return StopLine(line, stops, tuple(remarks))


def _unused(document: Document, network: Network) -> list[str]:
    """What the file has but is not read: whole kinds, and of the kinds that are read what has no place on the way."""
    unused: set[str] = set()
    grouped: list[str] = []
    unplaced: list[str] = []
    short: list[str] = []
    for part in (item for above in (_FUNCTIONAL, _GEOMETRY) for item in document.root.iterfind(f"{above}/*")):
        if part.tag not in _USED:
            unused.add(part.tag)
            continue
        tag, place = _USED[part.tag]
        unused.update(f"{item.tag} of {part.tag}" for item in part if item.tag != tag)
        for item in part.iterfind(tag):
            name = item.get("id") or tag
            elements = {one.get("netElementRef", "") for one in item.iterfind(place)}
            if not elements.isdisjoint(network.groups):
                grouped.append(name)
            if not elements or any(one.find("associatedNetElement") is None for one in item.iterfind("linearLocation")):
                unplaced.append(name)
            if any(one.high_m - one.low_m < JOINT_M for one in network.stretches(item)):
                short.append(name)
    lost = {
        "places on groups of net elements": grouped,
        "what has no location of its kind": unplaced,
        "places without length": short,
    }
    return sorted(unused) + [f"{why} ({', '.join(names)})" for why, names in lost.items() if names]


def _choose_tracks(document: Document, wanted: Sequence[str]) -> list[Element]:
    by_id = document.by_id(document.root.iterfind(f"{_FUNCTIONAL}/tracks/track"))
    if not by_id:
        raise InputError(document.file, f"{_FUNCTIONAL}/tracks", Words(), "tracks")
    allowed = f"some of {', '.join(by_id)}"
    if not wanted:
        if len(by_id) > 1:
            raise InputError(document.file, "line.track_ids", Words("no choice among several"), allowed)
        return list(by_id.values())
    for name in wanted:
        if name not in by_id:
            raise InputError(document.file, "line.track_ids", name, allowed, did_you_mean(name, by_id))
    return [by_id[name] for name in wanted]


def _name(item: Element) -> str:
    names = (*(one.get("name") for one in item.iterfind("name")), item.get("id"))
    return next((" ".join(name.split()) for name in names if name and name.strip()), item.tag)


def _on_way(way: Sequence[PathPart], stretch: Stretch) -> Iterator[tuple[PathPart, float, float]]:
    """Where a stretch lies on the way: part, begin and end (m)."""
    for part in way:
        low_m, high_m = sorted((part.from_m, part.to_m))
        if part.element == stretch.element and stretch.low_m <= high_m and stretch.high_m >= low_m:
            begin_m, end_m = sorted((part.position_m(stretch.low_m), part.position_m(stretch.high_m)))
            yield part, begin_m, end_m


def _limits(
    document: Document, network: Network, way: Sequence[PathPart], default_mps: float | None
) -> tuple[Profile, list[tuple[float, float]]]:
    """Limits, and the stretches without any, where the default limit holds."""
    pieces: list[_Piece] = []
    for item in document.root.iterfind(f"{_FUNCTIONAL}/speeds/speedSection"):
        limit_kmh = document.number(item, "maxSpeed")
        if limit_kmh <= 0:
            raise InputError(document.file, f"{label(item)} maxSpeed", item.get("maxSpeed"), "a speed above 0")
        for stretch in network.stretches(item):
            for part, begin_m, end_m in _on_way(way, stretch):
                if part.sign in stretch.directions and end_m > begin_m:
                    pieces.append((begin_m, end_m, limit_kmh / 3.6))
    rows: list[tuple[float, float]] = []
    open_m: list[tuple[float, float]] = []
    for begin_m, end_m in _between(way, pieces):
        values = [value for low_m, high_m, value in pieces if low_m <= begin_m and high_m >= end_m]
        if values:
            rows.append((begin_m, min(values)))
        else:
            open_m.append((begin_m, end_m))
            rows.append((begin_m, math.nan if default_mps is None else default_mps))
    if open_m and default_mps is None:
        found = Words(f"the file has no speed section for {_list_stretches(open_m)}")
        raise InputError(document.file, "line.default_limit_kmh", found, "the limit that holds there")
    return merge_profiles(tuple(rows)), open_m


def _turned(document: Document, network: Network, way: Sequence[PathPart]) -> list[str]:
    """Grades and speed sections with a direction on the way whose places run against their net elements.

    Another reader may count them by the net element, and find another sign or the limit of the other direction.
    """
    sections = [
        item
        for item in document.root.iterfind(f"{_FUNCTIONAL}/speeds/speedSection")
        if any(one.get("applicationDirection") in ("normal", "reverse") for one in item.iterfind("linearLocation"))
    ]
    return [
        item.get("id") or item.tag
        for item in (*document.root.iterfind(f"{_GEOMETRY}/gradientCurves/gradientCurve"), *sections)
        if any(one.sign < 0 and any(_on_way(way, one)) for one in network.stretches(item))
    ]


def _grades(document: Document, network: Network, way: Sequence[PathPart]) -> tuple[Profile, list[tuple[float, float]]]:
    """Grades, and the stretches without any, which are taken as level."""
    pieces: list[_Piece] = []
    curved: list[tuple[float, float]] = []
    for item in document.root.iterfind(f"{_GEOMETRY}/gradientCurves/gradientCurve"):
        is_constant = item.get("gradient") is not None or item.get("curveType") != "arc"
        if item.get("deltaGradient") is not None and document.number(item, "deltaGradient") != 0:
            is_constant = False
        permil = document.number(item, "gradient") if is_constant else 0.0
        for stretch in network.stretches(item):
            for part, begin_m, end_m in _on_way(way, stretch):
                if end_m - begin_m < JOINT_M:
                    continue
                # A rise in the direction of the location is a fall for a train that runs against it.
                own = permil if stretch.sign == part.sign else 0.0 - permil
                for low_m, high_m, other in pieces:
                    if is_constant and other != own and min(high_m, end_m) - max(low_m, begin_m) > JOINT_M:
                        found = Words(f"is {own:g} permil where another curve is {other:g}")
                        raise InputError(document.file, f"{label(item)} gradient", found, "one gradient at each place")
                if is_constant:
                    pieces.append((begin_m, end_m, own))
                else:
                    curved.append((begin_m, end_m))
    rows: list[tuple[float, float]] = []
    level: list[tuple[float, float]] = []
    for begin_m, end_m in _between(way, pieces):
        values = [value for low_m, high_m, value in pieces if low_m <= begin_m and high_m >= end_m]
        if values:
            rows.append((begin_m, values[0]))
        elif rows and any(low_m < end_m and high_m > begin_m for low_m, high_m in curved):
            after = [value for low_m, _, value in pieces if low_m == end_m]
            rows.append(((begin_m + end_m) / 2, after[0] if after else rows[-1][1]))
        else:
            rows.append((begin_m, 0.0))
            level.append((begin_m, end_m))
    return merge_profiles(tuple(rows)), level


def _between(way: Sequence[PathPart], pieces: Sequence[_Piece]) -> Iterator[tuple[float, float]]:
    """The stretches of the way between all ends of pieces."""
    edges = sorted({0.0, way[-1].end_m, *(edge for begin_m, end_m, _ in pieces for edge in (begin_m, end_m))})
    for begin_m, end_m in pairwise(edges):
        if end_m - begin_m > JOINT_M:
            yield begin_m, end_m


def _list_stretches(stretches: Sequence[tuple[float, float]]) -> str:
    return ", ".join(f"{begin_m:g} to {end_m:g} m" for begin_m, end_m in stretches)


def _standing(network: Network, way: Sequence[PathPart], items: Sequence[Element]) -> list[tuple[float, Element]]:
    """Position on the way of what stands there and applies to the train, in running order."""
    found = [
        (begin_m, item)
        for item in items
        for spot in network.spots(item)
        for part, begin_m, _ in _on_way(way, spot)
        if part.sign in spot.directions
    ]
    return sorted(found, key=lambda one: one[0])


def _balises(document: Document, network: Network, way: Sequence[PathPart]) -> tuple[Balise, ...]:
    """The balises; of a file without balises on the way the groups of balises."""
    for kind in ("balises/balise", "baliseGroups/baliseGroup"):
        items = document.root.findall(f"{_FUNCTIONAL}/{kind}")
        places = dict.fromkeys(at_m for at_m, _ in _standing(network, way, items))
        if places:
            return tuple(
                Balise(_BALISES_NUMBERED - number % _BALISES_NUMBERED, at_m, at_m) for number, at_m in enumerate(places)
            )
    return ()


def _stops(document: Document, network: Network, way: Sequence[PathPart]) -> tuple[tuple[Stop, ...], list[str]]:
    """The stops in running order, and the names that got a number because another stop has them."""
    start, end = Stop("start", 0.0), Stop("end", way[-1].end_m)
    stops = {start.name: start, end.name: end}
    numbered: list[str] = []
    for kind in ("stoppingPlaces/stoppingPlace", "operationalPoints/operationalPoint"):
        for at_m, item in _standing(network, way, document.root.findall(f"{_FUNCTIONAL}/{kind}")):
            name = _name(item)
            number = 1
            while name in stops and abs(stops[name].position_m - at_m) >= JOINT_M:
                number += 1
                name = f"{_name(item)} {number}"
            if name not in stops:
                stops[name] = Stop(name, at_m)
                numbered += [name] if number > 1 else []
    # The end comes after all that stands at its place.
    return tuple(sorted(stops.values(), key=lambda one: (one.position_m, one is end))), numbered
