"""Figures of docs/reference/scores.md and docs/explanation/paper_ordering.md."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks.published import alternating_run
from hil_tests.documents.all_laws import NOISE
from hil_tests.documents.figures import LVSHUN, batch, row
from railhil.batch.statistics import estimate
from railhil.scenarios.load import load

_KMH = 3.6


def published() -> Sequence[str]:
    """``python -m benchmarks.published``: an alternating notch on top of IPFC's, until comfort is the paper's."""
    rows = []
    for notches in (0, 1, 2, 3, 4, 6):
        found = alternating_run(load(LVSHUN), notches).score.values
        name = "ipfc" if not notches else f"+-{notches} notch" + (", alternating" if notches == 1 else "")
        itae = found["itae"] or np.inf
        rows.append(
            row(
                name, f"{itae:.0f}", f"{itae / _KMH:.0f}", f"{found['energy_kj']:.0f}", f"{found['punctuality_s']:.3f}",
                f"{found['stop_error_m']:.3f}", f"{found['comfort']:.2f}",
            )
        )  # fmt: skip
    paper = next(one.values for one in load(LVSHUN).published if one.controller == "ipfc")
    return [
        *rows,
        row(
            "ipfc, published", f"{paper['itae']:.0f}", f"{paper['itae']:.0f}", f"{paper['energy_kj']:.0f}",
            f"{paper['punctuality_s']:.3f}", f"{paper['stop_error_m']:.3f}", f"{paper['comfort']:.2f}",
        ),
    ]  # fmt: skip


def noise() -> Sequence[str]:
    """How far the noise alone moves a stop."""
    stops_m = batch("ipfc", seeds=NOISE, perturbed=False).signed["stop_error_m"]
    low, high = np.percentile(stops_m, (1, 99))
    return (f"stops up to {100 * (high - low) / 2:.0f} cm away", f"98 % of {len(NOISE)} seeds")


def energy() -> Sequence[str]:
    """The table of what influences a score: only the row of energy has figures of ours."""
    found = estimate(batch("ipfc", arithmetic="float64", seeds=range(1000, 6000)).values["energy_kj"] / 1000, 0.5)
    assert found.low is not None
    assert found.high is not None
    return (f"over 5000 perturbed runs is {found.value:.2f} MJ [{found.low:.2f}, {found.high:.2f}]",)
