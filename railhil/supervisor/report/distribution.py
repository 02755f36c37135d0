"""Distributions of scores over many runs: what share of a law's runs is at most at each value."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from railhil.common.plain_text import plain
from railhil.supervisor.criteria import Criterion
from railhil.supervisor.report.figures import Picture, svg
from railhil.supervisor.report.panels import drawing
from railhil.supervisor.report.recorded import RecordedRun, law_labels
from railhil.supervisor.report.styles import Style, styles
from railhil.supervisor.trace import FloatArray

#: Points of one curve in the page.
_POINTS = 300
_WIDTH_IN, _ROW_IN, _TOP_IN = 8.5, 2.3, 0.4
_ACROSS = 2


@dataclass(frozen=True, slots=True)
class Spread:
    """One criterion over the runs of each law and its parameters: values with their sign where they have one, NaN for
    a run without.

    ``limits``: what the scenario allows, empty if it says nothing.
    """

    criterion: Criterion
    limits: tuple[float, ...]
    values: Mapping[str, FloatArray]


def limits_of(scenario: Any, criterion: Criterion) -> tuple[float, ...]:
    """The bounds of what a scenario allows."""
    limit = criterion.limit_in(scenario)
    if limit is None:
        return ()
    return (-limit, limit) if criterion.signed is not None else (limit,)


def spreads_of(
    scenario: Any, criteria: Sequence[Criterion], runs: Sequence[RecordedRun]
) -> tuple[list[Spread], dict[str, Style]]:
    """The scores of recorded runs by what they are runs of (:func:`railhil.supervisor.report.recorded.law_labels`), and
    a style for each."""
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


def worst_first(scenario: Any, criteria: Sequence[Criterion], runs: Sequence[RecordedRun]) -> list[int]:
    """Places of the runs, worst first: those that are not trusted or missed a limit, by how far they missed it; equal
    ones stay in their order."""

    def badness(run: RecordedRun) -> tuple[bool, bool, float]:
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

    A run without a value is at or below none.

    :param values: shape (n,).
    :param points: at most so many; the first and the last are kept.
    """
    known, counts = np.unique(values[np.isfinite(values)], return_counts=True)
    below = 100.0 * np.cumsum(counts) / max(len(values), 1)
    if len(known) > points:
        picked = np.unique(np.linspace(0, len(known) - 1, points).round().astype(int))
        known, below = known[picked], below[picked]
    return known, below


def charted(spreads: Sequence[Spread], looks: Mapping[str, Style]) -> dict[str, Any]:
    """The same as data for ``distribution.js``."""
    found = []
    for spread in spreads:
        laws = []
        for label, values in spread.values.items():
            style = looks[label]
            at, below = shares(values)
            laws.append(
                {
                    "label": plain(label),
                    "colour": style.law,
                    "dash": style.dashes,
                    "width": style.width,
                    "x": [float(f"{value:.6g}") for value in at.tolist()],
                    "y": [float(f"{value:.6g}") for value in below.tolist()],
                }
            )
        criterion = spread.criterion
        found.append(
            {
                "title": criterion.title,
                "unit": criterion.unit_typeset,
                "limits": spread.limits,
                "allowed": _allowed(spread),
                "laws": laws,
            }
        )
    return {"spreads": found}


def _allowed(spread: Spread) -> str:
    """The limits in words, empty if there are none."""
    if len(spread.limits) > 1:
        return " to ".join(f"{limit:g}" for limit in spread.limits)
    bound = "at most" if spread.criterion.better == "low" else "at least"
    return "".join(f"{bound} {limit:g}" for limit in spread.limits)


def picture(spreads: Sequence[Spread], looks: Mapping[str, Style]) -> Picture:
    """The distributions as one static figure, for paper and for browsers without scripts."""
    title = "Distributions of the scores"
    rows = -(-len(spreads) // _ACROSS)
    with drawing("none"):
        figure = Figure(figsize=(_WIDTH_IN, rows * _ROW_IN + _TOP_IN), layout="constrained")
        axes = figure.subplots(rows, _ACROSS, squeeze=False).ravel()
        for each, spread in zip(axes, spreads, strict=False):
            for label, values in spread.values.items():
                at, below = shares(values)
                style = {key: looks[label].line[key] for key in ("linestyle", "linewidth", "color")}
                each.step(at, below, where="post", label=label, **style)
            for limit in spread.limits:
                each.axvline(limit, color="0.3", linestyle=":", linewidth=1.4)
            each.set(xlabel=f"{spread.criterion.title} ({spread.criterion.unit_typeset})", ylabel="runs (%)")
            each.set_ylim(0, 102)
        for each in axes[len(spreads) :]:
            each.set_axis_off()
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=4, frameon=False)
        caption = "Share of the runs whose score is at most the value; dotted: what the scenario allows."
        return Picture("distributions", title, caption, svg(figure, "distributions", title))
