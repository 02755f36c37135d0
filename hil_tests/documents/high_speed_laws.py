"""Figures of docs/explanation/high_speed_laws.md."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hil_tests.documents.figures import document, row

_LAWS = ("pid", "gpc", "elm_ngpc", "delay_gpc")


def single_precision() -> Sequence[str]:
    """Commands in float32 and in float64 over a whole journey."""
    rows = []
    for law in _LAWS:
        found = document("audit", "jinan_xuzhou", "--controller", law, "--arithmetic", "float32", "--runs", "0")
        assert found["met"]
        codes = found["commands"]["u"]
        apart = next(one["maximum"] for one in found["errors"] if one["name"] == "accel[0]")
        shown = np.format_float_positional(float(f"{apart:.2g}"))
        rows.append(row(f"`{law}`", shown, f"{100 * codes['equal_share']:.2f} %"))
    return rows
