"""Scenario files of ``line``: read, checked, and with the target speed curves of their sections."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from railhil.common.errors import short_number
from railhil.dbc import Contract
from railhil.scenarios.layers import DATA, Layers, add_own_words, read_toml
from railhil.scenarios.model import PublishedScore
from railhil.scenarios.schema import FAULT_TAGS
from railhil.scenarios.validation import Keys, Refuse, validate
from railhil.systems.ato.scenario import convert
from railhil.systems.ato.scenario import model as ato
from railhil.systems.ato.scenario.schema import TRAIN_TAGS, TrackTable
from railhil.systems.line.scenario import check, model, schema
from railhil.systems.line.scenario.canonical import scenario_sha256
from railhil.systems.line.scenario.curves import find_targets
from railhil.systems.line.scenario.legs import LaidRoute, lay_route, list_overruns
from railhil.systems.line.scenario.model import StationStop
from railhil.systems.line.scenario.protection import (
    ATP_TAGS,
    Protection,
    check_protection,
    list_uncovered,
    protection_of,
)
from railhil.systems.line.scenario.protection_check import list_overspeeds
from railhil.systems.line.scenario.statement import STATEMENT
from railhil.systems.line.scenario.timetable import make_timetable

_TAGS = (*TRAIN_TAGS, *FAULT_TAGS, *ATP_TAGS, *schema.COUNT_TAGS)
#: Sections of a scenario of ``ato`` that ``[route]`` replaces, and keys of its line.
_REPLACED = (("plan",), ("target",), ("line", "from_stop"), ("line", "to_stop"))


def read_line_scenario(
    layers: Layers, contract: Contract, faults_of: Callable[[Sequence[StationStop]], tuple[str, ...]]
) -> model.LineScenario:
    """The scenario of a file with its base files.

    :param contract: the system's port table.
    :param faults_of: reads its faults, which may begin by the timetable of its stops.
    :raises InputError: it is wrong.
    """
    refuse = layers.refuse
    table = _leave_replaced(layers)
    file = validate(schema.LineScenarioFile, table, lambda keys: layers.origin(*keys), _TAGS)
    if layers.main.parent == DATA / "runs" and file.name != layers.main.stem:
        raise refuse(("name",), file.name, f"{layers.main.stem}, the name of the file")
    train = convert.train(file.train, refuse)
    timing, watch = file.timing.in_ns(), convert.watch(file.watch)
    perturbations = _convert_perturbations(file.perturbations)
    check.check_file(file, timing, watch, perturbations, contract, refuse)
    laid = lay_route(file, train.length_m, lambda key, name: _read_line(layers, key, name), refuse)
    check.check_legs(train, laid, refuse)
    protection, emergency = protection_of(file.atp, train), _convert_emergency(file.train.emergency)
    check_protection(protection, refuse)
    timetable = make_timetable(file.route, laid, train, protection, timing.control_period_ns, refuse)
    check.check_balises(laid, timetable.stops, refuse)
    sections = find_targets(file.route, laid, timetable, train, layers, refuse)
    route, last = _convert_route(file.route), timetable.stops[-1]
    assert last.arrive_s is not None
    scenario = model.LineScenario(
        name=file.name,
        title=file.title,
        train=train,
        line=laid.legs[0],
        target=sections[0].target,
        plan=ato.RunPlan(
            distance_m=last.position_m,
            running_time_s=last.arrive_s,
            stop_error_max_m=last.stop_error_max_m,
            time_error_max_s=route.arrival_error_max_s,
            overtime_max_s=file.route.overtime_max_s,
        ),
        timing=timing,
        sensors=convert.sensors(file.sensors),
        energy=convert.energy(file.energy),
        watch=watch,
        safety=convert.safety(file.safety),
        perturbations=perturbations,
        published=tuple(PublishedScore.of(row.model_dump()) for row in file.published),
        assumptions=(
            *file.train.assumptions,
            *file.line.assumptions,
            *laid.remarks,
            *list_overruns(laid, timetable.stops),
            *_list_uncovered(train, protection, emergency),
            *file.assumptions,
            *STATEMENT,
        ),
        faults=faults_of(timetable.stops),
        legs=laid.legs,
        stops=timetable.stops,
        sections=sections,
        route=route,
        signals=_convert_signals(file.route, laid, refuse),
        atp=protection,
        emergency=emergency,
    )
    check.check_scenario(scenario, contract, refuse)
    assumptions = (*scenario.assumptions, *list_overspeeds(scenario))
    scenario = replace(scenario, assumptions=assumptions, sha256=scenario_sha256(scenario))
    return add_own_words(
        scenario, layers, lambda base: read_line_scenario(base, contract, lambda stops: ()), _select_run
    )


def _select_run(scenario: model.LineScenario) -> object:
    """The part that defines the run of a published result: its conditions may differ."""
    return scenario.train, scenario.legs, scenario.stops, scenario.sections, scenario.energy


def _leave_replaced(layers: Layers) -> dict[str, Any]:
    """The scenario as one table, without what it inherits from a scenario of ``ato`` and its route replaces."""
    table = layers.merge()
    for *above, key in _REPLACED:
        inner: Any = table
        for name in above:
            inner = inner.get(name, {})
        if isinstance(inner, dict) and key in inner and layers.place(*above, key) > layers.place("route"):
            del inner[key]
    return table


def _read_line(layers: Layers, key: Keys, name: str) -> TrackTable:
    """A line file by its shipped name or path."""
    file = layers.refer(key, name, DATA / "lines")
    table = read_toml(file)
    for words in ("balises_before_stop_m", "assumptions"):
        table.pop(words, None)
    if isinstance(source := table.get("ttobench"), str):
        table["ttobench"] = str(file.parent / source)
    return validate(TrackTable, table, lambda _: file)


def _convert_perturbations(table: schema.PerturbationsTable) -> model.LinePerturbations:
    common = convert.perturbations(table)
    given: Mapping[str, Any] = {name: getattr(common, name) for name in ato.Perturbations.__dataclass_fields__}
    return model.LinePerturbations(
        **given,
        section_mass_factor=convert.uniform(table.section_mass_factor),
        atp_wheel_factor=convert.uniform(table.atp_wheel_factor),
    )


def _convert_route(table: schema.RouteTable) -> model.Route:
    disturbance, extra = table.dwell_disturbance_s, table.hold.extra_s
    return model.Route(
        door_window_m=table.door_window_m,
        arrival_error_max_s=table.arrival_error_max_s,
        departure_late_max_s=table.departure_late_max_s,
        regulation=table.regulation,
        profiles_percent=table.profiles_percent,
        dwell_disturbance_s=ato.Uniform(*disturbance),
        hold=model.Hold(table.hold.probability, ato.Uniform(*extra)),
        doors=model.Doors(**table.doors.model_dump()),
        jog=model.Jog(table.jog.attempts, table.jog.reach_m, table.jog.speed_kmh / 3.6),
        generate=convert.curve_limits(table.generate),
    )


def _convert_emergency(table: schema.EmergencyTable | None) -> model.EmergencyBrake | None:
    return None if table is None else model.EmergencyBrake(**table.model_dump())


def _list_uncovered(
    train: ato.Train, protection: Protection, emergency: model.EmergencyBrake | None
) -> tuple[str, ...]:
    """Without an emergency brake of its own the train has the full service brake at once."""
    if emergency is None:
        return list_uncovered(protection, train.service_braking_mps2, 0.0)
    return list_uncovered(protection, emergency.braking_mps2, emergency.dead_s + emergency.lag_s)


def _convert_signals(route: schema.RouteTable, laid: LaidRoute, refuse: Refuse) -> tuple[model.RouteSignal, ...]:
    """The signals in run positions."""
    signals = []
    for row, signal in enumerate(route.signal):
        key: Keys = ("route", "signal", row)
        if signal.leg > len(laid.legs):
            raise refuse((*key, "leg"), signal.leg, f"at most {len(laid.legs)}, the number of legs")
        position_m = signal.position_m + laid.begins_m[signal.leg - 1]
        begin_m = max([stop.position_m for stop in laid.stops if stop.leg < signal.leg - 1], default=0.0)
        end_m = max(stop.position_m for stop in laid.stops if stop.leg == signal.leg - 1)
        if not begin_m < position_m < end_m:
            found = short_number(signal.position_m)
            raise refuse((*key, "position_m"), found, "a place between the first and the last stop of its leg")
        signals.append(model.RouteSignal(position_m, signal.clear_s, signal.leg - 1))
    return tuple(signals)
