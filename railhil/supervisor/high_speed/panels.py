"""Figures of the report of a high-speed train: speeds and errors, units, couplers, what the law estimates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from matplotlib.axes import Axes

from railhil.bus.high_speed import NOTES, wire
from railhil.supervisor.high_speed.ride import Ride
from railhil.supervisor.report.figures import Picture
from railhil.supervisor.report.stacked import line, stacked
from railhil.supervisor.report.styles import Style, styles

_KMH = 3.6
_UNIT_COLOURS = ("#0072b2", "#d55e00", "#009e73")
_ESTIMATES = {
    "model_error": "model error (m/s)",
    "xi": "residual (m/s)",
    "gain": "gain",
    "delay": "delay (s)",
}
#: The true values of the estimates, as far as the plant has them.
_TRUE = {"gain": "TrueGain", "delay": "TrueTractionDelay"}


class _Run(NamedTuple):
    label: str
    style: Style
    ride: Ride
    trace: Any


def pictures(scenario: Any, runs: Sequence[Any]) -> list[Picture]:
    """All figures, for all runs that can be drawn; empty if there is none."""
    drawn = [
        _Run(run.label, style, Ride.of(run.scenario, run.trace), run.trace)
        for run, style in zip(runs, styles([run.controller for run in runs]), strict=True)
        if run.can_be_drawn
    ]
    if not drawn:
        return []
    found = [_speed(drawn)]
    if len(scenario.task.unit) > 1:
        found.append(_units(drawn))
        if scenario.task.between_units is not None:
            found.append(_couplers(drawn))
    for unit in range(1, len(scenario.task.unit) + 1):
        estimating = [run for run in drawn if _estimates(run, unit)]
        if estimating:
            found.append(_estimated(estimating, unit, len(scenario.task.unit)))
    return found


def _speed(runs: Sequence[_Run]) -> Picture:
    def speed(axes: Axes) -> None:
        ride = runs[0].ride
        line(axes, ride.position_m / 1000.0, ride.target_mps * _KMH, color="0.75", linewidth=3.5, label="target")
        for run in runs:
            line(axes, run.ride.position_m / 1000.0, run.ride.speed_mps * _KMH, label=run.label, **run.style.line)
        axes.set(ylabel="speed (km/h)", ylim=(0, None))

    def error(axes: Axes) -> None:
        for run in runs:
            line(axes, run.ride.position_m / 1000.0, run.ride.error_kmh, run.ride.scored, **run.style.alone)
        axes.set(ylabel="error (km/h)", xlabel="position (km)")

    caption = "Speed and target speed, and the error (speed less target), over distance; true values."
    return stacked("speed", "Speed and error over distance", caption, [speed, error])


def _units(runs: Sequence[_Run]) -> Picture:
    def row(run: _Run) -> Callable[[Axes], None]:
        def draw(axes: Axes) -> None:
            ride = run.ride
            for unit, speed_mps in enumerate(ride.unit_mps):
                error_kmh = (speed_mps - ride.target_mps) * _KMH
                label = f"unit {unit + 1}" if run is runs[0] else None
                line(axes, ride.position_m / 1000.0, error_kmh, ride.scored, color=_UNIT_COLOURS[unit], linewidth=0.9,
                      label=label)  # fmt: skip
            axes.set(ylabel=f"{run.label}\n(km/h)", xlabel="position (km)")

        return draw

    caption = "Error of each unit's speed: what is between the lines is the difference of the units."
    return stacked("units", "The units' errors over distance", caption, [row(run) for run in runs])


def _couplers(runs: Sequence[_Run]) -> Picture:
    def row(run: _Run) -> Callable[[Axes], None]:
        def draw(axes: Axes) -> None:
            for number, force_n in enumerate(run.ride.coupler_n):
                label = f"units {number + 1} and {number + 2}" if run is runs[0] else None
                line(axes, run.ride.position_m / 1000.0, force_n / 1000.0, color=_UNIT_COLOURS[number], linewidth=0.9,
                      label=label)  # fmt: skip
            axes.set(ylabel=f"{run.label}\n(kN)", xlabel="position (km)")

        return draw

    caption = "Force of each coupler, tension positive."
    return stacked("couplers", "Coupler forces over distance", caption, [row(run) for run in runs])


def _estimates(run: _Run, unit: int) -> list[str]:
    """The figures that the law of a run reports for a unit: those that are not always 0."""
    status = wire(len(run.ride.unit_mps)).status
    names = {field: signal.name for field, signal in status.signals()}
    return [note for note in NOTES if run.trace.raw(status.PORT, names[f"{note}{unit}"]).any()]


def _estimated(runs: Sequence[_Run], unit: int, units: int) -> Picture:
    status = wire(units).status
    names = {field: signal.name for field, signal in status.signals()}
    shown = [note for note in NOTES if any(note in _estimates(run, unit) for run in runs)]

    def row(note: str) -> Callable[[Axes], None]:
        def draw(axes: Axes) -> None:
            if note in _TRUE and unit == 1:
                trace = runs[0].trace
                line(axes, trace.times_s("MUTATION"), trace.values("MUTATION", _TRUE[note]), color="0.75",
                      linewidth=3.5, label="true value")  # fmt: skip
            for run in runs:
                if note in _estimates(run, unit):
                    label = run.label if note == shown[0] else None
                    values = run.trace.values(status.PORT, names[f"{note}{unit}"])
                    line(axes, run.trace.times_s(status.PORT), values, label=label, **run.style.alone)
            axes.set(ylabel=_ESTIMATES[note], xlabel="time (s)")

        return draw

    which = f" of unit {unit}" if units > 1 else ""
    caption = "What the law reports: error of its model over one sample, residual, and parameters that it identifies."
    return stacked(f"estimates{unit}", f"What the law estimates{which}", caption, [row(note) for note in shown])
