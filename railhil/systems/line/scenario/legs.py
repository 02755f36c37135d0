"""The legs of a route: their stops, and their profiles and balises in run positions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from railhil.common.errors import Finding, Words, short_number
from railhil.scenarios import profiles
from railhil.scenarios.validation import Keys, Refuse
from railhil.systems.ato.scenario import convert
from railhil.systems.ato.scenario.importers.section import Stop, StopLine, lay_balises, list_begins
from railhil.systems.ato.scenario.mirror import mirror_line
from railhil.systems.ato.scenario.model import Balise, Line
from railhil.systems.ato.scenario.schema import TrackTable
from railhil.systems.line.scenario.model import StationStop
from railhil.systems.line.scenario.schema import LegTable, LineScenarioFile, RouteStopTable, RouteTable

#: Track behind the last stop of a leg whose profiles are kept; the train protection looks that far at most (chosen).
OVERRUN_M = 200.0


@dataclass(frozen=True, slots=True)
class LaidStop:
    """A stop of the route before its times are known.

    ``table`` is its row, which is empty except for name and position if the stop is one of a line's file. ``key`` is
    that of the row, or of the section that names the stops. ``order`` counts the stops of its leg from 0.
    """

    name: str
    position_m: float
    leg: int
    table: RouteStopTable
    key: Keys
    order: int

    def key_of(self, name: str) -> Keys:
        """Key of a value of this stop."""
        return (*self.key, name)


@dataclass(frozen=True, slots=True)
class LaidRoute:
    """Legs with balises, and all stops in the order of the run. ``begins_m``: run position of 0 of each leg's line."""

    legs: tuple[Line, ...]
    stops: tuple[LaidStop, ...]
    begins_m: tuple[float, ...]
    remarks: tuple[str, ...]


#: Reads the line of a leg: (key, name of a line or a path).
ReadLine = Callable[[Keys, str], TrackTable]


def lay_route(file: LineScenarioFile, train_length_m: float, read_line: ReadLine, refuse: Refuse) -> LaidRoute:
    """The legs of a route, one behind the other.

    A leg behind a turn-back begins where the train stands then: its profiles begin at the run position of the stop at
    which it turns.

    :raises InputError: a stop is not known, the positions do not increase, or there are fewer than two.
    """
    route = file.route
    own = file.line.grade_permil is not None and file.line.name is None
    table = file.line.model_copy(update={"name": file.name}) if own else file.line
    whole = convert.whole_line(table, train_length_m, refuse)
    if file.line.direction == "return":
        whole = turn_line(whole, whole.stops, train_length_m, ("line", "direction"), refuse)
    chosen = _choose_stops(whole, route, refuse)
    legs: list[Line] = []
    stops: list[LaidStop] = []
    begins: list[float] = []
    remarks = list(whole.remarks)
    remarks += list_begins(whole.line, chosen[0].position_m)
    begin_m = -chosen[0].position_m
    turns: list[LegTable | None] = [None, *route.leg]
    for number, turn in enumerate(turns):
        if turn is not None:
            key: Keys = ("route", "leg", number - 1)
            if turn.line == "return":
                back = turn_line(
                    whole, [Stop(stop.name, stop.position_m) for stop in chosen], train_length_m, key, refuse
                )
                whole, chosen = back, _mirror_stops(back, chosen)
            else:
                whole = convert.whole_line(read_line((*key, "line"), turn.line), train_length_m, refuse)
                chosen = _cut_stops(whole, key, turn.from_stop, turn.to_stop, refuse)
                if chosen[0].name != stops[-1].name:
                    raise refuse((*key, "from_stop"), chosen[0].name, f"{stops[-1].name}, where the train turns back")
            begin_m = stops[-1].position_m - chosen[0].position_m
        laid = [
            LaidStop(stop.name, stop.position_m + begin_m, number, stop.table, stop.key, order)
            for order, stop in enumerate(chosen)
        ]
        before_m = file.line.balises_before_stop_m
        legs.append(_lay_leg(whole, laid, begin_m, train_length_m, before_m, max(0, len(stops) - 1)))
        stops += laid if turn is None else laid[1:]
        begins.append(begin_m)
    return LaidRoute(tuple(legs), tuple(stops), tuple(begins), tuple(f"line: {remark}" for remark in remarks))


def list_overruns(laid: LaidRoute, stops: Sequence[StationStop]) -> tuple[str, ...]:
    """Remarks about track behind the last stop of a leg, to the end that is protected there."""
    last = [max(place for place, stop in enumerate(stops) if stop.leg == leg) for leg in range(len(laid.legs))]
    return tuple(
        f"line: {stops[place].svl_overlap_m:g} m of overrun track behind {stops[place].name} "
        "with the grade and limit of the stop are assumed"
        for leg, place in zip(laid.legs, last, strict=True)
        if max(leg.grade_permil[-1][0], leg.speed_limit_mps[-1][0]) <= stops[place].position_m
    )


