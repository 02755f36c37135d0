"""A run among the runs of a campaign of its scenario and law: how far its scores may lie apart by noise and train."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from railhil.charts.figure import Area, Chart, Figure, FloatArray, Look, Point
from railhil.judge.criteria import Criterion
from railhil.judge.record import Record
from railhil.report.distribution import limits_of
from railhil.report.styles import styles

#: The part of the runs that a bar covers.
_FROM, _TO = 0.05, 0.95
_BAR_PX = 46


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


def noise_figures(runs: Sequence[Record], found: Sequence[Noise]) -> Iterator[Figure]:
    """A figure for each run with such runs: a bar and the run's own value for each score."""
    looks = styles([run.controller for run in runs])
    for one in found:
        run, look = runs[one.number], looks[one.number].look
        drawn = (_chart(run, criterion, one, look) for criterion in run.judging.criteria)
        charts = [chart for chart in drawn if chart is not None]
        title = "Scores among other runs" + (f": {run.label}" if len(runs) > 1 else "")
        caption = f"Marker: this run; bar: nine of ten of {one.said}; dotted: what the scenario allows."
        if charts:
            yield Figure(f"noise-{one.number}", title, caption, charts)


def _chart(run: Record, criterion: Criterion, noise: Noise, look: Look) -> Chart | None:
    value, bounds = run.score.with_sign(criterion), bounds_of_runs(noise.values[criterion.key])
    if value is None or bounds is None:
        return None
    limits = limits_of(run.scenario, criterion)
    most, least = max(value, *bounds, *limits), min(value, *bounds, *limits)
    beside = 0.05 * (most - least) or 1.0
    said = " to ".join(criterion.shown(bound) for bound in bounds)
    areas = [Area(bounds, (-0.4, 0.4), "block", f"nine of ten: {said} {criterion.unit}", colour="6")]
    areas += [Area((limit, limit), None, "line", f"allowed {limit:g} {criterion.unit}") for limit in limits]
    point = Point(run.label, value, 0.0, look, noise.number, f"{run.label}: {criterion.shown(value)} {criterion.unit}")
    label = f"{criterion.title} ({criterion.unit_typeset}), nine of ten {said}"
    x_bounds = least - beside, most + beside
    return Chart(x_label=label, x_bounds=x_bounds, y_bounds=(-1.0, 1.0), areas=areas, points=[point], y_names={0.0: ""},
                 height_px=_BAR_PX, share=0.5)  # fmt: skip
