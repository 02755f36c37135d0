"""Load a scenario by its shipped name or from a TOML file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words, did_you_mean, near_file
from railhil.scenarios import check, convert, model
from railhil.scenarios.blame import blamed
from railhil.scenarios.canonical import judged_sha256, scenario_sha256
from railhil.scenarios.envelope import CurveError
from railhil.scenarios.fault_rows import faults_of_rows
from railhil.scenarios.generate import fastest_time_s, generate
from railhil.scenarios.keys import USUAL
from railhil.scenarios.layers import DATA, Layers, Without, shipped_name, shipped_names, short_name
from railhil.scenarios.reference import Key, keys
from railhil.scenarios.schema import FAULT_TAGS, TRAIN_TAGS, ScenarioFile
from railhil.scenarios.stored import document, scenario_of
from railhil.scenarios.system import DEFAULT, System, system_named
from railhil.scenarios.task import ScenarioKind
from railhil.scenarios.validation import Keys, dotted, validated

RUNS = DATA / "runs"


def names() -> list[str]:
    """Names of the shipped scenarios, sorted."""
    return shipped_names(RUNS)


def short_names() -> dict[str, str]:
    """Short name of each shipped scenario, by its whole name."""
    known = names()
    return {name: short_name(name, known) for name in known}


def load(name_or_path: str | Path, settings: Sequence[str] = (), faults: Sequence[str] = ()) -> model.Scenario:
    """Like :func:`load_any`, for code that works only with railhil's own system ``ato``.

    Raises :class:`~railhil.common.errors.InputError` also for a scenario of another system.
    """
    scenario = load_any(name_or_path, settings, faults)
    if not isinstance(scenario, model.Scenario):
        allowed = f"{DEFAULT}: nothing else has what this needs"
        raise InputError(find(name_or_path), "system", scenario.system, allowed)
    return scenario


def load_any(name_or_path: str | Path, settings: Sequence[str] = (), faults: Sequence[str] = ()) -> model.AnyScenario:
    """The scenario of a shipped name (or the beginning of one), or of a path that ends in ``.toml``, of its system.

    :param settings: keys set in addition, ``KEY=VALUE`` (:mod:`railhil.scenarios.settings`).
    :param faults: faults in addition to those of its files (:mod:`railhil.faults.language`).

    Raises :class:`~railhil.common.errors.InputError` (one line) for anything in the files that is not allowed.
    """
    path = find(name_or_path)
    layers = Layers(path, settings, faults=faults)

    def loads(without: Without) -> bool:
        try:
            _read(Layers(path, settings, without, faults))
        except InputError:
            return False
        return True

    try:
        return _read(layers)
    except InputError as error:
        raise blamed(layers, error, loads) from error.__cause__


def _read(layers: Layers) -> model.AnyScenario:
    name = layers.merged().get("system", DEFAULT)
    system = system_named(name if isinstance(name, str) else repr(name), layers.origin("system"))
    kind: ScenarioKind = system.part("scenarios")(system)
    return kind.read(layers)


def find(name_or_path: str | Path) -> Path:
    """The file behind a scenario name or path. Raises :class:`InputError` when there is none."""
    text = str(name_or_path)
    if text.endswith(".toml"):
        path = Path(text)
        if not path.is_file():
            raise InputError(path, "", Words("no such file"), "an existing .toml file", near_file(path))
        return path
    name = shipped_name(text, RUNS)
    if name is None:
        known = names()
        own = Path(f"{text}.toml")
        several = [other for other in known if text and other.startswith(text)]
        hint = None if several else did_you_mean(text, {*known, *short_names().values()})
        if own.is_file():
            hint = f"did you mean {own}?"
        allowed = f"a path ending in .toml, or one of {', '.join(several or known)}"
        raise InputError("scenario", "name", text, allowed, hint)
    return RUNS / f"{name}.toml"


def stable_name(name_or_path: str) -> str:
    """The name to record for a scenario: full name or absolute path, valid from any folder.

    Raises :class:`InputError` when there is none.
    """
    path = find(name_or_path)
    return str(path.resolve()) if name_or_path.endswith(".toml") else path.stem


class TrainScenarios:
    """Scenarios of ``ato``, see :class:`railhil.scenarios.task.ScenarioKind`."""

    def __init__(self, system: System) -> None:
        self._system = system

    def read(self, layers: Layers) -> model.Scenario:
        rows = layers.merged().get("fault", ())
        parts = _parts(layers)
        return _build(parts, faults_of_rows(rows, self._system, lambda row: layers.origin("fault", row)))

    def document(self, scenario: model.Scenario) -> dict[str, Any]:
        return document(scenario)

    def stored(self, fields: dict[str, Any], file: Path) -> model.Scenario:
        scenario = scenario_of(fields, file)
        return replace(scenario, sha256=scenario_sha256(scenario))

    def judged_sha256(self, scenario: model.Scenario) -> str:
        return judged_sha256(scenario)

    def usual_keys(self) -> list[Key]:
        return [key for key in keys() if key.name in USUAL]


@dataclass(frozen=True, slots=True)
class Parts:
    """A scenario file, read and checked except for its target speed curve."""

    file: ScenarioFile
    train: model.Train
    line: model.Line
    refuse: convert.Refuse


def read_parts(path: Path) -> Parts:
    """Files, train and line of a scenario. Raises :class:`InputError`."""
    return _parts(Layers(path))


def _parts(layers: Layers) -> Parts:
    path = layers.main

    def refuse(keys: Keys, found: object, allowed: str) -> InputError:
        return InputError(layers.origin(*keys), dotted(keys), found, allowed)

    file = validated(ScenarioFile, layers.merged(), lambda keys: layers.origin(*keys), (*TRAIN_TAGS, *FAULT_TAGS))
    if path.parent == RUNS and file.name != path.stem:
        raise refuse(("name",), file.name, f"{path.stem}, the name of the file")
    train = convert.train(file.train, refuse)
    line, section_m = convert.line(file.line, train.length_m, refuse)
    check.check_tables(train, line, refuse)
    if section_m is not None and abs(section_m - file.plan.distance_m) > check.DISTANCE_TOLERANCE_M:
        raise refuse(("plan", "distance_m"), file.plan.distance_m, f"{section_m:g} m, the distance of the stops")
    return Parts(file, train, line, refuse)


def _build(parts: Parts, faults: tuple[str, ...]) -> model.Scenario:
    file, refuse = parts.file, parts.refuse
    timing = convert.timing(file.timing)
    perturbations = convert.perturbations(file.perturbations)
    watch = convert.watch(file.watch)
    check.check_timing(timing, perturbations, refuse)
    check.check_perturbations(perturbations, refuse)
    check.check_watch(watch, refuse)
    curve, running_time_s = _target(parts)
    target = check.checked_target(curve, refuse)
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
        published=tuple(model.PublishedScore.of(row.model_dump()) for row in file.published),
        assumptions=(*file.train.assumptions, *file.line.assumptions, *file.assumptions),
        faults=faults,
    )
    check.check_run(scenario, target, refuse)
    check.check_authority(scenario, refuse)
    return replace(scenario, sha256=scenario_sha256(scenario))


def _target(parts: Parts) -> tuple[model.TargetCurve, float]:
    """The target curve and the running time: from the nodes if they are given, else generated."""
    table, given_s = parts.file.target, parts.file.plan.running_time_s
    if table.nodes_s_mps2 is None:
        return generated_target(parts)
    if given_s is None:
        raise parts.refuse(("plan",), Words("no running_time_s"), "running_time_s beside given nodes")
    return model.TargetCurve(tuple(table.nodes_s_mps2)), given_s


def generated_target(parts: Parts) -> tuple[model.TargetCurve, float]:
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
