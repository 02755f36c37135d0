"""Figures of ``railhil learn``: errors by the number of the run, their distribution, the values that the law keeps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from railhil.campaign.rows import column_of
from railhil.charts.figure import Area, Band, Chart, Curve, Figure, Look
from railhil.common.digits import count_of
from railhil.judge.judging import SequenceMeasure, sequence_measures
from railhil.sequences.plan import Plan
from railhil.sequences.summary import tail_runs
from railhil.sequences.table import by_run, memories

Floats: TypeAlias = NDArray[np.float64]
_BINS = 40
#: Figures of a memory that are drawn at most; the table has all values.
_KEPT_MAX = 12
_NUMBER = "number of the run"
#: A word by which charts over the number of the run share cursor and zoom.
_SYNC = "run"


def figures(plan: Plan, table: pa.Table) -> list[Figure]:
    """All figures.

    :param table: rows of ``results.parquet``.
    """
    runs, found = plan.request.runs, []
    for measure in sequence_measures(plan.scenario, plan.judging):
        values = by_run(table, column_of(measure.criterion), runs)
        if not np.isnan(values).all():
            found += [_learning(measure, values), _histogram(measure, values)]
    return [*found, *_kept(memories(table, runs))]


def _numbers(values: Floats) -> Floats:
    return np.arange(1.0, values.shape[1] + 1.0)


def _known(values: Floats) -> Floats:
    return values[~np.isnan(values)]


def _by_run(values: Floats, figure: Callable[[Floats], Any]) -> Floats:
    """A figure of the known values of each run, NaN for a run without any."""
    columns = [_known(column) for column in values.T]
    return np.array([figure(column) if len(column) else math.nan for column in columns])


def _spread(values: Floats, label: str, **chart: Any) -> Chart:
    """Mean of each run, and the band in which 90 % of its values are.

    :param label: of the values, with their unit.
    """
    low, high = (_by_run(values, lambda column, q=q: np.quantile(column, q)) for q in (0.05, 0.95))  # type: ignore[misc]
    band = Band("90 %", _numbers(values), low, high, Look("0"))
    mean = Curve("mean", _numbers(values), _by_run(values, np.mean), Look("0"))
    return Chart([mean], y_label=label, bands=[band], sync=_SYNC, **chart)


def _learning(measure: SequenceMeasure, values: Floats) -> Figure:
    criterion, numbers = measure.criterion, _numbers(values)
    limits = (-measure.converged, measure.converged)
    converged = f"+-{measure.converged:g} {criterion.unit}"
    sizes = {"mean error": lambda one: np.mean(np.abs(one)), "rms": lambda one: np.sqrt(np.mean(one**2))}
    inside = np.nan_to_num(np.abs(values), nan=math.inf)
    charts = [
        _spread(
            values,
            f"{criterion.brief} ({criterion.unit_typeset})",
            areas=[Area(None, limits, "allowed", converged, label=converged)],
        ),
        Chart(
            [Curve(name, numbers, _by_run(values, figure)) for name, figure in sizes.items()],
            y_label=f"error ({criterion.unit_typeset})",
            sync=_SYNC,
        ),
        Chart(
            [
                Curve(f"within {limit:g} {criterion.unit}", numbers, 100 * np.mean(inside <= limit, axis=0), unit="%")
                for limit in measure.within
            ],
            _NUMBER,
            "sequences (%)",
            y_bounds=(0.0, 102.0),
            sync=_SYNC,
        ),
    ]
    caption = (
        f"{criterion.title.capitalize()} by the number of the run, over {count_of(len(values), 'sequence')}: mean "
        "and the band of 90 %, mean and rms of its magnitude, share of the sequences inside."
    )
    return Figure(f"learning-{criterion.key}", f"Learning: {criterion.title}", caption, charts)


def _histogram(measure: SequenceMeasure, values: Floats) -> Figure:
    criterion, last = measure.criterion, tail_runs(values.shape[1])
    groups = {"first run": _known(values[:, 0]), f"last {last} runs": _known(values[:, -last:])}
    limits = Area((-measure.converged, measure.converged), None, "allowed")
    charts = []
    for place, (name, known) in enumerate((name, known) for name, known in groups.items() if len(known)):
        counts, edges = np.histogram(known, _BINS)
        runs = np.append(counts, 0).astype(np.float64)
        bars = Curve(f"{name} ({len(known)})", edges, runs, Look(str(place)), is_step=True, is_filled=True)
        charts.append(Chart([bars], f"{criterion.title} ({criterion.unit_typeset})", "runs", areas=[limits]))
    caption = f"{criterion.title.capitalize()} of the first run and of the last {last} runs of each sequence."
    return Figure(f"histogram-{criterion.key}", f"Distribution: {criterion.title}", caption, charts)


def _kept(found: Sequence[Sequence[Mapping[str, Any] | None]]) -> list[Figure]:
    """Numbers that the law keeps after each run, without those that are always the same."""
    flat = [[{} if values is None else dict(_leaves("", values)) for values in sequence] for sequence in found]
    names = dict.fromkeys(name for sequence in flat for values in sequence for name in values)
    arrays = {name: np.array([[one.get(name, math.nan) for one in sequence] for sequence in flat]) for name in names}
    drawn = [(name, values) for name, values in arrays.items() if len(np.unique(_known(values))) > 1]
    if not drawn:
        return []
    left_out = len(drawn) - _KEPT_MAX
    caption = "What the law has left after each run: mean over the sequences, and the band of 90 %."
    caption += f" {left_out} further figures are in results.parquet." if left_out > 0 else ""
    charts = [_spread(values, name, x_label=_NUMBER, share=0.5) for name, values in drawn[:_KEPT_MAX]]
    return [Figure("memory", "What the law keeps", caption, charts)]


def _leaves(name: str, value: Any) -> Iterator[tuple[str, float]]:
    """Numbers in nested values, each with its path; elements of a list by their place."""
    if isinstance(value, bool) or value is None:
        return
    if isinstance(value, int | float):
        yield name, float(value)
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _leaves(f"{name}.{key}" if name else str(key), inner)
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from _leaves(f"{name}[{place}]", inner)
