"""Consistency of a scenario of ``line`` beyond single values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from railhil.common.errors import Finding, InputError, Words, short_number
from railhil.dbc import Contract
from railhil.scenarios.carried import check_carried
from railhil.scenarios.model import Timing
from railhil.scenarios.schema import RUNNING_TIME_MAX_S
from railhil.scenarios.validation import Keys, Refuse
from railhil.systems.ato.scenario import check
from railhil.systems.ato.scenario.model import Train, WatchLimits
from railhil.systems.line.scenario.legs import LaidRoute
from railhil.systems.line.scenario.model import LinePerturbations, LineScenario, StationStop
from railhil.systems.line.scenario.protection_check import check_targets
from railhil.systems.line.scenario.schema import STOPS_MAX, LineScenarioFile
from railhil.systems.line.scenario.sections import section_scenario

#: A balise is needed within this distance before a stop (chosen).
BALISE_BEFORE_STOP_M = 200.0


def check_file(
    file: LineScenarioFile,
    timing: Timing,
    watch: WatchLimits,
    perturbations: LinePerturbations,
    contract: Contract,
    refuse: Refuse,
) -> None:
    """Periods, watches, perturbations, and rules of the route that contradict each other."""
    if file.safety.sdt:
        raise refuse(("safety", "sdt"), Finding("true"), "false with system line (32 mailboxes)")
    check.check_timing(timing, perturbations, contract, refuse)
    check.check_perturbations(perturbations, refuse)
    check.check_watch(watch, refuse)
    check.check_periods(timing, watch, False, contract, refuse)
    route = file.route
    errors_m: list[tuple[Keys, float]] = [(("route", "stop_error_max_m"), route.stop_error_max_m)]
    for row, stop in enumerate(route.stops):
        if stop.stop_error_max_m is not None:
            errors_m.append((("route", "stops", row, "stop_error_max_m"), stop.stop_error_max_m))
    for key, error_m in errors_m:
        if route.door_window_m < error_m:
            word = "stop_error_max_m" if len(key) == 2 else f"stop_error_max_m of {key[1]}[{key[2]}]"
            found = short_number(route.door_window_m)
            raise refuse(("route", "door_window_m"), found, f"at least {word} = {error_m:g}")
    for key, pair in ((("dwell_disturbance_s",), route.dwell_disturbance_s), (("hold", "extra_s"), route.hold.extra_s)):
        if not 0.0 <= pair[0] <= pair[1]:
            raise refuse(("route", *key), list(pair), "[low, high] with 0 <= low <= high")
    rising = route.profiles_percent
    if not rising[0] <= rising[1] <= rising[2]:
        raise refuse(("route", "profiles_percent"), list(rising), "reserves that increase: fast, normal, economy")


def check_legs(train: Train, laid: LaidRoute, refuse: Refuse) -> None:
    """Profiles, effort curves and balises of all legs."""
    if len(laid.stops) > STOPS_MAX:
        raise refuse(("route", "stops"), Finding(f"{len(laid.stops)} stops"), f"at most {STOPS_MAX}")
    for leg in laid.legs:
        check.check_tables(train, leg, refuse)


def check_balises(laid: LaidRoute, stops: Sequence[StationStop], refuse: Refuse) -> None:
    """Each stop at which the train arrives has a balise shortly before it."""
    for stop in stops[1:]:
        low_m = stop.position_m - BALISE_BEFORE_STOP_M
        places_m = [balise.surveyed_m for balise in laid.legs[stop.leg].balises]
        if stop.service != "pass" and not any(low_m <= place_m <= stop.position_m for place_m in places_m):
            words = f"none in the last {BALISE_BEFORE_STOP_M:g} m before stop {stop.name}"
            raise refuse(("line", "balises"), Finding(words), "at least 1")


def check_scenario(scenario: LineScenario, contract: Contract, refuse: Refuse) -> None:
    """Targets within the limits of line and train, a run that ends in time, values that the wire carries."""
    if scenario.plan.running_time_s > RUNNING_TIME_MAX_S:
        found = short_number(scenario.plan.running_time_s)
        raise refuse(("route",), Finding(f"an arrival at {found} s"), f"at most {RUNNING_TIME_MAX_S:g} s")
    for index, section in enumerate(scenario.sections):
        here, there = scenario.stops[section.departure].name, scenario.stops[section.arrival].name

        def refuse_section(keys: Keys, found: object, allowed: str, name: str = f"{here} - {there}") -> InputError:
            return refuse(("route",), Words(f"section {name}: {'.'.join(map(str, keys))}: found {found}"), allowed)

        for curve in (section.target, *section.profiles):
            target = check.make_target(curve, refuse_section)
            check.check_run(section_scenario(scenario, index, curve, target.stop_time_s), target, refuse_section)
            on_leg = replace(scenario, line=scenario.legs[section.leg])
            check_carried(contract, check.train_reaches(on_leg, target), refuse)
    for leg in scenario.legs:
        check.check_authority(replace(scenario, line=leg), refuse)
    check_targets(scenario, refuse)
