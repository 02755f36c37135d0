"""Damaged certificate.json and score.json: one line with file and key."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from railhil.common.errors import InputError
from railhil.record.documents import read_certificate, read_score

_WHOLE = {
    "certificate.json": {"scenario": "lvshun_tieshan", "seed": 7, "parameters": None, "machine": {"any": "thing"}},
    "score.json": {"telemetry": None, "run": {"sim_time_s": 195.0, "wall_time_s": 3}, "verdict": "PASS"},
}


@pytest.mark.parametrize(
    ("name", "key", "value", "message"),
    [
        ("certificate.json", "parameters", {"sha256": "00", "values": {}, "training": {"scenario": "s", "seeds": None}},
         "certificate.json: parameters.training.seeds: found None, allowed an array"),
        ("certificate.json", "parameters", {"sha256": "00", "values": [1]},
         "certificate.json: parameters.values: found [1], allowed a table"),
        ("score.json", "jitter", {"p50_ms": "x"}, "score.json: jitter.p50_ms: found 'x', allowed a number"),
        ("score.json", "telemetry", {"source": 1}, "score.json: telemetry.source: found 1, allowed a text"),
        ("score.json", "telemetry", 3, "score.json: telemetry: found 3, allowed a table"),
        ("score.json", "run", {"sim_time_s": 1e999, "wall_time_s": 3},
         "score.json: run.sim_time_s: found inf, allowed a finite number"),
        ("score.json", None, "{", "score.json: cannot be read"),
        ("score.json", None, "[]", "score.json: has no JSON object, expected"),
    ],
)  # fmt: skip
def test_damaged_documents_are_one_line(
    tmp_path: Path, name: str, key: str | None, value: object, message: str
) -> None:
    read: Callable[[Path], object] = {"certificate.json": read_certificate, "score.json": read_score}[name]
    assert read(tmp_path) is None
    whole = _WHOLE[name]
    (tmp_path / name).write_text(json.dumps(whole))
    assert read(tmp_path) == whole
    (tmp_path / name).write_text(str(value) if key is None else json.dumps({**whole, key: value}))
    with pytest.raises(InputError) as caught:
        read(tmp_path)
    assert message in str(caught.value)
