"""``summary.json``: the statistics of a campaign's runs, for each law and relative to the first law."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from railhil.batch.statistics import CONFIDENCE, Estimate, Share, differences, estimate, share
from railhil.campaign.plan import Entry, Plan
from railhil.campaign.rows import rows_of
from railhil.campaign.worst import failures_of, without_stop, worst_runs
from railhil.common.digits import count_of
from railhil.judge.criteria import DID_NOT_STOP, STOP_ERROR_KEY, STOP_WITHIN_M, Criterion, limit_key, limited
from railhil.judge.judging import Noted
from railhil.scenarios.model import watch_sentence
from railhil.scenarios.scenario_documents import any_judged_sha256
from railhil.study.table import numbers

#: Key and probability of each quantile.
QUANTILES = {"median": 0.5, "p95": 0.95}
#: Summary of a score that does not apply.
_NOTHING: dict[str, Any] = {"value": None, "interval": [None, None]}
_NOTES = [
    'a run without a value (it did not stop) counts as infinitely bad in the quantiles: the text "inf"; '
    'differences: "inf" where only this law has none, "-inf" where only the other has none, 0 where neither has; '
    "null: the score does not apply to this scenario",
    "intervals of quantiles: order statistics (binomial), null where the sample is too small for a bound; "
    "intervals of shares: Clopper-Pearson",
]


def _json(value: float | None) -> float | str | None:
    """JSON has no infinity: use the text ``inf`` or ``-inf``, which float conversions in most languages can read."""
    return value if value is None or math.isfinite(value) else str(value)


def _estimate(found: Estimate) -> dict[str, Any]:
    return {"value": _json(found.value), "interval": [_json(found.low), _json(found.high)]}


def _share(found: Share) -> dict[str, Any]:
    return {"runs": found.count, "share": found.share, "interval": [found.low, found.high]}


def _turned(criterion: Criterion, found: Estimate) -> dict[str, Any]:
    """An estimate with its sign restored, after lower was made better."""
    if criterion.better == "low":
        return _estimate(found)
    ends = (None if end is None else -end for end in (found.high, found.low))
    return _estimate(Estimate(-found.value, *ends))


def _quantiles(plan: Plan, criterion: Criterion, values: NDArray[np.float64]) -> dict[str, Any]:
    """Quantiles from the best run to the worst, so that p95 is a bad run whether lower or higher is better."""
    if not criterion.applies(plan.scenario):
        return dict.fromkeys(QUANTILES, _NOTHING)
    worse = criterion.badness(values)
    return {name: _turned(criterion, estimate(worse, q)) for name, q in QUANTILES.items()}


def _within(values: NDArray[np.float64], limit: float) -> NDArray[np.bool_]:
    """NaN (never stopped) does not count as within."""
    return np.asarray(np.nan_to_num(values, nan=math.inf) <= limit, dtype=np.bool_)


def all_limits(limits: Sequence[Criterion]) -> str:
    """Key of the share of runs inside all limits."""
    return "both" if len(limits) == 2 else "all_limits"


def key_of(criterion: Criterion) -> str:
    """Key of the share of runs inside one limit."""
    return f"{criterion.brief.replace(' ', '_')}_limit"


def _stops(limits: Sequence[Criterion], rows: pa.Table) -> dict[str, Any]:
    """Number of runs that stopped, and within each limit; empty where no limit asks for a stop."""
    if not any(criterion.without == DID_NOT_STOP for criterion in limits):
        return {}
    found: dict[str, Any] = {"not_stopped": int(np.count_nonzero(without_stop(rows, limits)))}
    if STOP_ERROR_KEY in rows.column_names:
        errors_m = numbers(rows, STOP_ERROR_KEY)
        found["stopped_within_m"] = {f"{limit:g}": _share(share(_within(errors_m, limit))) for limit in STOP_WITHIN_M}
    return found


def _kinds(rows: pa.Table, chosen: NDArray[np.bool_]) -> dict[str, int]:
    """Number of the chosen runs that failed in each way."""
    counts = {kind: int(np.count_nonzero(chosen[failed])) for kind, failed in failures_of(rows).items()}
    return {kind: count for kind, count in counts.items() if count}


def _noted(noted: Noted, rows: pa.Table) -> list[dict[str, Any]]:
    """Number of runs with each name, the most first, and the value of largest size among them (None: none has one)."""
    values: dict[str, list[float]] = {}
    for name, value in zip(rows[noted.key].to_pylist(), rows[noted.value_key].to_pylist(), strict=True):
        if name is not None:
            values.setdefault(name, []).append(math.nan if value is None else value)
    found = []
    for name, given in values.items():
        known = [value for value in given if not math.isnan(value)]
        found.append({"name": name, "runs": len(given), noted.value_key: max(known, key=abs, default=None)})
    return sorted(found, key=lambda one: (-one["runs"], one["name"]))


def _law(plan: Plan, entry: Entry, rows: pa.Table) -> dict[str, Any]:
    limits = limited(plan.criteria, plan.scenario)
    inside = {key_of(criterion): criterion.inside(plan.scenario, numbers(rows, criterion.key)) for criterion in limits}
    everyone = np.ones(rows.num_rows, dtype=np.bool_)
    verdicts = np.array(rows["verdict"].to_pylist())
    passed, invalid = verdicts == "PASS", verdicts == "INVALID"
    wraps = rows["wraps"].to_numpy()
    return {
        "controller": entry.law.controller,
        "parameters_sha256": None if entry.parameters is None else entry.parameters.sha256,
        "training_runs": int(np.count_nonzero(rows["training"].to_numpy(zero_copy_only=False))),
        "scores": {
            criterion.key: {"unit": criterion.unit} | _quantiles(plan, criterion, numbers(rows, criterion.key))
            for criterion in plan.criteria
        },
        "inside": {
            **{key: _share(share(hits)) for key, hits in inside.items()},
            all_limits(limits): _share(share(np.logical_and.reduce([everyone, *inside.values()]))),
            "pass": _share(share(passed)),
        },
        # Number of runs that failed in each way; a run may fail in several.
        "failures": _kinds(rows, ~invalid),
        # Runs that say nothing about the controller, and why; without such a run there is no such key.
        **({"invalid": {"runs": int(invalid.sum()), "reasons": _kinds(rows, invalid)}} if invalid.any() else {}),
        **_stops(limits, rows),
        **{one.key: _noted(one, rows) for one in plan.judging.noted},
        **{extra.counted: int(np.count_nonzero(numbers(rows, extra.key) > 0)) for extra in plan.judging.extras},
        "runs_with_wraps": int(np.count_nonzero(wraps)),
        "wraps": int(wraps.sum()),
        "saturations": int(rows["saturations"].to_numpy().sum()),
        "zero_divisions": int(rows["zero_divisions"].to_numpy().sum()),
        "worst": worst_runs(plan, entry, rows),
    }


def _against(plan: Plan, rows: pa.Table, baseline: pa.Table) -> dict[str, Any]:
    """Paired comparison: both laws ran the same seeds, and therefore the same trains; scores that apply."""
    found = {}
    for criterion in (one for one in plan.criteria if one.applies(plan.scenario)):
        ours, theirs = (criterion.badness(numbers(side, criterion.key)) for side in (rows, baseline))
        apart = differences(ours, theirs)
        found[criterion.key] = {
            "unit": criterion.unit,
            "median_difference": _turned(criterion, estimate(apart, 0.5)),
            "better": _share(share(apart < 0)),
            "equal_runs": int(np.count_nonzero(apart == 0)),
        }
    return found


def training_sentence(plan: Plan) -> str | None:
    """The sentence required in every table if parameters are evaluated on runs that were used to find them."""
    seen = {entry.label: len(plan.training(entry)) for entry in plan.entries}
    if not any(seen.values()):
        return None
    laws = ", ".join(f"{label} on {count}" for label, count in seen.items() if count)
    runs = f"{laws} of {count_of(plan.request.runs, 'run')}"
    return f"NOT AN EVALUATION: parameters were tuned or chosen on seeds of this campaign ({runs})"


def summary(plan: Plan, results: pa.Table) -> dict[str, Any]:
    """Content of ``summary.json``, the same for the same runs, however they were computed.

    :param results: the runs of all laws, sorted by law and seed.
    """
    rows = {entry.label: rows_of(results, entry.label) for entry in plan.entries}
    first, *others = (entry.label for entry in plan.entries)
    warnings = [sentence for sentence in (training_sentence(plan), watch_sentence(plan.scenario)) if sentence]
    return {
        "scenario": plan.scenario.name,
        "scenario_sha256": any_judged_sha256(plan.scenario),
        **plan.how,
        "runs": plan.request.runs,
        "first_seed": plan.seeds.start,
        "last_seed": plan.seeds.stop - 1,
        "confidence": CONFIDENCE,
        # Shown in every table.
        "warnings": warnings,
        "watch_weakened": plan.scenario.watch_weakened,
        "notes": _NOTES,
        "limits": {
            limit_key(criterion): criterion.limit_in(plan.scenario)
            for criterion in limited(plan.criteria, plan.scenario)
        },
        "laws": {entry.label: _law(plan, entry, rows[entry.label]) for entry in plan.entries},
        "baseline": first,
        "against_baseline": {label: _against(plan, rows[label], rows[first]) for label in others},
    }
