"""The timetable of a route: services, doors and times of its stops, and its sections."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from railhil.common.digits import count_of
from railhil.common.errors import Finding, Words, short_number
from railhil.scenarios.validation import Keys, Refuse
from railhil.systems.ato.scenario import convert
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.ato.scenario.generate import CurveLimits
from railhil.systems.ato.scenario.model import Train
from railhil.systems.line.scenario.legs import LaidRoute, LaidStop
from railhil.systems.line.scenario.model import Service, StationStop
from railhil.systems.line.scenario.protection import Protection, check_overlaps
from railhil.systems.line.scenario.schema import LegTable, RouteTable
from railhil.systems.line.scenario.sections import cut_section, find_fastest

#: Rounding of sums of times, s.
_ROUNDING_S = 1e-9
#: Keys of the route for stops without a time of their own.
_USUAL_TIMES = ("first_departure_s", "running_time_s", "running_time_reserve_percent", "dwell_s")
_SIDES = "left, right, both or none: doors need a side"


@dataclass(frozen=True, slots=True)
class Way:
    """A section before its curve is known: numbers of its stops, leg, distance and shortest running time."""

    departure: int
    arrival: int
    leg: int
    distance_m: float
    fastest_s: float


@dataclass(frozen=True, slots=True)
class Timetable:
    """Stops with their times, and the ways between the served ones."""

    stops: tuple[StationStop, ...]
    ways: tuple[Way, ...]


def make_timetable(
    route: RouteTable, laid: LaidRoute, train: Train, protection: Protection, control_period_ns: int, refuse: Refuse
) -> Timetable:
    """The stops with services, doors and times.

    A running time is that of the stop or of the array, or the generator's fastest with the reserve.

    :raises InputError: stops, times and arrays do not go together.
    """
    limits = convert.curve_limits(route.generate)
    turns = [place for place, (stop, after) in enumerate(pairwise(laid.stops)) if after.leg > stop.leg]
    stops = [
        _describe(route, stop, place, len(laid.stops), protection, place in turns, refuse)
        for place, stop in enumerate(laid.stops)
    ]
    served = [place for place, stop in enumerate(stops) if stop.service != "pass"]
    ways = tuple(_lay_way(laid, stops, here, there, train, limits, refuse) for here, there in pairwise(served))
    _Times(route, laid, stops, ways, control_period_ns, refuse).fill()
    return Timetable(tuple(stops), ways)


def _lay_way(
    laid: LaidRoute, stops: list[StationStop], here: int, there: int, train: Train, limits: CurveLimits, refuse: Refuse
) -> Way:
    leg = stops[there].leg
    from_m, to_m = stops[here].position_m, stops[there].position_m
    track = cut_section(laid.legs[leg], train, from_m, to_m, "")
    try:
        fastest_s, _ = find_fastest(track, train, to_m - from_m, limits)
    except CurveError as error:
        words = Words(f"section {stops[here].name} - {stops[there].name}: {error}")
        raise refuse(("route", "generate"), words, "a run that line and train permit") from None
    return Way(here, there, leg, to_m - from_m, fastest_s)


def _describe(
    route: RouteTable, stop: LaidStop, place: int, count: int, protection: Protection, turns: bool, refuse: Refuse
) -> StationStop:
    """A stop without its times."""
    table, leg = stop.table, None if stop.leg == 0 else route.leg[stop.leg - 1]
    service = _check_service(stop, place, count, turns, refuse)
    platform = table.platform or _pick(leg, route, "platform", stop, refuse)
    if platform is None and service != "pass":
        raise refuse(stop.key_of("platform"), Finding("nothing"), _SIDES)
    psd = table.psd if table.psd is not None else _pick(leg, route, "psd", stop, refuse)

    mode = table.mode or _pick(leg, route, "mode", stop, refuse)
    if service != "stop":
        mode = "timetable"
        if table.mode is not None:
            why = "the train passes" if service == "pass" else "no departure from the last stop"
            raise refuse(stop.key_of("mode"), table.mode, f"no such key: {why}")

    def choose(given: float | None, usual: float) -> float:
        return usual if given is None else given

    made = StationStop(
        name=stop.name,
        position_m=stop.position_m,
        leg=stop.leg,
        service=service,
        platform="none" if platform is None else platform,
        psd=bool(psd),
        stop_error_max_m=choose(table.stop_error_max_m, route.stop_error_max_m),
        dwell_min_s=choose(table.dwell_min_s, route.dwell_min_s),
        eoa_overlap_m=choose(table.eoa_overlap_m, protection.eoa_overlap_m),
        svl_overlap_m=choose(table.svl_overlap_m, protection.svl_overlap_m),
        turn_back=turns,
        mode=mode,
    )
    check_overlaps(made.eoa_overlap_m, made.svl_overlap_m, stop.key_of("eoa_overlap_m"), refuse)
    return made


def _check_service(stop: LaidStop, place: int, count: int, turns: bool, refuse: Refuse) -> Service:
    service = stop.table.service
    last = place == count - 1
    if place == 0:
        needed, why = "stop", "the first"
    elif turns:
        needed, why = "stop", "the train turns back"
    elif last:
        needed, why = "terminal", "the last"
    else:
        needed, why = "", "not the last"
    if needed and service not in (None, needed):
        raise refuse(stop.key_of("service"), Finding(str(service)), f"{needed} ({why})")
    if not needed and service == "terminal":
        raise refuse(stop.key_of("service"), Finding(service), f"stop or pass ({why})")
    return service or ("terminal" if last else "stop")


def _pick(leg: LegTable | None, route: RouteTable, name: str, stop: LaidStop, refuse: Refuse) -> Any:
    """The value of a stop from its leg's key, or otherwise from the route's."""
    keys: Keys = ("route", "leg", stop.leg - 1, name)
    given = None if leg is None else getattr(leg, name)
    if given is None:
        keys, given = ("route", name), getattr(route, name)
        if isinstance(given, list) and leg is not None:
            raise refuse(keys, given, f"one value for all stops, or {name} in every route.leg")
    if isinstance(given, list):
        if stop.order >= len(given):
            words = Finding(count_of(len(given), "value"))
            raise refuse(keys, words, f"one for each stop of the leg; {stop.name} has none")
        return given[stop.order]
    return given


class _Times:
    """Fills the times of the stops from departure to departure, and checks them."""

    def __init__(
        self,
        route: RouteTable,
        laid: LaidRoute,
        stops: list[StationStop],
        ways: Sequence[Way],
        control_period_ns: int,
        refuse: Refuse,
    ) -> None:
        self._route, self._laid, self._stops, self._ways = route, laid.stops, stops, ways
        self._period_ns, self._refuse = control_period_ns, refuse
        self._leg_ways = [[way for way in ways if way.leg == leg] for leg in range(len(laid.legs))]
        #: Of :data:`_USUAL_TIMES`, those that no stop has made needless.
        self._used = set[str]()

    def fill(self) -> None:
        """:raises InputError: a time is missing, wrong, or given where the train does not stop."""
        self._check_given()
        first = self._laid[0].table
        depart_s = self._route.first_departure_s if first.depart_s is None else first.depart_s
        key = self._usual("first_departure_s") if first.depart_s is None else self._laid[0].key_of("depart_s")
        self._check_period(depart_s, depart_s, key)
        self._stops[0] = replace(self._stops[0], depart_s=depart_s)
        for way in self._ways:
            arrive_s = self._find_arrival(way, depart_s)
            stop = replace(self._stops[way.arrival], arrive_s=arrive_s)
            if stop.service != "terminal":
                depart_s = self._find_departure(way, stop, arrive_s)
                stop = replace(stop, depart_s=depart_s)
            self._stops[way.arrival] = stop
        self._check_used()

    def _usual(self, name: str) -> Keys:
        """Note that a stop has its time from this key of the route."""
        self._used.add(name)
        return ("route", name)

    def _check_used(self) -> None:
        """A time of the route that no stop needs is not read as nothing."""
        between = [stop for stop in self._stops[1:-1] if stop.service != "pass"]
        for name in _USUAL_TIMES:
            if name in self._route.model_fields_set - self._used and (between or name != "dwell_s"):
                given = getattr(self._route, name)
                found = given if isinstance(given, list) else short_number(given)
                raise self._refuse(("route", name), found, "no such key: each stop has a time of its own")

    def _check_given(self) -> None:
        """No time where there is none, and arrays of the right length."""
        for stop, laid in zip(self._stops, self._laid, strict=True):
            first, passed, last = laid is self._laid[0], stop.service == "pass", stop.service == "terminal"
            for name in ("arrive_s", "running_time_s", "depart_s"):
                value = getattr(laid.table, name)
                if value is None:
                    continue
                why = "the train passes" if passed else "no departure from the last stop" if last else "the first stop"
                if passed or (last if name == "depart_s" else first):
                    raise self._refuse(laid.key_of(name), short_number(value), f"no such key: {why}")
            if laid.table.arrive_s is not None and laid.table.running_time_s is not None:
                value = short_number(laid.table.running_time_s)
                raise self._refuse(laid.key_of("running_time_s"), value, "no such key beside arrive_s")
        for leg, ways in enumerate(self._leg_ways):
            table, key = self._table(leg)
            if table.running_time_s and len(table.running_time_s) != len(ways):
                found = Finding(count_of(len(table.running_time_s), "value"))
                raise self._refuse((*key, "running_time_s"), found, f"{len(ways)}, one for each section of the leg")

    def _table(self, leg: int) -> tuple[RouteTable | LegTable, Keys]:
        return (self._route, ("route",)) if leg == 0 else (self._route.leg[leg - 1], ("route", "leg", leg - 1))

    def _find_arrival(self, way: Way, depart_s: float) -> float:
        laid = self._laid[way.arrival]
        table, key = self._table(way.leg)
        place = self._leg_ways[way.leg].index(way)
        fastest = f"fastest {way.fastest_s:.1f} s with route.generate"
        if laid.table.arrive_s is not None:
            arrive_s, source = laid.table.arrive_s, laid.key_of("arrive_s")
            found_s, least_s = arrive_s, self._round_up(depart_s + way.fastest_s)
            fastest = f"depart {depart_s:g} + {fastest}"
        else:
            if laid.table.running_time_s is not None:
                found_s, source = laid.table.running_time_s, laid.key_of("running_time_s")
            elif table.running_time_s:
                self._usual("running_time_s")
                found_s, source = table.running_time_s[place], (*key, "running_time_s", place)
            elif self._route.running_time_reserve_percent is not None:
                reserve = self._route.running_time_reserve_percent
                self._usual("running_time_reserve_percent")
                running_s = self._round_up(float(math.ceil(way.fastest_s * (1 + reserve / 100))))
                return depart_s + running_s
            else:
                allowed = "a time, running_time_s, or route.running_time_reserve_percent for all stops without"
                raise self._refuse(laid.key_of("arrive_s"), Finding("nothing"), allowed)
            arrive_s, least_s = depart_s + found_s, self._round_up(way.fastest_s)
        if found_s < least_s - _ROUNDING_S:
            raise self._refuse(source, short_number(found_s), f"at least {least_s:g} ({fastest})")
        self._check_period(arrive_s, found_s, source)
        return arrive_s

    def _find_departure(self, way: Way, stop: StationStop, arrive_s: float) -> float:
        laid = self._laid[way.arrival]
        given_s, key = laid.table.depart_s, laid.key_of("depart_s")
        if given_s is None:
            dwell_s, key = self._find_dwell(way, stop)
            given_s, found_s, base_s = arrive_s + dwell_s, dwell_s, 0.0
            why = f"dwell_min_s {stop.dwell_min_s:g}"
        else:
            found_s, base_s = given_s, arrive_s
            why = f"arrive {arrive_s:g} + dwell_min_s {stop.dwell_min_s:g}"
        if given_s < arrive_s + stop.dwell_min_s - _ROUNDING_S:
            least_s = self._round_up(base_s + stop.dwell_min_s)
            raise self._refuse(key, short_number(found_s), f"at least {least_s:g} ({why})")
        self._check_period(given_s, found_s, key)
        return given_s

    def _find_dwell(self, way: Way, stop: StationStop) -> tuple[float, Keys]:
        if stop.turn_back:
            return self._route.leg[way.leg].turn_back_s, ("route", "leg", way.leg, "turn_back_s")
        table, key = self._table(way.leg)
        if table.dwell_s is None:
            table, key = self._route, ("route",)
        self._usual("dwell_s")
        dwell_s = table.dwell_s
        assert dwell_s is not None
        if not isinstance(dwell_s, list):
            return dwell_s, (*key, "dwell_s")
        ways = self._leg_ways[way.leg]
        place = ways.index(way)
        if place >= len(dwell_s):
            allowed = f"{len(ways) - 1}, one for each stop between the first and the last of the leg"
            raise self._refuse((*key, "dwell_s"), Finding(count_of(len(dwell_s), "value")), allowed)
        return dwell_s[place], (*key, "dwell_s", place)

    def _round_up(self, time_s: float) -> float:
        """The next multiple of the control period."""
        period_s = self._period_ns * 1e-9
        return math.ceil(time_s / period_s - _ROUNDING_S) * period_s

    def _check_period(self, time_s: float, found_s: float, key: Keys) -> None:
        """A time of the run is a multiple of the control period, in which a departure is ordered."""
        if abs(time_s * 1e9 - round(time_s * 1e9 / self._period_ns) * self._period_ns) > 1.0:
            allowed = f"a multiple of control_period_ms = {self._period_ns / 1e6:g}"
            raise self._refuse(key, short_number(found_s), allowed)
