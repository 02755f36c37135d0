"""The runs to examine: largest errors, every kind of failure, runs that drove too fast or wrapped, with commands."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from railhil.campaign.plan import Entry, Plan
from railhil.campaign.rows import column_of
from railhil.judge.criteria import DID_NOT_STOP, Criterion, limit_key, limited
from railhil.judge.judging import Judging
from railhil.study.table import numbers, row

#: Runs listed per law and error.
_LARGEST = 3
#: Runs listed per law and kind of failure; each kind has its own limit, so that none displaces another.
_BROKEN = 5
_NUMBER = re.compile(r"(?<![\w.])[-+]*\d[\d.]*(?:e[-+]?\d+)?(?!\w)")


def _worst(rows: pa.Table, criterion: Criterion) -> list[int]:
    """Rows with the worst values, worst first, equal ones by seed; runs without a value are left out."""
    values = numbers(rows, criterion.key)
    order = np.argsort(-np.nan_to_num(criterion.badness(values), nan=-np.inf), kind="stable")[:_LARGEST]
    return [int(index) for index in order if not np.isnan(values[index])]


def without_stop(rows: pa.Table, criteria: Sequence[Criterion]) -> NDArray[np.bool_]:
    """The rows without a value of a criterion with a limit because the train did not stop."""
    stops = [criterion for criterion in limited(criteria) if criterion.without == DID_NOT_STOP]
    missing = [np.isnan(numbers(rows, criterion.key)) for criterion in stops]
    return np.any(missing, axis=0) if missing else np.zeros(rows.num_rows, dtype=np.bool_)


def kind_of(failure: str) -> str:
    """The failure without its numbers: `stop error N m, allowed N m`."""
    return _NUMBER.sub("N", failure)


def failures_of(rows: pa.Table) -> dict[str, list[int]]:
    """The rows with each kind of failure, by kind in the order of their first appearance."""
    found: dict[str, list[int]] = {}
    for index, failures in enumerate(rows["failures"].to_pylist()):
        for kind in dict.fromkeys(map(kind_of, failures)):
            found.setdefault(kind, []).append(index)
    return found


def _broken(rows: pa.Table, judging: Judging, criteria: Sequence[Criterion]) -> list[tuple[int, str]]:
    """Rows with a failure, worst first, equal ones by seed, and the kind of failure."""
    how_bad = {
        DID_NOT_STOP: without_stop(rows, criteria).astype(np.float64),
        **{extra.name: np.nan_to_num(numbers(rows, extra.key)) for extra in judging.extras},
        "wraps": numbers(rows, "wraps"),
    }
    found = []
    for why, amount in how_bad.items():
        order = np.argsort(-amount, kind="stable")[:_BROKEN]
        found += [(int(index), why) for index in order if amount[index] > 0]
    return found


def worst_runs(plan: Plan, entry: Entry, rows: pa.Table) -> list[dict[str, Any]]:
    """The runs of one law to examine, each once with all its reasons; up to five of every kind of failure.

    :param rows: rows of the law, by seed.
    """
    reasons: dict[int, list[str]] = {}
    criteria = limited(plan.criteria, plan.scenario)
    for criterion in criteria:
        for rank, index in enumerate(_worst(rows, criterion), 1):
            reasons.setdefault(index, []).append(f"{criterion.title} {rank}")
    for index, why in _broken(rows, plan.judging, criteria):
        reasons.setdefault(index, []).append(why)
    for failed in failures_of(rows).values():
        listed = sum(index in reasons for index in failed)
        for index in [index for index in failed if index not in reasons][: max(0, _BROKEN - listed)]:
            reasons[index] = ["failed"]
    found = []
    for index, why_all in reasons.items():
        run = row(rows, index)
        found.append(
            {
                "seed": run["seed"],
                "why": why_all,
                **{limit_key(criterion): run[column_of(criterion)] for criterion in criteria},
                **{extra.key: run[extra.key] for extra in plan.judging.extras},
                **{key: run[key] for one in plan.judging.noted for key in (one.key, one.value_key)},
                "ended": run["ended"],
                **({"verdict": "INVALID"} if run["verdict"] == "INVALID" else {}),
                "failures": run["failures"],
                "command": shlex.join(["railhil", "run", *plan.run(entry, run["seed"]).words]),
            }
        )
    return found
