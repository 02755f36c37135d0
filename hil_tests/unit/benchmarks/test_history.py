"""The history file of the benchmarks: a loss shows, and only against a comparable measurement."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from benchmarks import history
from railhil.common.build import python_build
from railhil.common.errors import InputError

NOW = datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC)


def measured(factor: float, taken_s: float, **machine: Any) -> dict[str, Any]:
    described = {
        "cpu": "A",
        "cores": 2,
        "python": "CPython 3.11",
        "build": "PGO, LTO",
        "railhil_build": "pure",
        "counting": 0,
        "load_1min": 0.5,
        "far_read_ns": 20.0,
    }
    figures = [
        {"name": "factor", "value": factor, "unit": "sim s/s"},
        {"name": "command", "value": taken_s, "unit": "s"},
    ]
    return history.entry({"machine": described | machine, "benchmarks": {"lockstep": {"figures": figures}}}, NOW)


@pytest.mark.parametrize(
    ("factor", "taken_s", "lost"),
    [(100.0, 2.0, []), (95.0, 2.1, []), (50.0, 2.0, ["factor"]), (200.0, 3.0, ["command"])],
)
def test_what_has_become_worse_is_said(tmp_path: Path, factor: float, taken_s: float, lost: list[str]) -> None:
    path = tmp_path / "history.jsonl"
    history.append(path, measured(1000.0, 0.1))
    history.append(path, measured(100.0, 2.0))
    found = history.losses(history.read(path), measured(factor, taken_s))
    assert [line.split(": ")[1] for line in found] == lost
    if "factor" in lost:
        told = (
            "lockstep: factor: 50 sim s/s, was 100 at 2026-01-02T03:04:05+00:00 "
            "(load 0.5, latency 20 ns then, load 0.5, latency 20 ns now)"
        )
        assert found == [told]


@pytest.mark.parametrize(
    "other", [{"cpu": "B"}, {"build": "no PGO, no LTO"}, {"railhil_build": "compiled"}, {"counting": 2}]
)
def test_only_like_is_compared_with_like(other: dict[str, Any]) -> None:
    assert not history.losses([measured(100.0, 2.0, **other)], measured(1.0, 2.0))


def test_a_line_without_the_build_of_railhil_is_read_and_compared_with_none(tmp_path: Path) -> None:
    """As histories were written before it was part of them."""
    path = tmp_path / "history.jsonl"
    older = measured(100.0, 2.0)
    assert older.pop("railhil_build") == "pure"
    history.append(path, older)
    found = history.read(path)
    assert found == [older]
    assert not history.losses(found, measured(1.0, 2.0))


@pytest.mark.parametrize("text", ["nonsense", "{}", '{"figures": 3}', "3"])
def test_another_file_is_refused_in_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "other"
    path.write_text(text)
    with pytest.raises(InputError, match=r"line 1: found .*, allowed a line that --history has written"):
        history.read(path)
    assert history.read(tmp_path / "none") == []
    with pytest.raises(InputError, match="--history"):
        history.append(tmp_path / "no" / "folder", {})


def test_the_build_of_python_is_said() -> None:
    assert python_build("'--enable-optimizations' '--with-lto=full'") == "PGO, LTO"
    assert python_build("'--prefix=/usr'") == "no PGO, no LTO"
    assert python_build("'--enable-shared'", shared=True) == "no PGO, no LTO"
    # Debian's python3 is no program of the shared library whose configuration it tells.
    assert python_build("'--enable-shared' '--prefix=/usr'", shared=False) == "PGO and LTO not told"
