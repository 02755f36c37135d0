"""Canonical form of a scenario of ``ato`` and its SHA-256: the nodes compare it, a certificate records it."""

from __future__ import annotations

import dataclasses
import hashlib
from typing import Any

from railhil.scenarios.model import canonical_text, list_injected_faults, text_sha256
from railhil.systems.ato.scenario.model import Scenario

#: Fields that only explain a scenario, or say how it is run when nothing else is asked for.
_EXPLAINING = ("title", "assumptions", "published", "sha256", "law")


#: Fields that change no frame of a run, only its evaluation.
_JUDGING = ("energy",)


_JUDGING_OF_PLAN = ("stop_error_max_m", "time_error_max_s")


#: Fields that change neither a frame nor a score: regenerated work is told beside the scores.
_BESIDE_OF_TRAIN = ("electric_brake",)


def _remove_defaults(item: Any) -> Any:
    """A dataclass as a table without the fields that have their defaults, so that a field added later, and not used by
    a scenario, does not change its hash."""
    if not dataclasses.is_dataclass(item):
        return [_remove_defaults(entry) for entry in item] if isinstance(item, tuple) else item
    table = {}
    for field in dataclasses.fields(item):
        value = getattr(item, field.name)
        factory = field.default_factory
        default = field.default if factory is dataclasses.MISSING else factory()
        if value != default:
            table[field.name] = _remove_defaults(value)
    return table


def _canonical_table(scenario: Scenario) -> dict[str, Any]:
    table: dict[str, Any] = _remove_defaults(scenario)
    for name in _EXPLAINING:
        table.pop(name, None)
    for name in _BESIDE_OF_TRAIN:
        table["train"].pop(name, None)
    return table


def canonical_json(scenario: Scenario) -> str:
    """JSON of the data that the run uses, with sorted keys, no spaces and shortest round-trip floats."""
    table = _canonical_table(scenario)
    for name in _JUDGING:
        table.pop(name, None)
    for name in _JUDGING_OF_PLAN:
        table["plan"].pop(name, None)
    if "faults" in table:
        table["faults"] = list_injected_faults(scenario.faults)
    return canonical_text(table)


def scenario_sha256(scenario: Scenario) -> str:
    """SHA-256 (hex) of :func:`canonical_json`."""
    return hashlib.sha256(canonical_json(scenario).encode("ascii")).hexdigest()


def judged_sha256(scenario: Scenario) -> str:
    """SHA-256 (hex) of the data that the run uses and is judged by: equal where scores are comparable."""
    return text_sha256(_canonical_table(scenario))
