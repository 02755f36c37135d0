"""Lines from infrastructure of railML 3 (3.1 to 3.3): tracks, grades, speed limits, balises and stopping places.

A speed limit is the lowest of all speed sections that apply in the direction of running, whatever their speed profile.
A vertical curve (``deltaGradient``, or no ``gradient``) has the grades of its neighbours up to its middle. Sources:
railML 3 wiki, IS:gradientCurve, IS:speedSection, IS:balise, IS:stoppingPlace.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from xml.etree.ElementTree import Element

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.scenarios.profiles import Profile, merge_profiles
from railhil.systems.ato.scenario.importers.railml_path import (
    JOINT_M,
    Network,
    PathPart,
    Stretch,
    label,
    read_railml,
)
from railhil.systems.ato.scenario.importers.section import Stop, StopLine, list_unused
from railhil.systems.ato.scenario.model import Balise, Line

_FUNCTIONAL = "infrastructure/functionalInfrastructure"
_GEOMETRY = "infrastructure/geometry"
#: Containers that are read.
_USED = ("tracks", "speeds", "balises", "baliseGroups", "stoppingPlaces", "operationalPoints", "gradientCurves")
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
    path = Path(file)
    root = read_railml(path)
    network = Network(path, root)
    tracks = _choose_tracks(path, root.findall(f"{_FUNCTIONAL}/tracks/track"), track_ids)
    way = network.way(tracks, reverse=reverse)
    if way[-1].end_m < JOINT_M:
        raise InputError(path, f"{label(tracks[0])} linearLocation", Words("has no length"), "a way to run on")
    grades, level = _grades(network, way, root)
    limits = _limits(network, way, root, default_limit_mps)
    parts = [item for above in (_FUNCTIONAL, _GEOMETRY) for item in root.iterfind(f"{above}/*")]
    unused = sorted({item.tag for item in parts}.difference(_USED))
    grouped = [
        item.get("id", "")
        for part in parts
        if part.tag in ("speeds", "gradientCurves")
        for item in part
        if any(place.get("netElementRef") in network.groups for place in item.iter("associatedNetElement"))
    ]
    if grouped:
        unused.append(f"places on groups of net elements ({', '.join(grouped)})")
    remarks = list_unused(unused)
    if level:
        remarks += (f"level where its file has no gradient: {_list_stretches(level)}",)
    line = Line(", ".join(track.get("id", "") for track in tracks), grades, limits, _balises(network, way, root))
    return StopLine(line, _stops(network, way, root), remarks)


def _choose_tracks(file: Path, tracks: Sequence[Element], wanted: Sequence[str]) -> list[Element]:
    by_id = {track.get("id", ""): track for track in tracks}
    if not by_id:
        raise InputError(file, f"{_FUNCTIONAL}/tracks", Words(), "tracks")
    if not wanted:
        if len(by_id) > 1:
            raise InputError(file, "line.track_ids", Words("no choice among several"), f"some of {', '.join(by_id)}")
        return list(by_id.values())
    for name in wanted:
        if name not in by_id:
            raise InputError(file, "line.track_ids", name, f"some of {', '.join(by_id)}", did_you_mean(name, by_id))
    return [by_id[name] for name in wanted]


def _name(item: Element) -> str:
    names = [name for one in item.iterfind("name") if (name := one.get("name"))]
    return names[0] if names else item.get("id", "")


def _on_way(way: Sequence[PathPart], stretch: Stretch) -> Iterator[tuple[PathPart, float, float]]:
    """Where a stretch lies on the way: part, begin and end (m)."""
    for part in way:
        low_m, high_m = sorted((part.from_m, part.to_m))
        if part.element == stretch.element and stretch.low_m <= high_m and stretch.high_m >= low_m:
            begin_m, end_m = sorted((part.position_m(stretch.low_m), part.position_m(stretch.high_m)))
            yield part, begin_m, end_m


def _limits(network: Network, way: Sequence[PathPart], root: Element, default_mps: float | None) -> Profile:
    pieces: list[_Piece] = []
    for item in root.iterfind(f"{_FUNCTIONAL}/speeds/speedSection"):
        limit_kmh = network.number(item, "maxSpeed")
        if limit_kmh <= 0:
            raise InputError(network.file, f"{label(item)} maxSpeed", item.get("maxSpeed"), "a speed above 0")
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
        elif default_mps is not None:
            rows.append((begin_m, default_mps))
        else:
            open_m.append((begin_m, end_m))
    if open_m:
        found = Words(f"the file has no speed section for {_list_stretches(open_m)}")
        raise InputError(network.file, "line.default_limit_kmh", found, "the limit that holds there")
    return merge_profiles(tuple(rows))


def _grades(network: Network, way: Sequence[PathPart], root: Element) -> tuple[Profile, list[tuple[float, float]]]:
    """Grades, and the stretches without any, which are taken as level."""
    pieces: list[_Piece] = []
    curved: list[tuple[float, float]] = []
    for item in root.iterfind(f"{_GEOMETRY}/gradientCurves/gradientCurve"):
        is_constant = item.get("gradient") is not None
        if item.get("deltaGradient") is not None and network.number(item, "deltaGradient") != 0:
            is_constant = False
        permil = network.number(item, "gradient") if is_constant else 0.0
        for stretch in network.stretches(item):
            for part, begin_m, end_m in _on_way(way, stretch):
                if end_m - begin_m < JOINT_M:
                    continue
                # A rise in the direction of the location is a fall for a train that runs against it.
                own = permil if stretch.sign == part.sign else 0.0 - permil
                for low_m, high_m, other in pieces:
                    if is_constant and other != own and min(high_m, end_m) - max(low_m, begin_m) > JOINT_M:
                        found = Words(f"is {own:g} permil where another curve is {other:g}")
                        raise InputError(network.file, f"{label(item)} gradient", found, "one gradient at each place")
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


def _balises(network: Network, way: Sequence[PathPart], root: Element) -> tuple[Balise, ...]:
    """The balises; of a file without balises on the way the groups of balises."""
    for kind in ("balises/balise", "baliseGroups/baliseGroup"):
        places = dict.fromkeys(at_m for at_m, _ in _standing(network, way, root.findall(f"{_FUNCTIONAL}/{kind}")))
        if places:
            return tuple(
                Balise(_BALISES_NUMBERED - number % _BALISES_NUMBERED, at_m, at_m) for number, at_m in enumerate(places)
            )
    return ()


def _stops(network: Network, way: Sequence[PathPart], root: Element) -> tuple[Stop, ...]:
    end_m = way[-1].end_m
    named = {"start": 0.0}
    for kind in ("stoppingPlaces/stoppingPlace", "operationalPoints/operationalPoint"):
        for at_m, item in _standing(network, way, root.findall(f"{_FUNCTIONAL}/{kind}")):
            if 0.0 < at_m < end_m:
                named.setdefault(_name(item), at_m)
    named.setdefault("end", end_m)
    return tuple(Stop(name, at_m) for name, at_m in sorted(named.items(), key=lambda one: one[1]))
