"""``summary.json`` of ``railhil learn``: measures by the number of the run and over the last runs, runs to converge.

Errors are magnitudes. A run without a value (the train did not stop) is outside every limit and infinitely bad in the
quantiles. Means are over the runs with a value, and their number is given.
"""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from railhil.batch.statistics import at_most
from railhil.campaign.rows import column_of
from railhil.judge.criteria import limit_key
from railhil.judge.judging import SequenceMeasure, sequence_measures
from railhil.sequences.plan import Plan
from railhil.sequences.table import by_run

Floats: TypeAlias = NDArray[np.float64]
#: The last runs, over which the figures are taken once the law has learned: this share of a sequence.
_TAIL = 1 / 3


def tail_runs(runs: int) -> int:
    """Number of last runs of a sequence: a third of it, at least one."""
    return max(1, round(runs * _TAIL))


def runs_to_converge(errors: Floats, limit: float, in_a_row: int) -> Floats:
    """First of so many successive runs inside the limit, counted from 1; infinite for a sequence without such runs.

    :param errors: magnitudes, shape (sequences, runs), NaN where a run has none.
    :returns: shape (sequences,).
    """
    inside = np.nan_to_num(errors, nan=math.inf) <= limit
    if inside.shape[1] < in_a_row:
        return np.full(len(inside), math.inf)
    windows = np.asarray(np.lib.stride_tricks.sliding_window_view(inside, in_a_row, axis=1).all(axis=2))
    return np.where(np.any(windows, axis=1), np.argmax(windows, axis=1) + 1.0, math.inf)


def spread(values: Floats, within: tuple[float, ...]) -> dict[str, Any]:
    """Figures of some runs.

    :param values: with their sign if they have one, any shape, NaN where a run has none.
    """
    flat = values.ravel()
    known, sizes = flat[~np.isnan(flat)], np.nan_to_num(np.abs(flat), nan=math.inf)
    return {
        "runs": len(flat),
        "with_a_value": len(known),
        "mean": float(np.mean(known)) if len(known) else None,
        "mean_error": float(np.mean(np.abs(known))) if len(known) else None,
        "rms": float(np.sqrt(np.mean(known**2))) if len(known) else None,
        "median_error": _quantile(sizes, 0.5),
        "p95": _quantile(sizes, 0.95),
        "within": {f"{limit:g}": float(np.mean(sizes <= limit)) for limit in within},
    }


def _quantile(values: Floats, q: float) -> float | None:
    """See :func:`at_most`; None: infinite, or there is none."""
    if not len(values):
        return None
    found = at_most(values, q)
    return found if math.isfinite(found) else None


def _converged(errors: Floats, measure: SequenceMeasure) -> dict[str, Any]:
    runs = runs_to_converge(errors, measure.converged, measure.in_a_row)
    return {
        "limit": measure.converged,
        "in_a_row": measure.in_a_row,
        "sequences": int(np.isfinite(runs).sum()),
        "median": _quantile(runs, 0.5),
        "p90": _quantile(runs, 0.9),
    }


def _measure(values: Floats, measure: SequenceMeasure) -> dict[str, Any]:
    """:param values: shape (sequences, runs)."""
    runs = values.shape[1]
    return {
        "title": measure.criterion.title,
        "unit": measure.criterion.unit,
        "by_run": [{"run": number + 1} | spread(values[:, number], measure.within) for number in range(runs)],
        "last": {"of": tail_runs(runs)} | spread(values[:, -tail_runs(runs) :], measure.within),
        "converged": _converged(np.abs(values), measure),
    }


def _counts(table: pa.Table, column: str) -> dict[str, int]:
    """Number of occurrences of each text in a column; lists are counted by their items."""
    found: dict[str, int] = {}
    for value in table[column].to_pylist():
        for text in value if isinstance(value, list) else [value]:
            found[str(text)] = found.get(str(text), 0) + 1
    return dict(sorted(found.items()))


def summary(plan: Plan, table: pa.Table) -> dict[str, Any]:
    """Content of ``summary.json``."""
    asked = plan.request
    measures = {
        limit_key(one.criterion): _measure(by_run(table, column_of(one.criterion), asked.runs), one)
        for one in sequence_measures(plan.scenario, plan.judging)
    }
    return {
        "scenario": plan.scenario.name,
        "law": plan.law.label,
        "arithmetic": plan.law.arithmetic,
        "perturbed": plan.perturbed,
        "runs": asked.runs,
        "sequences": asked.sequences,
        "seed": asked.seed,
        "last_seed": plan.seeds[-1],
        "measures": measures,
        "verdicts": _counts(table, "verdict"),
        "memory_used": _counts(table, "memory_used"),
        "memory_refused": _counts(table, "memory_refused"),
        "not_learned": int(table["memory_after_sha256"].null_count),
        "runs_with_wraps": int(np.count_nonzero(table["wraps"].to_numpy())),
    }
