"""Distributions of scores over many runs: the share of a law's runs at or below each value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from railhil.charts.figure import Area, Chart, Curve, Figure
from railhil.judge.criteria import Criterion
from railhil.judge.record import Record
from railhil.record.trace import FloatArray
from railhil.report.recorded import law_labels
from railhil.report.styles import Style, styles

#: Points of one curve in the page.
_POINTS = 300
#: Charts beside each other.
_ACROSS = 2
#: Parts of an axis below this share of it have a chart of their own.
_SMALL = 0.125


@dataclass(frozen=True, slots=True)
class Spread:
    """One criterion over the runs of each law and its parameters: values with their sign where they have one, NaN for
    a run without.

    ``limits``: of the scenario, empty if it has none.
    """

    criterion: Criterion
    limits: tuple[float, ...]
    values: Mapping[str, FloatArray]


def limits_of(scenario: Any, criterion: Criterion) -> tuple[float, ...]:
    """The bounds that a scenario allows."""
    return bounds_of(criterion, criterion.limit_in(scenario))


def bounds_of(criterion: Criterion, limit: float | None) -> tuple[float, ...]:
    """The bounds that a limit means for values with their sign."""
    if limit is None:
        return ()
    return (-limit, limit) if criterion.signed is not None else (limit,)


def spreads_of(
    scenario: Any, criteria: Sequence[Criterion], runs: Sequence[Record]
) -> tuple[list[Spread], dict[str, Style]]:
    """The scores of recorded runs by label (:func:`railhil.report.recorded.law_labels`), and a style for each."""
    labels = law_labels(runs)
    laws = {label: run.controller for label, run in zip(labels, runs, strict=True)}

    def values(law: str, criterion: Criterion) -> FloatArray:
        found = [run.score.with_sign(criterion) for label, run in zip(labels, runs, strict=True) if label == law]
        return np.array([np.nan if value is None else value for value in found], dtype=np.float64)

    spreads = [
        Spread(criterion, limits_of(scenario, criterion), {law: values(law, criterion) for law in laws})
        for criterion in criteria
    ]
    return spreads, dict(zip(laws, styles([*laws.values()]), strict=True))


def worst_first(scenario: Any, criteria: Sequence[Criterion], runs: Sequence[Record]) -> list[int]:
    """Places of the runs, worst first: runs that are not trusted or missed a limit, by the size of the miss; equal ones
    stay in their order."""

    def badness(run: Record) -> tuple[bool, bool, float]:
        worst = 0.0
        for criterion in criteria:
            value, limit = run.score.values[criterion.key], criterion.limit_in(scenario)
            if limit is None:
                continue
            if value is None:
                return run.verdict == "INVALID", True, np.inf
            limit = abs(limit) or 1.0
            worst = max(worst, value / limit if criterion.better == "low" else limit / max(value, 1e-9))
        return run.verdict == "INVALID", run.verdict != "PASS", worst

    keys = [badness(run) for run in runs]
    return sorted(range(len(runs)), key=lambda place: keys[place], reverse=True)


def shares(values: FloatArray, points: int = _POINTS) -> tuple[FloatArray, FloatArray]:
    """Points of the distribution function: ascending values, and the share of all runs at or below each, in per cent.

    A run without a value counts at no value.

    :param values: shape (n,).
    :param points: largest number of points; the first and the last are kept.
    """
    known, counts = np.unique(values[np.isfinite(values)], return_counts=True)
    below = 100.0 * np.cumsum(counts) / max(len(values), 1)
    if len(known) > points:
        picked = np.unique(np.linspace(0, len(known) - 1, points).round().astype(int))
        known, below = known[picked], below[picked]
    return known, below


def _allowed(spread: Spread) -> str:
    """The limits in words, empty if there are none."""
    if len(spread.limits) > 1:
        return " to ".join(f"{limit:g}" for limit in spread.limits)
    bound = "at most" if spread.criterion.better == "low" else "at least"
    return "".join(f"{bound} {limit:g}" for limit in spread.limits)


def picture(spreads: Sequence[Spread], looks: Mapping[str, Style]) -> Figure:
    """The distributions, a chart for each score."""
    caption = (
        "Share of the runs whose score is at most the value; dotted: what the scenario allows. Where most runs of a "
        "law lie in a small part of the axis, a further chart shows that part."
    )
    charts = [chart for spread in spreads for chart in _charts(spread, looks)]
    return Figure("distributions", "Distributions of the scores", caption, charts)


def _small_parts(spread: Spread) -> list[tuple[float, float]]:
    """The parts of the axis, each small, in which 90 % of the runs of a law lie; overlapping ones are one."""
    known = [own for values in spread.values.values() if len(own := values[np.isfinite(values)])]
    least, most = (figure([figure(own) for own in known], default=0.0) for figure in (min, max))
    found: list[tuple[float, float]] = []
    for low, high in sorted(np.quantile(own, (0.05, 0.95)).tolist() for own in known):
        if high - low >= _SMALL * (most - least):
            continue
        if found and low <= found[-1][1]:
            before = found.pop()
            low, high = before[0], max(high, before[1])
        found.append((low, high))
    return found


def _charts(spread: Spread, looks: Mapping[str, Style]) -> Iterator[Chart]:
    whole = _chart(spread, looks)
    yield whole
    for low, high in _small_parts(spread):
        margin = (high - low) or 1e-3 * abs(high) or 1e-3
        yield replace(
            whole, y_label=f"runs (%), detail at {(low + high) / 2:.3g}", x_bounds=(low - margin, high + margin)
        )


def _chart(spread: Spread, looks: Mapping[str, Style]) -> Chart:
    criterion = spread.criterion
    curves = []
    for label, values in spread.values.items():
        at, below = shares(values)
        if len(at):
            curves.append(Curve(label, at, below, replace(looks[label].look, marker=""), "%", is_step=True))
    allowed = f"allowed {_allowed(spread)} {criterion.unit}"
    limits = [Area((limit, limit), None, "line", allowed) for limit in spread.limits]
    label = f"{criterion.title} ({criterion.unit_typeset})"
    title = f"runs (%){f', {allowed}' if limits else ''}"
    return Chart(curves, label, title, y_bounds=(0.0, 102.0), areas=limits, height_px=150, share=1 / _ACROSS)
