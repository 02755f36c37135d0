"""Figures of docs/explanation/arithmetic.md."""

from __future__ import annotations

from collections.abc import Sequence

from hil_tests.documents.figures import batch, median

_SCORES = {
    "ITAE": ("itae", 0, ""), "energy": ("energy_kj", 0, " kJ"), "punctuality": ("punctuality_s", 3, " s"),
    "stop error": ("stop_error_m", 3, " m"), "comfort": ("comfort", 3, ""),
}  # fmt: skip


def scores() -> Sequence[str]:
    """Medians in single precision and in float64."""
    runs = [batch("ipfc", arithmetic=arithmetic) for arithmetic in ("float32", "float64")]
    return [
        name + " {:.{n}f} and {:.{n}f}".format(*(median(run, key) for run in runs), n=digits) + unit
        for name, (key, digits, unit) in _SCORES.items()
    ]
