"""Figures of the report of precise stopping: speeds, margin and command over distance, estimated against true speed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from railhil.bus.stopping import AtoState, BrakeCommand, SpeedRaw, Stage
from railhil.supervisor.precise_stopping.approach import Approach
from railhil.supervisor.report.figures import Picture
from railhil.supervisor.report.stacked import line, stacked
from railhil.supervisor.report.styles import Style, styles
from railhil.supervisor.trace import FloatArray

_KMH = 3.6
#: Margins above this many metres are outside the figure: what matters is where the margin reaches 0.
_MARGIN_MAX_M = 60.0
#: The last metres, on a scale of their own.
_LAST_M = 12.0


class _Run(NamedTuple):
    label: str
    style: Style
    approach: Approach
    trace: Any

    def at(self, port: str, signal: str) -> FloatArray:
        """A signal at the instants of TRUTH, each time its last value; NaN before the first."""
        values = np.concatenate(([np.nan], self.trace.values(port, signal)))
        rows = np.searchsorted(self.trace.times_s(port), self.approach.time_s + 1e-9, side="right")
        return np.asarray(values[rows], dtype=np.float64)

    def error_mmps(self, port: str, signal: str) -> tuple[FloatArray, FloatArray]:
        """A speed less the true one at the instants of its telegrams, NaN unless the train moves: times (s), mm/s."""
        time_s = self.trace.times_s(port)
        rows = np.searchsorted(self.approach.time_s, time_s + 1e-9, side="right") - 1
        true_mps = self.approach.speed_mps[rows]
        moving = (true_mps > 0.0) & (rows >= 0)
        return time_s, np.where(moving, (self.trace.values(port, signal) - true_mps) * 1000.0, np.nan)


def pictures(scenario: Any, runs: Sequence[Any]) -> list[Picture]:
    """All figures, for all runs that can be drawn; empty if there is none."""
    drawn = [
        _Run(run.label, style, Approach.of(run.scenario, run.trace), run.trace)
        for run, style in zip(runs, styles([run.controller for run in runs]), strict=True)
        if run.can_be_drawn
    ]
    return [_approach(drawn), _last(drawn), _speed(drawn)] if drawn else []


def _approach(runs: Sequence[_Run]) -> Picture:
    def speed(axes: Axes) -> None:
        for run in runs:
            line(axes, run.approach.error_m, run.approach.speed_mps * _KMH, label=run.label, **run.style.line)
        axes.set(ylabel="speed (km/h)", ylim=(0, None))

    def margin(axes: Axes) -> None:
        axes.axhline(0.0, color="0.75", linewidth=1.0)
        for run in runs:
            stages = run.at(AtoState.PORT, "AtoStage")
            shown = (stages != Stage.IDLE) & (stages != Stage.STANDSTILL) & (stages != Stage.LEARN)
            line(axes, run.approach.error_m, run.at(AtoState.PORT, "AtoMargin"), shown, **run.style.alone)
        axes.set(ylabel="margin (m)", ylim=(-_MARGIN_MAX_M / 4, _MARGIN_MAX_M))

    def command(axes: Axes) -> None:
        for run in runs:
            line(axes, run.approach.error_m, run.at(BrakeCommand.PORT, "CmdAccel"), **run.style.alone)
        axes.set(ylabel="command (m/s\u00b2)")

    def achieved(axes: Axes) -> None:
        for run in runs:
            line(axes, run.approach.error_m, run.approach.drive_mps2, **run.style.alone)
        axes.set(ylabel="brake (m/s\u00b2)", xlabel="position less stopping point (m)")

    caption = (
        "True speed; the law's margin, the distance left before the brake has to begin; its command; and what traction "
        "and brake make of it."
    )
    return stacked("approach", "Approach over distance", caption, [speed, margin, command, achieved])


def _last(runs: Sequence[_Run]) -> Picture:
    def speed(axes: Axes) -> None:
        for run in runs:
            near = run.approach.error_m >= -_LAST_M
            line(axes, run.approach.error_m, run.approach.speed_mps, near, label=run.label, **run.style.line)
        limit_m = runs[0].approach.scenario.task.stop_error_max_m
        axes.axvspan(-limit_m, limit_m, color="0.9")
        axes.set(ylabel="speed (m/s)", ylim=(0, None), xlabel="position less stopping point (m)")

    caption = f"The last {_LAST_M:g} m; the band is the allowed stop error."
    return stacked("last_metres", "The last metres", caption, [speed])


def _speed(runs: Sequence[_Run]) -> Picture:
    def error(axes: Axes) -> None:
        line(axes, *runs[0].error_mmps(SpeedRaw.PORT, "Speed5"), color="0.8", linewidth=0.8, label="one sample")
        for run in runs:
            line(axes, *run.error_mmps(AtoState.PORT, "AtoSpeed"), label=run.label, **run.style.line)
        axes.set(ylabel="speed error (mm/s)", xlabel="time (s)")

    caption = "Speed that the law estimates, and one raw sample, less the true speed."
    return stacked("speed_estimate", "Estimated against true speed", caption, [error])
