"""The specification of a run from its sources: a TOML file or a certificate, the environment, a command line.

Each source is a :class:`Layer` with some of the keys of :meth:`railhil.scenarios.run_spec.RunSpec.as_json`. In
``railhil run`` the command line overrides the environment, the environment the file, and the file the defaults.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from railhil.common.command_line import (
    APPEAR_MAX_S,
    ARITHMETICS,
    BUSES,
    INDEXINGS,
    PACES,
    RATE_MAX,
    RATE_MIN,
    RUN_NUMBER_MAX,
    SEED_MAX,
    TASK_PERIOD_MAX_MS,
    USUAL_LAW,
    USUAL_SCENARIO,
)
from railhil.common.errors import Faults, InputError, Sentence, Words, did_you_mean
from railhil.common.patience import PATIENCE_S
from railhil.common.user_files import given_text, parse_json, refuse_unreadable
from railhil.faults import FAULT
from railhil.scenarios.given import KEY as GIVEN_KEY
from railhil.scenarios.given import NO_CODE, NamedCode, RecordedController
from railhil.scenarios.load import load_any, stable_name
from railhil.scenarios.memory import Memory, memory_from_json
from railhil.scenarios.memory_store import MemoryStore, read_memory
from railhil.scenarios.parameters import ParameterSet, load_parameters, parameters_from_json
from railhil.scenarios.plant_fmu import KEY as FMU_KEY
from railhil.scenarios.plant_fmu import check_recorded_fmu
from railhil.scenarios.settings import REQUIREMENTS, normalise_fault, normalise_setting
from railhil.scenarios.tomlfile import parse_toml
from railhil.scenarios.validation import list_errors

#: Key of a run -> its option of ``railhil run``; the scenario is a positional argument.
OPTIONS: Mapping[str, str] = {
    "scenario": "scenario",
    "settings": "--set",
    "faults": "--fault",
    "controller": "--controller",
    "arithmetic": "--arithmetic",
    "indexing": "--indexing",
    "parameters": "--parameters",
    "task_period_ms": "--task-period-ms",
    "seed": "--seed",
    "perturbed": "--perturbed",
    "run_number": "--run-number",
    "pace": "--pace",
    "rate": "--rate",
    "patience_s": "--patience",
    "bus": "--bus",
    "memory_store": "--memory",
    "memory": "--memory-from",
    "orders": "--order",
}
_WITHOUT_VARIABLE = ("settings", "faults", "orders")
#: Key of a run -> its environment variable: the name of the option with the prefix ``RAILHIL_``; compose uses the
#: same names without the prefix. Settings, faults and orders have no variable, because
#: there may be many.
ENVIRONMENT: Mapping[str, str] = {
    key: "RAILHIL_" + option.lstrip("-").replace("-", "_").upper()
    for key, option in OPTIONS.items()
    if key not in _WITHOUT_VARIABLE
}
#: Variables with our prefix that others read: the package itself, its build, its tests, pytest's plugin and compose.
#: Any other name is a mistake of the user and is refused.
OTHER_VARIABLES = frozenset(
    f"RAILHIL_{name}"
    for name in (
        *("PURE", "TRACEBACK", "COMPILED", "LABEL", "CACHE", "REQUIRE_ALL", "SAMPLE", "OPERATOR"),
        *("SEEDS", "RUNS", "NO_CONTROLLER", "TARGET", "REQUIREMENTS"),
        *("UID", "GID", "COMPOSE", "BUILD_NETWORK", "VCAN_RUNS", "VCAN_CASES"),
    )
)
#: Keys whose value is a file name, except in a certificate, which holds the content; ``memory_store`` is always one.
_MEMORY = ("memory", "memory_store")
_FILES = ("parameters", "memory", "memory_store")
_ALLOWED = "a run in TOML, or certificate.json of a run folder"


class RunDocument(BaseModel):
    """A run as JSON, with the ranges of the command line; unknown keys are ignored, as in a certificate."""

    model_config = ConfigDict(defer_build=True, extra="ignore", strict=True, allow_inf_nan=False)
    scenario: str = Field(default=USUAL_SCENARIO, min_length=1)
    settings: list[str] = []
    faults: list[str] = []
    controller: str = Field(default=USUAL_LAW, min_length=1)
    arithmetic: Literal[ARITHMETICS] = "iq"  # type: ignore[valid-type]
    indexing: Literal[INDEXINGS] = "time"  # type: ignore[valid-type]
    parameters: dict[str, Any] | None = None
    task_period_ms: int = Field(default=0, ge=0, le=TASK_PERIOD_MAX_MS)
    seed: int = Field(default=0, ge=0, le=SEED_MAX)
    perturbed: bool = False
    run_number: int = Field(default=1, ge=1, le=RUN_NUMBER_MAX)
    pace: Literal[PACES] = "lockstep"  # type: ignore[valid-type]
    rate: Annotated[float, Field(ge=RATE_MIN, le=RATE_MAX)] | None = None
    patience_s: float = Field(default=PATIENCE_S, gt=0, le=APPEAR_MAX_S)
    bus: Literal[BUSES] = "auto"  # type: ignore[valid-type]
    memory_store: str | None = Field(default=None, min_length=1)
    memory: dict[str, Any] | None = None
    orders: list[str] = []


class _Named(RunDocument):
    """A run as a person writes it: parameters and memory are given as file names."""

    model_config = ConfigDict(defer_build=True, extra="forbid")
    parameters: str | None = Field(default=None, min_length=1)  # type: ignore[assignment]
    memory: str | None = Field(default=None, min_length=1)  # type: ignore[assignment]


@dataclass(frozen=True)
class Layer:
    """The part of a run that one source defines.

    :param source: the file, or a description of the source.
    :param values: by key of a run. ``parameters``, ``memory``: path of their file; in a certificate, their content.
    :param names: the source's name of a key, if it differs.
    :param folder: file names are relative to it.
    """

    source: str | Path
    values: Mapping[str, Any]
    names: Mapping[str, str] = field(default_factory=dict)
    folder: Path = Path()

    @property
    def fault_source(self) -> str | Path:
        """The source named in errors about a fault."""
        return FAULT if self.names is OPTIONS else self.source

    def refuse(self, key: str, found: object, allowed: str, hint: str | None = None) -> InputError:
        """The error for one of the values."""
        return InputError(self.source, self.names.get(key, key), found, allowed, hint)


def restore_asked(document: Mapping[str, Any]) -> dict[str, Any]:
    """A certificate with the values that were asked for, where a foreign controller has not confirmed them."""
    asked = document.get("asked")
    return {**document, **asked} if isinstance(asked, dict) else dict(document)


def file_layer(path: Path, faults: Faults, code: NamedCode = NO_CODE) -> Layer:
    """The run of a TOML file, or of a certificate (``.json``) of any version. Errors are added to ``faults``.

    :param code: that the command line names.
    """
    stored = path.suffix.lower() == ".json"
    values: dict[str, Any] = {}
    with faults.kept():
        values = restore_asked(_read_table(path, stored)) if stored else _read_table(path, stored)
        if values.get(FMU_KEY) and stored:
            check_recorded_fmu(values, path, code.plant_fmu)
        if values.get(GIVEN_KEY) and stored:
            recorded = values
            # The name is that of no law.
            values = {key: value for key, value in values.items() if key not in ("controller", "arithmetic")}
            found = code.check_recorded(recorded, path).controller
            if isinstance(found, RecordedController):
                raise found.refuse()
    model = RunDocument if stored else _Named
    try:
        model.model_validate(values)
    except ValidationError as error:
        wrong = list_errors(error, model, path)
        faults.found += wrong.values()
        values = {key: value for key, value in values.items() if key not in wrong}
    known = {key: value for key, value in values.items() if key in RunDocument.model_fields and value is not None}
    if not stored:
        known |= {key: path.parent / known[key] for key in _FILES if key in known}
    if stored and values.get(REQUIREMENTS):
        known[REQUIREMENTS] = values[REQUIREMENTS]
    if stored and known.get("pace", "lockstep") == "lockstep":
        # A certificate of version 0.1.0 has a rate in lockstep too.
        known.pop("rate", None)
    return Layer(path, known, folder=path.parent)


def environment_layer(environment: Mapping[str, str], faults: Faults) -> Layer:
    """The values of the variables in :data:`ENVIRONMENT`; empty ones are ignored. Errors are added to ``faults``."""
    said = {key: environment[name] for key, name in ENVIRONMENT.items() if environment.get(name)}
    source = "environment"
    ours = [name for name, value in environment.items() if name.startswith("RAILHIL_") and value]
    for name in sorted({*ours} - {*ENVIRONMENT.values()} - OTHER_VARIABLES):
        options = " and ".join(OPTIONS[key] for key in _WITHOUT_VARIABLE)
        allowed = f"a variable of docs/reference/run_spec.md, or no such variable; {options} have none"
        hint = did_you_mean(name, ENVIRONMENT.values())
        faults.found.append(InputError(source, name, environment[name], allowed, hint))
    values: dict[str, Any] = {}
    if not said:
        # Most often there is nothing to check, and no model to build.
        return Layer(source, values, ENVIRONMENT)
    try:
        values = _Named.model_validate_strings(said).model_dump(exclude_unset=True)
    except ValidationError as error:
        for key, one in list_errors(error, _Named, source).items():
            faults.found.append(InputError(source, ENVIRONMENT[key], said[key], one.allowed, one.hint))
    values |= {key: Path(values[key]) for key in _FILES if key in values}
    return Layer(source, values, ENVIRONMENT)


def merge_layers(layers: Sequence[Layer], faults: Faults) -> tuple[dict[str, Any], ParameterSet | None, Memory | None]:
    """The document of a run defined by several sources, later ones overriding earlier ones, and the law's parameters
    and memory.

    Settings and faults accumulate; without a law the default one of the scenario's system is used.

    :raises InputError: all errors, together with those already in ``faults``.
    """
    document: dict[str, Any] = {}
    said: dict[str, Layer] = {}
    settings: list[str] = []
    faults_given: list[str] = []
    for layer in layers:
        if {*_MEMORY} <= {*layer.values}:
            names = [layer.names.get(key, key) for key in _MEMORY]
            allowed = Sentence(f"cannot be given with {names[1]}")
            faults.found.append(layer.refuse("memory", Words(f"beside {names[1]}"), allowed))
        if any(key in layer.values for key in _MEMORY):
            # Both define the memory with which the run begins.
            document = {key: value for key, value in document.items() if key not in _MEMORY}
        document |= layer.values
        said |= dict.fromkeys(layer.values, layer)
        for text in layer.values.get("settings", ()):
            with faults.kept():
                settings.append(normalise_setting(text, layer.folder))
        for text in layer.values.get("faults", ()):
            with faults.kept():
                faults_given.append(normalise_fault(text, layer.fault_source))
        if document.get("pace", "lockstep") == "lockstep" and document.pop("rate", None) and "rate" in layer.values:
            allowed = Sentence("used only in a run with pace realtime")
            faults.found.append(layer.refuse("rate", layer.values["rate"], allowed))
    document["settings"], document["faults"] = settings, faults_given
    with faults.kept():
        document["scenario"] = _find_scenario(document.get("scenario", USUAL_SCENARIO), said.get("scenario"))
        scenario = load_any(document["scenario"], settings, faults_given)
        system = scenario.installed_system
        document.setdefault("controller", scenario.usual_law)
        document.setdefault("arithmetic", system.arithmetic)
        if by := said.get("controller"):
            system.check_law(document["controller"], by.source, by.names.get("controller", "controller"))
    if "memory_store" in document:
        document["memory_store"] = str(Path(document["memory_store"]).resolve())
        with faults.kept():
            _set_number(document, settings, faults_given)
    parameters = memory = None
    with faults.kept():
        parameters = _take_parameters(document, said.get("parameters"))
    with faults.kept():
        memory = _take_memory(document, said.get("memory"))
    faults.raise_all()
    return document, parameters, memory


def _set_number(document: dict[str, Any], settings: list[str], faults_given: list[str]) -> None:
    """Without a number, a run with a memory store is the next one of the store, where runs have numbers.

    :raises InputError: the store cannot be used.
    """
    system = load_any(document["scenario"], settings, faults_given).installed_system
    if system.numbered and "run_number" not in document:
        newest = MemoryStore(Path(document["memory_store"])).read(document["controller"]).newest
        document["run_number"] = 1 if newest is None else newest.last_run + 1


def _find_scenario(name: str, by: Layer | None) -> str:
    try:
        return stable_name(str(by.folder / name) if by is not None and name.endswith(".toml") else name)
    except InputError as error:
        if by is None or by.names is OPTIONS:
            # The original message is clear enough in these cases.
            raise
        raise by.refuse("scenario", name, error.allowed, error.hint) from None


def _take_parameters(document: dict[str, Any], by: Layer | None) -> ParameterSet | None:
    given = document.pop("parameters", None)
    if given is None or by is None:
        return None
    if isinstance(given, Path):
        return load_parameters(given.resolve())
    return parameters_from_json({"law": document.get("controller", USUAL_LAW), **given}, Path(by.source).resolve())


def _take_memory(document: dict[str, Any], by: Layer | None) -> Memory | None:
    given = document.pop("memory", None)
    if given is None or by is None:
        return None
    if isinstance(given, Path):
        return read_memory(given.resolve())
    return memory_from_json(given, Path(by.source).resolve())


def _read_table(path: Path, stored: bool) -> dict[str, Any]:
    """Content of the file.

    :raises InputError: it cannot be read, or is not a table.
    """
    with refuse_unreadable(path, _ALLOWED):
        text = given_text(path)
        document = parse_json(text) if stored else parse_toml(text)
    if not isinstance(document, dict) or (stored and "scenario" not in document):
        raise InputError(path, "", Words("has no JSON object that names a scenario"), _ALLOWED)
    return document
