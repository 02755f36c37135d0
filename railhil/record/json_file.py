"""JSON documents of a run folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from railhil.common.whole_file import whole_file


def json_text(document: dict[str, Any]) -> str:
    """A JSON document as the text of a file."""
    return json.dumps(document, indent=2, allow_nan=False, default=str) + "\n"


def write_json(path: Path, document: dict[str, Any]) -> None:
    """Write a JSON document atomically."""
    with whole_file(path) as draft:
        draft.write_text(json_text(document), encoding="utf-8")
