"""Canonical form of a scenario and its SHA-256: the nodes compare it, a certificate records it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from typing import Any


def injected(faults: Sequence[str]) -> list[str]:
    """The faults of a scenario without the keys that only explain and judge them."""
    # Imported here: a run without faults does not load their language, which takes a tenth of a node's start.
    from railhil.faults.language import fault_text, parse

    return [fault_text(parse(text, "faults"), judging=False) for text in faults]


def canonical_text(table: dict[str, Any]) -> str:
    """A table as JSON with sorted keys, no spaces and shortest round-trip floats."""
    return json.dumps(table, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=True)


def text_sha256(table: dict[str, Any]) -> str:
    """SHA-256 (hex) of a table in canonical form."""
    return hashlib.sha256(canonical_text(table).encode("ascii")).hexdigest()
