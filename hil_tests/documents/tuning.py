"""Figures of docs/reference/tuned_parameters.md."""

from __future__ import annotations

from collections.abc import Sequence

from hil_tests.documents import figures
from hil_tests.documents.figures import batch, median, p95, passed, row, tuning_notes

#: In the order of the page, with the digits of each score.
_LAWS = ("ipfc", "ipfc_plus", "ipfc_plus_stop", "tpfc1", "tpfc2", "tdmc", "fuzzy_pid")
_DIGITS = {"itae": 0, "energy_kj": 0, "punctuality_s": 3, "stop_error_m": 3, "comfort": 3}


def shipped() -> Sequence[str]:
    """The law's own parameters and the tuned ones, on runs on which nothing was searched."""
    rows = []
    for law in _LAWS:
        notes = tuning_notes(figures.tuned(law))
        both = batch(law, arithmetic="float64"), batch(law, arithmetic="float64", file=figures.tuned(law))
        cells = [" → ".join(f"{median(run, key):.{digits}f}" for run in both) for key, digits in _DIGITS.items()]
        bounds = ", ".join(f"`{name}`" for name in notes["at_bounds"]) or "-"
        objective = f"{notes['objective_default']:.3f} → {notes['objective_tuned']:.3f}"
        stops = " → ".join(f"{p95(run, 'stop_error_m'):.3f}" for run in both)
        rows.append(row(law, objective, *cells, stops, " → ".join(str(passed(run)) for run in both), bounds))
    return rows
