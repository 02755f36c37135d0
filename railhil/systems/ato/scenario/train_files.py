"""Scenario files of ``ato``: read, checked, and with their target speed curve."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from railhil.common.errors import Words
from railhil.dbc import wire_contract
from railhil.scenarios.carried import check_carried
from railhil.scenarios.layers import DATA, Layers, add_own_words
from railhil.scenarios.model import PublishedScore
from railhil.scenarios.schema import FAULT_TAGS
from railhil.scenarios.validation import Refuse, validate
from railhil.systems.ato.scenario import check, convert, model
from railhil.systems.ato.scenario.canonical import scenario_sha256
from railhil.systems.ato.scenario.check import train_reaches
from railhil.systems.ato.scenario.envelope import CurveError
from railhil.systems.ato.scenario.generate import fastest_time_s, generate
from railhil.systems.ato.scenario.schema import TRAIN_TAGS, ScenarioFile

_RUNS = DATA / "runs"


@dataclass(frozen=True, slots=True)
class Parts:
    """A scenario file, read and checked except for its target speed curve."""

    file: ScenarioFile
    train: model.Train
    line: model.Line
    line_remarks: tuple[str, ...]
    refuse: Refuse


def read_parts(path: Path) -> Parts:
    """Files, train and line of a scenario. Raises :class:`InputError`."""
    return _parts(Layers(path))


def _parts(layers: Layers) -> Parts:
    path = layers.main
    refuse = layers.refuse
    file = validate(ScenarioFile, layers.merge(), lambda keys: layers.origin(*keys), (*TRAIN_TAGS, *FAULT_TAGS))
    if path.parent == _RUNS and file.name != path.stem:
        raise refuse(("name",), file.name, f"{path.stem}, the name of the file")
    train = convert.train(file.train, refuse)
    made = convert.line(file.line, train.length_m, refuse)
    line, section_m = made.line, made.section_m
    check.check_tables(train, line, refuse)
    if section_m is not None and abs(section_m - file.plan.distance_m) > check.DISTANCE_TOLERANCE_M:
        raise refuse(("plan", "distance_m"), file.plan.distance_m, f"{section_m:g} m, the distance of the stops")
    behind = [row for row, balise in enumerate(line.balises) if balise.surveyed_m > file.plan.distance_m]
    # A line may be longer than a run on it: a remark then says so, unless the file gives both values.
    if behind and layers.place("line", "balises") <= layers.place("plan", "distance_m"):
        allowed = f"at most plan.distance_m = {file.plan.distance_m:g}: the run ends there"
        raise refuse(("line", "balises", behind[0], "surveyed_m"), line.balises[behind[0]].surveyed_m, allowed)
    return Parts(file, train, line, made.remarks, refuse)


def read_train_scenario(layers: Layers, faults_of: Callable[[], tuple[str, ...]]) -> model.Scenario:
    """The scenario of a file with its base files.

    :param faults_of: reads its faults, after the types of all keys have been checked.
    :raises InputError: it is wrong.
    """
    parts = _parts(layers)
    faults = faults_of()
    file, refuse = parts.file, parts.refuse
    timing = file.timing.in_ns()
    perturbations = convert.perturbations(file.perturbations)
    watch = convert.watch(file.watch)
    contract = wire_contract()
    check.check_timing(timing, perturbations, contract, refuse)
    if "sdt" not in file.safety.model_fields_set:
        for port in (port.name for port in contract.ports if port.optional):
            if port in timing.port_period_ns:
                allowed = "only beside safety.sdt, without which nothing sends it"
                raise refuse(("timing", "port_period_ms", port), timing.port_period_ns[port] / 1e6, allowed)
    check.check_perturbations(perturbations, refuse)
    check.check_watch(watch, refuse)
    check.check_periods(timing, watch, file.safety.sdt, contract, refuse)
    curve, running_time_s = _make_target(parts)
    target = check.make_target(curve, refuse)
    assumptions = (*file.train.assumptions, *file.line.assumptions, *parts.line_remarks, *file.assumptions)
    if behind := [balise.number for balise in parts.line.balises if balise.surveyed_m > file.plan.distance_m]:
        numbers = ", ".join(map(str, behind))
        assumptions = (*assumptions, f"balises that the run never passes, behind its stop: {numbers}")
    scenario = model.Scenario(
        name=file.name,
        title=file.title,
        train=parts.train,
        line=parts.line,
        target=curve,
        plan=convert.plan(file.plan, running_time_s),
        timing=timing,
        sensors=convert.sensors(file.sensors),
        energy=convert.energy(file.energy),
        watch=watch,
        safety=convert.safety(file.safety),
        perturbations=perturbations,
        published=tuple(PublishedScore.of(row.model_dump()) for row in file.published),
        assumptions=assumptions,
        faults=faults,
        draws=tuple(file.draws),
        noise=tuple(file.noise),
        noise_from=file.noise_from,
    )
    check.check_vector(scenario, refuse)
    check.check_run(scenario, target, refuse)
    check_carried(contract, train_reaches(scenario, target), refuse)
    check.check_authority(scenario, refuse)
    scenario = replace(scenario, sha256=scenario_sha256(scenario))
    return add_own_words(scenario, layers, lambda base: read_train_scenario(base, tuple), _select_run)


def _select_run(scenario: model.Scenario) -> object:
    """The part that defines the run of a published result: its conditions may differ."""
    plan = scenario.plan
    return scenario.train, scenario.line, scenario.target, plan.distance_m, plan.running_time_s, scenario.energy


def _make_target(parts: Parts) -> tuple[model.TargetCurve, float]:
    """The target curve and the running time: from the nodes if they are given, else generated."""
    table, given_s = parts.file.target, parts.file.plan.running_time_s
    if table.nodes_s_mps2 is None:
        return generate_target(parts)
    reserve = parts.file.plan.running_time_reserve_percent
    if reserve is not None:
        allowed = "no such key beside target.nodes_s_mps2, which say how long the run takes"
        raise parts.refuse(("plan", "running_time_reserve_percent"), reserve, allowed)
    if given_s is None:
        raise parts.refuse(("plan",), Words("no running_time_s"), "running_time_s beside given nodes")
    return model.TargetCurve(tuple(table.nodes_s_mps2)), given_s


def generate_target(parts: Parts) -> tuple[model.TargetCurve, float]:
    """Curve and running time from ``[target.generate]``; a reserve is rounded up to whole seconds.

    Raises :class:`InputError` when there is no such table or when no curve meets the requirements.
    """
    table, plan = parts.file.target.generate, parts.file.plan
    if table is None:
        raise parts.refuse(("target",), Words(), "nodes_s_mps2 or a [target.generate] table")
    limits = convert.curve_limits(table)
    given_s, reserve = plan.running_time_s, plan.running_time_reserve_percent
    try:
        if given_s is None and reserve is not None:
            fastest_s = fastest_time_s(parts.line, parts.train, plan.distance_m, limits)
            running_time_s = float(math.ceil(fastest_s * (1 + reserve / 100)))
        elif given_s is not None and reserve is None:
            running_time_s = given_s
        else:
            found = Words("neither" if given_s is None else "both")
            raise parts.refuse(("plan",), found, "exactly one of running_time_s and running_time_reserve_percent")
        return generate(parts.line, parts.train, plan.distance_m, running_time_s, limits), running_time_s
    except CurveError as error:
        raise parts.refuse(("target", "generate"), Words(str(error)), "a run that line and train permit") from None
