"""Resolved scenarios as JSON: those in run folders, and those of earlier versions for their records.

A record's scenario is never read from the shipped files, because these may have changed since. The document has
every field of :class:`railhil.scenarios.model.Scenario`, in SI units, with the names of the dataclasses.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from railhil.common.errors import InputError, Words
from railhil.common.user_files import given_text
from railhil.scenarios.layers import DATA
from railhil.scenarios.model import AnyScenario, PublishedScore, Scenario
from railhil.scenarios.system import DEFAULT, system_named

#: Name in a run folder.
SCENARIO = "scenario.json"
#: Fields that version 0.1.0 excluded from its hash, which covered all others, whether used by the run or not.
_EXPLAINING_0_1_0 = ("title", "assumptions", "published")
_ALLOWED = "a scenario that railhil has written"


@cache
def _adapter() -> TypeAdapter[Scenario]:
    return TypeAdapter(Scenario)


def document(scenario: Scenario) -> dict[str, Any]:
    """Every field of a scenario of ``ato``, as JSON-compatible values."""
    return {**dataclasses.asdict(scenario), "published": [row.as_table() for row in scenario.published]}


def scenario_of(fields: dict[str, Any], file: Path) -> Scenario:
    """The scenario of a document; fields added after it was written have their defaults.

    :param file: for the error message.
    :raises InputError: a field is missing, unknown or of another kind.
    """
    try:
        scenario = _adapter().validate_json(json.dumps(fields | {"published": _published(fields.get("published", []))}))
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(file, key, Words(first["msg"]), _ALLOWED) from None
    unknown = _unknown(fields, document(scenario))
    if unknown:
        raise InputError(file, unknown, Words("a key that no scenario has"), _ALLOWED)
    return scenario


def _published(rows: object) -> object:
    """Published rows with their values separated from the law; anything that is not such a row is left for the
    check."""
    if not isinstance(rows, list):
        return rows
    apart = []
    for row in rows:
        known = isinstance(row, dict) and "controller" in row
        apart.append(dataclasses.asdict(PublishedScore.of(row)) if known else row)
    return apart


def _unknown(given: object, known: object, key: str = "") -> str:
    """First key of ``given`` that is not in ``known``; empty when there is none."""
    if isinstance(given, dict) and isinstance(known, dict):
        for name, value in given.items():
            inner = f"{key}.{name}".lstrip(".")
            if name not in known:
                return inner
            if found := _unknown(value, known[name], inner):
                return found
    elif isinstance(given, list) and isinstance(known, (list, tuple)):
        for index, (value, other) in enumerate(zip(given, known, strict=True)):
            if found := _unknown(value, other, f"{key}.{index}"):
                return found
    return ""


def any_document(scenario: AnyScenario) -> dict[str, Any]:
    """Every field of a scenario of any system, as JSON-compatible values."""
    system = system_named(scenario.system)
    fields: dict[str, Any] = system.part("scenarios")(system).document(scenario)
    return fields


def any_judged_sha256(scenario: AnyScenario) -> str:
    """Hash of what a run of any system uses and what it is judged by: equal where scores are comparable."""
    system = system_named(scenario.system)
    return str(system.part("scenarios")(system).judged_sha256(scenario))


def content_sha256(scenario: AnyScenario) -> str:
    """Hash of what a run of any system uses, whatever the scenario is called."""
    system = system_named(scenario.system)
    kind = system.part("scenarios")(system)
    unnamed = kind.stored(kind.document(scenario) | {"name": "unnamed"}, Path(SCENARIO))
    return str(unnamed.sha256)


def read_scenario(path: Path) -> AnyScenario:
    """The scenario in ``scenario.json`` of a run folder.

    :raises InputError: it cannot be read, is not a scenario, or does not match its own hash.
    """
    try:
        fields = json.loads(given_text(path))
    except OSError as error:
        raise InputError(path, "file", Words((error.strerror or str(error)).lower()), _ALLOWED) from None
    except (ValueError, RecursionError):
        raise InputError(path, "file", Words("no JSON document"), _ALLOWED) from None
    if not isinstance(fields, dict):
        raise InputError(path, "file", Words("no JSON object"), _ALLOWED)
    system = system_named(str(fields.get("system", DEFAULT)), path)
    scenario: AnyScenario = system.part("scenarios")(system).stored(fields, path)
    if fields.get("sha256") != scenario.sha256:
        raise InputError(path, "sha256", fields.get("sha256"), f"{scenario.sha256}: a scenario that nobody changed")
    return scenario


def earlier_scenario(sha256: str) -> Scenario | None:
    """The shipped scenario of an earlier version that has this hash; None when there is none."""
    for path in sorted((DATA / "history").glob("*.json")):
        fields = json.loads(path.read_text(encoding="utf-8")).get(sha256)
        if fields is not None:
            return scenario_of({**fields, "sha256": sha256}, path)
    return None


def sha256_0_1_0(fields: dict[str, Any]) -> str:
    """Hash of a document as version 0.1.0 computed it."""
    used = {name: value for name, value in fields.items() if name not in (*_EXPLAINING_0_1_0, "sha256")}
    text = json.dumps(used, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=True)
    return hashlib.sha256(text.encode("ascii")).hexdigest()
