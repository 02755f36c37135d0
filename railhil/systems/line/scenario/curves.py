"""The target speed curves of a line's sections: from files where they fit, otherwise generated."""

from __future__ import annotations

from railhil.common.digits import count_of
from railhil.common.errors import Finding, Words
from railhil.scenarios.layers import DATA, Layers, read_toml
from railhil.scenarios.validation import Keys, Refuse, validate
from railhil.systems.ato.scenario import convert
from railhil.systems.ato.scenario.check import DISTANCE_TOLERANCE_M, TIME_TOLERANCE_S
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.ato.scenario.generate import CurveLimits
from railhil.systems.ato.scenario.model import Line, TargetCurve, Train
from railhil.systems.ato.scenario.schema import TargetTable
from railhil.systems.ato.scenario.target import Target
from railhil.systems.line.scenario.legs import LaidRoute
from railhil.systems.line.scenario.model import Section
from railhil.systems.line.scenario.schema import LegTable, RouteTable
from railhil.systems.line.scenario.sections import cut_section, generate_once
from railhil.systems.line.scenario.timetable import Timetable, Way


def find_targets(
    route: RouteTable, laid: LaidRoute, timetable: Timetable, train: Train, layers: Layers, refuse: Refuse
) -> tuple[Section, ...]:
    """The sections with their curves.

    The curve of a file is used if it stops at the section's place and time. If the route gives limits for curves, it is
    used only if it was generated with these.

    :raises InputError: a file is missing or wrong, or no curve is as fast as the timetable.
    """
    limits = convert.curve_limits(route.generate)
    names: dict[int, list[tuple[Keys, str]]] = {}
    tables: list[RouteTable | LegTable] = [route, *route.leg]
    for leg, table in enumerate(tables):
        key: Keys = ("route", "target_files") if leg == 0 else ("route", "leg", leg - 1, "target_files")
        names[leg] = [((*key, row), name) for row, name in enumerate(table.target_files)]
        count = sum(way.leg == leg for way in timetable.ways)
        if names[leg] and len(names[leg]) != count:
            raise refuse(key, Finding(count_of(len(names[leg]), "file")), f"{count}, one for each section of the leg")
    sections = []
    for way in timetable.ways:
        here, there = timetable.stops[way.departure], timetable.stops[way.arrival]
        assert here.depart_s is not None
        assert there.arrive_s is not None
        running_time_s = there.arrive_s - here.depart_s
        track = cut_section(laid.legs[way.leg], train, here.position_m, there.position_m, "")
        target = None
        if names[way.leg]:
            asked = limits if "generate" in route.model_fields_set else None
            target = _read_target(names[way.leg].pop(0), layers, way, running_time_s, asked)
        word = f"{here.name} - {there.name}"
        curves: list[TargetCurve] = []
        if route.regulation == "profiles" or here.mode != "timetable":
            times = [way.fastest_s * (1 + percent / 100) for percent in route.profiles_percent]
            curves = [_generate(track, train, way, time_s, limits, word, refuse) for time_s in times]
        if target is None:
            target = _generate(track, train, way, running_time_s, limits, word, refuse)
        numbers = way.departure, way.arrival, way.leg
        sections.append(Section(*numbers, running_time_s, way.fastest_s, target, tuple(curves)))
    return tuple(sections)


def _generate(
    track: Line, train: Train, way: Way, running_time_s: float, limits: CurveLimits, word: str, refuse: Refuse
) -> TargetCurve:
    try:
        return generate_once(track, train, way.distance_m, running_time_s, limits)
    except CurveError as error:
        words = Words(f"section {word}: {error}")
        raise refuse(("route", "generate"), words, "a run that line and train permit") from None


def _read_target(
    named: tuple[Keys, str], layers: Layers, way: Way, running_time_s: float, limits: CurveLimits | None
) -> TargetCurve | None:
    """The curve of a file; None if it is for another section, timetable or limits (None: any)."""
    file = layers.refer(*named, DATA / "targets")
    table = validate(TargetTable, read_toml(file), lambda _: file)
    made_with = None if table.generate is None else convert.curve_limits(table.generate)
    if table.nodes_s_mps2 is None or limits not in (None, made_with):
        return None
    curve = TargetCurve(tuple(table.nodes_s_mps2))
    evaluated = Target(curve)
    is_there = abs(evaluated.stop_position_m - way.distance_m) <= DISTANCE_TOLERANCE_M
    return curve if is_there and abs(evaluated.stop_time_s - running_time_s) <= TIME_TOLERANCE_S else None
