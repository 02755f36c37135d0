"""Figures of the report of precise stopping: speeds, margin and command over distance, estimated against true speed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from railhil.charts.figure import TIME, ZERO, Area, Chart, Curve, Figure, Look
from railhil.record.trace import FloatArray
from railhil.report.styles import Style, styles
from railhil.systems.stop.approach import Approach
from railhil.wire.stop import AtoState, BrakeCommand, SpeedRaw, Stage

_KMH = 3.6
#: Margins above this many metres are outside the figure: the important part is where the margin reaches 0.
_MARGIN_MAX_M = 60.0
#: The last metres, on a scale of their own.
_LAST_M = 12.0
_PLACE = "position less stopping point (m)"


class _Run(NamedTuple):
    label: str
    style: Style
    approach: Approach
    trace: Any
    number: int

    def curve(self, x: FloatArray, y: FloatArray, unit: str) -> Curve:
        """A curve of this run."""
        return Curve(self.label, x, y, self.style.look, unit, run=self.number)

    @property
    def margin_m(self) -> FloatArray:
        """The law's margin at the instants of TRUTH, NaN where it computes none."""
        stages = self.at(AtoState.PORT, "AtoStage")
        idle = np.isnan(stages) | np.isin(stages, (Stage.IDLE, Stage.STANDSTILL, Stage.LEARN))
        return np.where(idle, np.nan, self.at(AtoState.PORT, "AtoMargin"))

    def at(self, port: str, signal: str) -> FloatArray:
        """A signal at the instants of TRUTH, each time its last value; NaN before the first."""
        values = np.concatenate(([np.nan], self.trace.values(port, signal)))
        rows = np.searchsorted(self.trace.times_s(port), self.approach.time_s + 1e-9, side="right")
        return np.asarray(values[rows], dtype=np.float64)

    def error_mmps(self, port: str, signal: str) -> tuple[FloatArray, FloatArray]:
        """A speed less the true one at the instants of its telegrams , NaN unless the train moves: times (s), mm/s."""
        time_s = self.trace.times_s(port)
        rows = np.searchsorted(self.approach.time_s, time_s + 1e-9, side="right") - 1
        true_mps = self.approach.speed_mps[rows]
        moving = (true_mps > 0.0) & (rows >= 0)
        return time_s, np.where(moving, (self.trace.values(port, signal) - true_mps) * 1000.0, np.nan)


def pictures(scenario: Any, runs: Sequence[Any]) -> list[Figure]:
    """All figures, for all runs that can be drawn; empty if there is none."""
    drawn = [
        _Run(run.label, style, Approach.of(run.scenario, run.trace), run.trace, number)
        for number, (run, style) in enumerate(zip(runs, styles([run.controller for run in runs]), strict=True))
        if run.can_be_drawn
    ]
    return [_approach(drawn), _last(drawn), _speed(drawn)] if drawn else []


def _approach(runs: Sequence[_Run]) -> Figure:
    def charts() -> Iterator[Chart]:
        speeds = [run.curve(run.approach.error_m, run.approach.speed_mps * _KMH, "km/h") for run in runs]
        yield Chart(speeds, "", "speed (km/h)", y_bounds=(0.0, None), sync=_PLACE)
        margins = [run.curve(run.approach.error_m, run.margin_m, "m") for run in runs]
        bounds = (-_MARGIN_MAX_M / 4, _MARGIN_MAX_M)
        yield Chart(margins, "", "margin (m)", y_bounds=bounds, areas=[ZERO], sync=_PLACE)
        commands = [run.curve(run.approach.error_m, run.at(BrakeCommand.PORT, "CmdAccel"), "m/s\u00b2") for run in runs]
        yield Chart(commands, "", "command (m/s\u00b2)", sync=_PLACE)
        drives = [run.curve(run.approach.error_m, run.approach.drive_mps2, "m/s\u00b2") for run in runs]
        yield Chart(drives, _PLACE, "brake (m/s\u00b2)", sync=_PLACE)

    caption = (
        "True speed; the law's margin, the distance left before the brake has to begin; its command; and what traction "
        "and brake make of it."
    )
    return Figure("approach", "Approach over distance", caption, list(charts()))


def _last(runs: Sequence[_Run]) -> Figure:
    curves = []
    for run in runs:
        near = run.approach.error_m >= -_LAST_M
        curves.append(run.curve(run.approach.error_m, np.where(near, run.approach.speed_mps, np.nan), "m/s"))
    limit_m = runs[0].approach.scenario.task.stop_error_max_m
    allowed = Area((-limit_m, limit_m), None, "allowed", f"allowed stop error, {limit_m:g} m")
    caption = f"The last {_LAST_M:g} m; the band is the allowed stop error."
    chart = Chart(curves, _PLACE, "speed (m/s)", (-_LAST_M, None), (0.0, None), [allowed])
    return Figure("last_metres", "The last metres", caption, [chart])


def _speed(runs: Sequence[_Run]) -> Figure:
    sample = Curve("one sample", *runs[0].error_mmps(SpeedRaw.PORT, "Speed5"), Look("target", 0.8), "mm/s")
    curves = [run.curve(*run.error_mmps(AtoState.PORT, "AtoSpeed"), "mm/s") for run in runs]
    caption = "Speed that the law estimates, and one raw sample, less the true speed."
    chart = Chart([sample, *curves], TIME, "speed error (mm/s)", sync=TIME)
    return Figure("speed_estimate", "Estimated against true speed", caption, [chart])
