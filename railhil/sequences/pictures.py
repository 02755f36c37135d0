"""Figures of ``railhil learn``: errors by the number of the run, their distribution, the values that the law keeps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import pyarrow as pa
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter
from numpy.typing import NDArray

from railhil.campaign.rows import column_of
from railhil.common.digits import count_of
from railhil.judge.judging import SequenceMeasure, sequence_measures
from railhil.report.pictures import Picture, stacked
from railhil.report.styles import Style
from railhil.sequences.plan import Plan
from railhil.sequences.summary import tail_runs
from railhil.sequences.table import by_run, memories

Floats: TypeAlias = NDArray[np.float64]
_BINS = 40
#: Figures of a memory that are drawn at most; the table has all values.
_KEPT_MAX = 12


def pictures(plan: Plan, table: pa.Table) -> list[Picture]:
    """All figures.

    :param table: rows of ``results.parquet``.
    """
    runs, found = plan.request.runs, []
    for measure in sequence_measures(plan.scenario, plan.judging):
        values = by_run(table, column_of(measure.criterion), runs)
        if not np.isnan(values).all():
            found += [_curve(measure, values), _histogram(measure, values)]
    return [*found, *_kept(memories(table, runs))]


def _numbers(runs: int) -> Floats:
    return np.arange(1.0, runs + 1.0)


def _known(values: Floats) -> Floats:
    return values[~np.isnan(values)]


def _by_run(values: Floats, figure: Any) -> Floats:
    """A figure of the known values of each run, NaN for a run without any."""
    columns = [_known(column) for column in values.T]
    return np.array([figure(column) if len(column) else math.nan for column in columns])


def _band(axes: Axes, values: Floats, style: Style, label: str) -> None:
    """Mean of each run, and the band in which 90 % of its values are."""
    x = _numbers(values.shape[1])
    low, high = (_by_run(values, lambda column, q=q: np.quantile(column, q)) for q in (0.05, 0.95))
    axes.fill_between(x, low, high, color=style.colour, alpha=0.18, linewidth=0)
    axes.plot(x, _by_run(values, np.mean), color=style.colour, marker="o", markersize=3, linewidth=1.2, label=label)


def _by_number(axes: Axes) -> None:
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set(xlabel="number of the run")


def _curve(measure: SequenceMeasure, values: Floats) -> Picture:
    criterion = measure.criterion
    unit = criterion.unit_typeset

    def errors(axes: Axes) -> None:
        axes.axhspan(-measure.converged, measure.converged, color="0.92")
        _band(axes, values, Style(0), "mean and 90 %")
        axes.set(ylabel=f"{criterion.brief} ({unit})")

    def sizes(axes: Axes) -> None:
        x = _numbers(values.shape[1])
        for number, (name, figure) in enumerate(
            (("mean error", lambda one: np.mean(np.abs(one))), ("rms", lambda one: np.sqrt(np.mean(one**2))))
        ):
            axes.plot(
                x, _by_run(values, figure), color=Style(number).colour, marker="os"[number], markersize=3, label=name
            )
        axes.set(ylabel=f"error ({unit})", yscale="log")
        # The usual labels of such an axis are formulas, which the style of the pictures leaves as they are.
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, place: f"{value:g}"))
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
        axes.yaxis.set_minor_formatter(NullFormatter())

    def shares(axes: Axes) -> None:
        sizes_of = np.nan_to_num(np.abs(values), nan=math.inf)
        for number, limit in enumerate(measure.within):
            inside = 100 * np.mean(sizes_of <= limit, axis=0)
            axes.plot(
                _numbers(values.shape[1]), inside, color=Style(number + 2).colour, marker="D^v"[number % 3],
                markersize=3, label=f"within {limit:g} {criterion.unit}",
            )  # fmt: skip
        axes.set(ylabel="sequences (%)", ylim=(-3, 103))
        _by_number(axes)

    caption = (
        f"{criterion.title.capitalize()} by the number of the run, over {count_of(len(values), 'sequence')}: mean "
        "and the band of 90 %, mean and rms of its magnitude, share of the sequences inside. "
        f"Grey: +-{measure.converged:g} {criterion.unit}."
    )
    return stacked(f"learning-{criterion.key}", f"Learning: {criterion.title}", caption, [errors, sizes, shares])


def _histogram(measure: SequenceMeasure, values: Floats) -> Picture:
    criterion, last = measure.criterion, tail_runs(values.shape[1])
    groups = (("first run", values[:, :1]), (f"last {last} runs", values[:, -last:]))

    def drawn(name: str, group: Floats, number: int) -> Any:
        def draw(axes: Axes) -> None:
            known = _known(group.ravel())
            axes.axvspan(-measure.converged, measure.converged, color="0.92")
            axes.hist(known, bins=_BINS, color=Style(number).colour, alpha=0.75, label=f"{name} ({len(known)})")
            axes.set(ylabel="runs", xlabel=f"{criterion.title} ({criterion.unit_typeset})")

        return draw

    rows = [drawn(name, group, number) for number, (name, group) in enumerate(groups) if len(_known(group.ravel()))]
    caption = f"{criterion.title.capitalize()} of the first run and of the last {last} runs of each sequence."
    return stacked(f"histogram-{criterion.key}", f"Distribution: {criterion.title}", caption, rows)


def _kept(found: Sequence[Sequence[Mapping[str, Any] | None]]) -> list[Picture]:
    """Numbers that the law keeps after each run, without those that are always the same."""
    flat = [[{} if values is None else dict(_leaves("", values)) for values in sequence] for sequence in found]
    names = list(dict.fromkeys(name for sequence in flat for values in sequence for name in values))
    drawn: list[tuple[str, Floats]] = []
    for name in names:
        values = np.array([[one.get(name, math.nan) for one in sequence] for sequence in flat])
        if len(np.unique(_known(values))) > 1:
            drawn.append((name, values))
    if not drawn:
        return []

    def row(name: str, values: Floats) -> Any:
        def draw(axes: Axes) -> None:
            _band(axes, values, Style(1), "mean and 90 %" if name == drawn[0][0] else "")
            axes.set_ylabel(name, fontsize=7)
            _by_number(axes)

        return draw

    left_out = len(drawn) - _KEPT_MAX
    caption = "What the law has left after each run: mean over the sequences, and the band of 90 %."
    caption += f" {left_out} further figures are in results.parquet." if left_out > 0 else ""
    return [stacked("memory", "What the law keeps", caption, [row(*one) for one in drawn[:_KEPT_MAX]])]


def _leaves(name: str, value: Any) -> Any:
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
