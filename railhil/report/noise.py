"""A run among the runs of a campaign of its scenario and law: how far its scores may lie apart by noise and train."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from railhil.charts.figure import Area, Chart, Figure, FloatArray, Point
from railhil.judge.criteria import Criterion
from railhil.judge.record import Record
from railhil.report.distribution import limits_of
from railhil.report.styles import Style, styles

#: The part of the runs that a bar covers.
_FROM, _TO = 0.05, 0.95
_BAR_PX = 26


@dataclass(frozen=True, slots=True)
class Noise:
    """Perturbed runs of a law.

    ``number``: of the run on the page. ``said``: these runs in words; ``link``: address of the campaign. ``values``: of
    each score with its sign, shape (n,), NaN: a run without.
    """

    number: int
    said: str
    link: str
    values: Mapping[str, FloatArray]


def bounds_of_runs(values: FloatArray) -> tuple[float, float] | None:
    """The values between which nine of ten runs are; None: a bound is a run without a value, or there is none."""
    known = np.sort(np.nan_to_num(values, nan=np.inf))
    if not len(known):
        return None
    low, high = (float(known[round(share * (len(known) - 1))]) for share in (_FROM, _TO))
    return (low, high) if np.isfinite(high) else None


def noise_figures(runs: Sequence[Record], found: Sequence[Noise]) -> list[Figure]:
    """For each score a chart with a row for each run that has such runs: a bar and its own value; empty without any."""
    looks = styles([run.controller for run in runs])
    criteria = runs[0].judging.criteria
    charts = [chart for one in criteria if (chart := _chart(runs, one, found, looks)) is not None]
    if not charts:
        return []
    said = "; ".join(dict.fromkeys(one.said for one in found))
    caption = f"Markers: the runs of this page; bars: nine of ten of {said}; lines: what the scenario allows."
    return [Figure("noise", "Scores among other runs", caption, charts)]


def _chart(
    runs: Sequence[Record], criterion: Criterion, found: Sequence[Noise], looks: Sequence[Style]
) -> Chart | None:
    areas, points, names = [], [], {}
    for row, noise in enumerate(found):
        run, look, y = runs[noise.number], looks[noise.number].look, float(-row)
        value, bounds = run.score.with_sign(criterion), bounds_of_runs(noise.values[criterion.key])
        if value is None or bounds is None:
            continue
        said = " to ".join(criterion.shown(bound) for bound in bounds)
        text = f"nine of ten: {said} {criterion.unit}"
        areas.append(Area(bounds, (y - 0.35, y + 0.35), "block", text, noise.number, colour="target"))
        own = f"{run.label}: {criterion.shown(value)} {criterion.unit}"
        points.append(Point("", value, y, look, noise.number, own))
        names[y] = run.label
    if not areas:
        return None
    limits = limits_of(runs[0].scenario, criterion)
    places = [*limits, *(point.x for point in points), *(bound for area in areas if area.x for bound in area.x)]
    beside = 0.05 * (max(places) - min(places)) or 1.0
    areas += [Area((limit, limit), None, "line", f"allowed {limit:g} {criterion.unit}") for limit in limits]
    x_bounds = min(places) - beside, max(places) + beside
    return Chart(x_label=f"{criterion.title} ({criterion.unit_typeset})", x_bounds=x_bounds,
                 y_bounds=(0.5 - len(found), 0.5), areas=areas, points=points, y_names=names,
                 height_px=_BAR_PX * len(found), share=0.5)  # fmt: skip
