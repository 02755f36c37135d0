"""The scenarios of ``ato``: read from files, written into run folders and read back.

A document has every field of :class:`.model.Scenario`, in SI units, with the names of the dataclasses.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import BaseModel, TypeAdapter, ValidationError

from railhil.common.errors import InputError, Words
from railhil.scenarios.layers import Layers, faults_of_rows
from railhil.scenarios.model import PublishedScore
from railhil.scenarios.system import System
from railhil.systems.ato.scenario.canonical import judged_sha256, scenario_sha256
from railhil.systems.ato.scenario.keys import MEANING, UNITLESS, USUAL
from railhil.systems.ato.scenario.model import Scenario

if TYPE_CHECKING:
    from railhil.scenarios.reference import Key

_ALLOWED = "a scenario that railhil has written"


class TrainScenarios:
    """Scenarios of ``ato``, see :class:`railhil.scenarios.task.ScenarioKind`."""

    #: Meaning of the keys of its files, and those that are changed most often.
    meaning: ClassVar[Mapping[str, str]] = MEANING
    usual: ClassVar[tuple[str, ...]] = USUAL
    #: Class of the scenarios; a system whose runs are longer has a subclass.
    scenario_type: ClassVar[type[Scenario]] = Scenario

    def __init__(self, system: System) -> None:
        self._system = system

    def read(self, layers: Layers) -> Scenario:
        # A record's scenario is complete: readers of records need neither tables of files nor their checks.
        from railhil.systems.ato.scenario.train_files import read_train_scenario

        rows = layers.merge().get("fault", ())
        faults_of = partial(faults_of_rows, rows, self._system, lambda row: layers.origin("fault", row))
        return read_train_scenario(layers, faults_of)

    def document(self, scenario: Scenario) -> dict[str, Any]:
        return document(scenario)

    def restore(self, fields: dict[str, Any], file: Path) -> Scenario:
        scenario = scenario_of(fields, file, self.scenario_type)
        return replace(scenario, sha256=scenario_sha256(scenario))

    def judged_sha256(self, scenario: Scenario) -> str:
        return judged_sha256(scenario)

    def list_keys(self) -> list[Key]:
        from railhil.scenarios.reference import keys

        return keys(self.file_type, self.meaning, UNITLESS)

    def usual_keys(self) -> list[Key]:
        return [key for key in self.list_keys() if key.name in self.usual]

    @property
    def file_type(self) -> type[BaseModel]:
        from railhil.systems.ato.scenario.schema import ScenarioFile

        return ScenarioFile


#: By class of the scenario, made at first use.
_ADAPTERS: dict[type[Any], TypeAdapter[Scenario]] = {}


def document(scenario: Scenario) -> dict[str, Any]:
    """Every field of a scenario of ``ato``, as JSON-compatible values."""
    return {**dataclasses.asdict(scenario), "published": [row.as_table() for row in scenario.published]}


def scenario_of(fields: dict[str, Any], file: Path, kind: type[Any] = Scenario) -> Scenario:
    """The scenario of a document; fields added after it was written have their defaults.

    :param file: for the error message.
    :param kind: class of the scenario.
    :raises InputError: a field is missing, unknown or of another kind.
    """
    adapter = _ADAPTERS.get(kind) or _ADAPTERS.setdefault(kind, TypeAdapter(kind))
    try:
        scenario = adapter.validate_json(
            json.dumps(fields | {"published": _split_published(fields.get("published", []))})
        )
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(file, key, Words(first["msg"]), _ALLOWED) from None
    unknown = _find_unknown(fields, document(scenario))
    if unknown:
        raise InputError(file, unknown, Words("a key that no scenario has"), _ALLOWED)
    return scenario


def _split_published(rows: object) -> object:
    """Published rows with their values separated from the law; anything that is not such a row is left for the
    check."""
    if not isinstance(rows, list):
        return rows
    apart = []
    for row in rows:
        known = isinstance(row, dict) and "controller" in row
        apart.append(dataclasses.asdict(PublishedScore.of(row)) if known else row)
    return apart


def _find_unknown(given: object, known: object, key: str = "") -> str:
    """First key of ``given`` that is not in ``known``; empty when there is none."""
    if isinstance(given, dict) and isinstance(known, dict):
        for name, value in given.items():
            inner = f"{key}.{name}".lstrip(".")
            if name not in known:
                return inner
            if found := _find_unknown(value, known[name], inner):
                return found
    elif isinstance(given, list) and isinstance(known, (list, tuple)):
        for index, (value, other) in enumerate(zip(given, known, strict=True)):
            if found := _find_unknown(value, other, f"{key}.{index}"):
                return found
    return ""
