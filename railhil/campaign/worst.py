"""The runs worth a look: largest errors, runs that did not stop, drove too fast or wrapped, each with its command."""

from __future__ import annotations

import shlex
from typing import Any

import numpy as np
import pyarrow as pa

from railhil.campaign.plan import Entry, Plan
from railhil.campaign.results_table import numbers, row

#: Runs listed per law and error.
_LARGEST = 3
#: Runs listed per law and thing that must not happen; each has its own places, so that none crowds out another.
_BROKEN = 5


def _largest(rows: pa.Table, name: str) -> list[int]:
    """Rows with the largest values, largest first, equal ones by seed; runs without a value left out."""
    values = numbers(rows, name)
    order = np.argsort(-np.nan_to_num(values, nan=-1.0), kind="stable")[:_LARGEST]
    return [int(index) for index in order if not np.isnan(values[index])]


def _broken(rows: pa.Table) -> list[tuple[int, str]]:
    """Rows in which something happened that must not, worst first, equal ones by seed, and what it was."""
    how_bad = {
        "did not stop": np.isnan(numbers(rows, "stop_error_m")).astype(np.float64),
        "overspeed": np.nan_to_num(numbers(rows, "overspeed_mps")),
        "wraps": numbers(rows, "wraps"),
    }
    found = []
    for why, amount in how_bad.items():
        order = np.argsort(-amount, kind="stable")[:_BROKEN]
        found += [(int(index), why) for index in order if amount[index] > 0]
    return found


def worst_runs(plan: Plan, entry: Entry, rows: pa.Table) -> list[dict[str, Any]]:
    """The runs of one law that are worth a look, each once with all its reasons.

    :param rows: of the law, by seed.
    """
    reasons: dict[int, list[str]] = {}
    for name, words in (("stop_error_m", "stop error"), ("punctuality_s", "time error")):
        for rank, index in enumerate(_largest(rows, name), 1):
            reasons.setdefault(index, []).append(f"{words} {rank}")
    for index, why in _broken(rows):
        reasons.setdefault(index, []).append(why)
    found = []
    for index, why_all in reasons.items():
        run = row(rows, index)
        found.append(
            {
                "seed": run["seed"],
                "why": why_all,
                "stop_error_m": run["signed_stop_error_m"],
                "time_error_s": run["signed_time_error_s"],
                "overspeed_mps": run["overspeed_mps"],
                "ended": run["ended"],
                "failures": run["failures"],
                "command": shlex.join(["railhil", "run", *plan.run(entry, run["seed"]).words]),
            }
        )
    return found
