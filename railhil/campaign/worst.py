"""The runs to examine: largest errors, runs that did not stop, drove too fast or wrapped, each with its command."""

from __future__ import annotations

import shlex
from typing import Any

import numpy as np
import pyarrow as pa

from railhil.campaign.plan import Entry, Plan
from railhil.campaign.results_table import column_of, numbers, row
from railhil.supervisor.criteria import STOP_ERROR, Criterion, limit_key, limited
from railhil.supervisor.judging import Judging

#: Runs listed per law and error.
_LARGEST = 3
#: Runs listed per law and kind of failure; each kind has its own limit, so that none displaces another.
_BROKEN = 5


def _worst(rows: pa.Table, criterion: Criterion) -> list[int]:
    """Rows with the worst values, worst first, equal ones by seed; runs without a value are left out."""
    values = numbers(rows, criterion.key)
    order = np.argsort(-np.nan_to_num(criterion.badness(values), nan=-np.inf), kind="stable")[:_LARGEST]
    return [int(index) for index in order if not np.isnan(values[index])]


def _broken(rows: pa.Table, judging: Judging) -> list[tuple[int, str]]:
    """Rows with a failure, worst first, equal ones by seed, and the kind of failure."""
    how_bad = {
        **(
            {"did not stop": np.isnan(numbers(rows, STOP_ERROR.key)).astype(np.float64)}
            if STOP_ERROR in judging.criteria
            else {}
        ),
        **{extra.name: np.nan_to_num(numbers(rows, extra.key)) for extra in judging.extras},
        "wraps": numbers(rows, "wraps"),
    }
    found = []
    for why, amount in how_bad.items():
        order = np.argsort(-amount, kind="stable")[:_BROKEN]
        found += [(int(index), why) for index in order if amount[index] > 0]
    return found


def worst_runs(plan: Plan, entry: Entry, rows: pa.Table) -> list[dict[str, Any]]:
    """The runs of one law to examine, each once with all its reasons.

    :param rows: rows of the law, by seed.
    """
    reasons: dict[int, list[str]] = {}
    for criterion in limited(plan.criteria):
        for rank, index in enumerate(_worst(rows, criterion), 1):
            reasons.setdefault(index, []).append(f"{criterion.title} {rank}")
    for index, why in _broken(rows, plan.judging):
        reasons.setdefault(index, []).append(why)
    found = []
    for index, why_all in reasons.items():
        run = row(rows, index)
        found.append(
            {
                "seed": run["seed"],
                "why": why_all,
                **{limit_key(criterion): run[column_of(criterion)] for criterion in limited(plan.criteria)},
                **{extra.key: run[extra.key] for extra in plan.judging.extras},
                "ended": run["ended"],
                "failures": run["failures"],
                "command": shlex.join(["railhil", "run", *plan.run(entry, run["seed"]).words]),
            }
        )
    return found
