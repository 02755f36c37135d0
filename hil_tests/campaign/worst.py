"""The runs worth a look: largest errors, and every run that did not stop or drove too fast, each with its command."""

from __future__ import annotations

import shlex
from typing import Any

import numpy as np
import pyarrow as pa

from hil_tests.campaign.plan import Entry, Plan
from hil_tests.campaign.table import numbers, row

#: Runs listed per law and error; and of those that did not stop or drove too fast.
_LARGEST = 3
_BROKEN = 10


def rerun_words(plan: Plan, entry: Entry, seed: int) -> list[str]:
    """Arguments of ``railhil`` that make one run of a campaign on the full bench."""
    request = plan.request
    words = ["run", request.scenario, "--perturbed", "--seed", str(seed), "--controller", entry.law]
    words += ["--arithmetic", request.arithmetic, "--indexing", request.indexing]
    return words + ([] if entry.parameters is None else ["--parameters", str(entry.parameters.source)])


def _largest(rows: pa.Table, name: str) -> list[int]:
    """Rows with the largest values, largest first, equal ones by seed; runs without a value left out."""
    values = numbers(rows, name)
    order = np.argsort(-np.nan_to_num(values, nan=-1.0), kind="stable")[:_LARGEST]
    return [int(index) for index in order if not np.isnan(values[index])]


def _broken(rows: pa.Table) -> list[tuple[int, str]]:
    """Rows that did not stop, then those that drove too fast, fastest first, and which of the two."""
    over = np.nan_to_num(numbers(rows, "overspeed_mps"))
    unstopped = np.flatnonzero(np.isnan(numbers(rows, "stop_error_m")))
    fast = [int(index) for index in np.argsort(-over, kind="stable") if over[index] > 0]
    return [(int(index), "did not stop") for index in unstopped] + [(index, "overspeed") for index in fast]


def worst_runs(plan: Plan, entry: Entry, rows: pa.Table) -> list[dict[str, Any]]:
    """The runs of one law that are worth a look, each once with all its reasons.

    :param rows: of the law, by seed.
    """
    reasons: dict[int, list[str]] = {}
    for name, words in (("stop_error_m", "stop error"), ("punctuality_s", "time error")):
        for rank, index in enumerate(_largest(rows, name), 1):
            reasons.setdefault(index, []).append(f"{words} {rank}")
    taken: set[int] = set()
    for index, why in _broken(rows):
        if index in taken or len(taken) < _BROKEN:
            taken.add(index)
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
                "command": shlex.join(["railhil", *rerun_words(plan, entry, run["seed"])]),
            }
        )
    return found
