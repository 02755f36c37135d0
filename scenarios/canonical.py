"""Canonical form of a scenario and its SHA-256: the nodes compare it, a certificate records it."""

from __future__ import annotations

import dataclasses
import hashlib
import json

from railhil.scenarios.model import Scenario

#: Fields that only explain a scenario; changing them does not change a run.
_EXPLAINING = ("title", "assumptions", "published", "sha256")


def canonical_json(scenario: Scenario) -> str:
    """JSON with sorted keys, no spaces and shortest round-trip floats, without the explaining fields."""
    fields = dataclasses.asdict(scenario)
    for name in _EXPLAINING:
        del fields[name]
    return json.dumps(fields, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=True)


def scenario_sha256(scenario: Scenario) -> str:
    """SHA-256 (hex) of :func:`canonical_json`."""
    return hashlib.sha256(canonical_json(scenario).encode("ascii")).hexdigest()
