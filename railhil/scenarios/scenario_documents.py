"""Resolved scenarios as JSON: in run folders, and of earlier versions for their records.

A record's scenario is never read from the shipped files, because these may have changed since. The system defines the
content of a document (:class:`railhil.scenarios.task.ScenarioKind`).
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from railhil.common.errors import InputError
from railhil.common.user_files import given_json
from railhil.scenarios.layers import DATA
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import DEFAULT, system_named

if TYPE_CHECKING:
    from railhil.systems.ato.scenario.model import Scenario

#: Name in a run folder.
SCENARIO = "scenario.json"
#: Fields that version 0.1.0 excluded from its hash, which covered all others, whether used by the run or not.
_EXPLAINING_0_1_0 = ("title", "assumptions", "published")
_ALLOWED = "a scenario that railhil has written"


def any_document(scenario: AnyScenario) -> dict[str, Any]:
    """Every field of a scenario of any system, as JSON-compatible values."""
    return scenario.installed_system.scenario_kind.document(scenario)


def any_judged_sha256(scenario: AnyScenario) -> str:
    """Hash of the data that a run of any system uses and is judged by: equal where scores are comparable."""
    return scenario.installed_system.scenario_kind.judged_sha256(scenario)


def content_sha256(scenario: AnyScenario) -> str:
    """Hash of the data that a run of any system uses, without the scenario's name."""
    kind = scenario.installed_system.scenario_kind
    return kind.restore(kind.document(scenario) | {"name": "unnamed"}, Path(SCENARIO)).sha256


def nominal_sha256(scenario: AnyScenario) -> str:
    """``sha256`` of the same scenario without faults."""
    kind = scenario.installed_system.scenario_kind
    return kind.restore(kind.document(scenario) | {"faults": []}, Path(SCENARIO)).sha256


def read_scenario(path: Path) -> AnyScenario:
    """The scenario in ``scenario.json`` of a run folder.

    :raises InputError: it cannot be read, is not a scenario, or does not match its own hash.
    """
    fields = given_json(path, _ALLOWED)
    system = system_named(str(fields.get("system", DEFAULT)), path)
    scenario = system.scenario_kind.restore(fields, path)
    if fields.get("sha256") != scenario.sha256:
        raise InputError(path, "sha256", fields.get("sha256"), f"{scenario.sha256}: a scenario that nobody changed")
    return scenario


def find_earlier_scenario(sha256: str) -> Scenario | None:
    """The shipped scenario of an earlier version that has this hash; None when there is none."""
    for path in sorted((DATA / "history").glob("*.json")):
        fields = json.loads(path.read_text(encoding="utf-8")).get(sha256)
        if fields is not None:
            found = cast("Scenario", system_named(DEFAULT).scenario_kind.restore(fields, path))
            return replace(found, sha256=sha256)
    return None


def sha256_0_1_0(fields: dict[str, Any]) -> str:
    """Hash of a document as version 0.1.0 computed it."""
    used = {name: value for name, value in fields.items() if name not in (*_EXPLAINING_0_1_0, "sha256")}
    text = json.dumps(used, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=True)
    return hashlib.sha256(text.encode("ascii")).hexdigest()