@dataclass(frozen=True, slots=True)
class _Chosen:
    """A stop of a leg in the positions of its line."""

    name: str
    position_m: float
    table: RouteStopTable
    key: Keys


def turn_line(
    whole: StopLine, stops: tuple[Stop, ...] | list[Stop], train_length_m: float, key: Keys, refuse: Refuse
) -> StopLine:
    """The line in the other direction, 0 at the last of the stops."""
    if len(stops) < 2:
        raise refuse(key, "return", "a line with at least two stops")
    end_m = stops[-1].position_m
    return StopLine(
        mirror_line(whole.line, end_m, train_length_m),
        tuple(Stop(stop.name, end_m - stop.position_m) for stop in reversed(stops)),
        whole.remarks,
    )


def _choose_stops(whole: StopLine, route: RouteTable, refuse: Refuse) -> list[_Chosen]:
    if "stops" not in route.model_fields_set:
        return _cut_stops(whole, ("route",), route.from_stop, route.to_stop, refuse)
    if len(route.stops) < 2:
        words = "1 stop" if route.stops else "no stop"
        raise refuse(("route", "stops"), Finding(words), "at least 2")
    for name in ("from_stop", "to_stop"):
        if getattr(route, name) is not None:
            raise refuse(("route", name), getattr(route, name), "no such key beside route.stops")
    for row, (before, after) in enumerate(pairwise(route.stops), start=1):
        if after.position_m <= before.position_m:
            allowed = f"more than {before.position_m:g}, the position of stop {before.name}"
            raise refuse(("route", "stops", row, "position_m"), short_number(after.position_m), allowed)
    return [
        _Chosen(table.name, table.position_m, table, ("route", "stops", row)) for row, table in enumerate(route.stops)
    ]


def _cut_stops(
    whole: StopLine, key: Keys, from_stop: str | int | None, to_stop: str | int | None, refuse: Refuse
) -> list[_Chosen]:
    """The stops of a line's file between two of them; without names the first and the last."""
    if not whole.stops:
        raise refuse(key, Words("no stops"), "stops, or from_stop and to_stop of a line that has stops")
    here = 0 if from_stop is None else convert.find_stop(whole, (*key, "from_stop"), from_stop, refuse)
    there = len(whole.stops) - 1
    if to_stop is not None:
        there = convert.find_stop(whole, (*key, "to_stop"), to_stop, refuse)
    if there <= here:
        raise refuse((*key, "to_stop"), to_stop, "a stop behind from_stop in the direction of running")
    return [
        _Chosen(stop.name, stop.position_m, RouteStopTable(name=stop.name, position_m=stop.position_m), key)
        for stop in whole.stops[here : there + 1]
    ]


def _mirror_stops(back: StopLine, chosen: list[_Chosen]) -> list[_Chosen]:
    """The stops of the leg before, in the other order: with the same doors and limits, without their times."""
    without = {"arrive_s": None, "depart_s": None, "running_time_s": None, "service": None, "mode": None}
    rows = []
    for stop, place in zip(reversed(chosen), back.stops, strict=True):
        passed = {"service": "pass"} if stop.table.service == "pass" else {}
        table = stop.table.model_copy(update={**without, **passed, "position_m": place.position_m})
        rows.append(_Chosen(stop.name, place.position_m, table, stop.key))
    return rows


def _lay_leg(
    whole: StopLine,
    stops: list[LaidStop],
    begin_m: float,
    train_length_m: float,
    before_stop_m: list[float],
    first_stop: int,
) -> Line:
    """Profiles and balises of a leg in run positions.

    :param first_stop: number of its first stop along the run, for the numbers of its balises.
    """
    start_m, end_m = stops[0].position_m, stops[-1].position_m
    line = whole.line

    def cut(profile: profiles.Profile) -> profiles.Profile:
        return profiles.cut(profiles.shift(profile, -begin_m), start_m - train_length_m, end_m + OVERRUN_M)

    found = [
        replace(balise, surveyed_m=balise.surveyed_m + begin_m, true_m=balise.true_m + begin_m)
        for balise in line.balises
    ]
    for order, stop in enumerate(stops):
        found += lay_balises(first_stop + order, stop.position_m, before_stop_m)
    inside = [balise for balise in found if start_m <= balise.surveyed_m <= end_m]
    return Line(line.name, cut(line.grade_permil), cut(line.speed_limit_mps), tuple(sorted(inside, key=_place_of)))


def _place_of(balise: Balise) -> float:
    return balise.surveyed_m
