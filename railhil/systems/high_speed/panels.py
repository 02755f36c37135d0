"""Figures of the report of a high-speed train: speeds and errors, units, couplers, estimates of the law."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from railhil.charts.figure import TARGET, TIME, Chart, Curve, Figure
from railhil.record.trace import FloatArray
from railhil.report.styles import Style, styles
from railhil.systems.high_speed.ride import Ride
from railhil.wire.power_units import NOTES, wire

_KMH = 3.6
_PLACE = "position (km)"
_ESTIMATES = {
    "model_error": "model error (m/s)",
    "xi": "residual (m/s)",
    "gain": "gain",
    "delay": "delay (s)",
}
#: The true values of the estimates that the plant has.
_TRUE = {"gain": "TrueGain", "delay": "TrueTractionDelay"}


class _Run(NamedTuple):
    label: str
    style: Style
    ride: Ride
    trace: Any
    number: int

    def curve(self, x: FloatArray, y: FloatArray, unit: str) -> Curve:
        """A curve of this run."""
        return Curve(self.label, x, y, self.style.look, unit, run=self.number)

    def scored(self, values: FloatArray) -> FloatArray:
        """Values at the instants of the ride, NaN where they do not count."""
        return np.where(self.ride.scored, values, np.nan)


def pictures(scenario: Any, runs: Sequence[Any]) -> list[Figure]:
    """All figures, for all runs that can be drawn; empty if there is none."""
    drawn = [
        _Run(run.label, style, Ride.of(run.scenario, run.trace), run.trace, number)
        for number, (run, style) in enumerate(zip(runs, styles([run.controller for run in runs]), strict=True))
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


def _speed(runs: Sequence[_Run]) -> Figure:
    ride = runs[0].ride
    target = Curve("target", ride.position_m / 1000.0, ride.target_mps * _KMH, TARGET, "km/h")
    speeds = [run.curve(run.ride.position_m / 1000.0, run.ride.speed_mps * _KMH, "km/h") for run in runs]
    errors = [run.curve(run.ride.position_m / 1000.0, run.scored(run.ride.error_kmh), "km/h") for run in runs]
    charts = [
        Chart([target, *speeds], "", "speed (km/h)", y_bounds=(0.0, None), sync=_PLACE, height_px=190),
        Chart(errors, _PLACE, "error (km/h)", sync=_PLACE),
    ]
    caption = "Speed and target speed, and the error (speed less target), over distance; true values."
    return Figure("speed", "Speed and error over distance", caption, charts)


def _units(runs: Sequence[_Run]) -> Figure:
    def curves(run: _Run) -> list[Curve]:
        errors = [run.scored((speed_mps - run.ride.target_mps) * _KMH) for speed_mps in run.ride.unit_mps]
        return [
            Curve(f"unit {unit}", run.ride.position_m / 1000.0, error_kmh, None, "km/h", run=run.number)
            for unit, error_kmh in enumerate(errors, 1)
        ]

    caption = "Error of each unit's speed: what is between the lines is the difference of the units."
    return Figure("units", "The units' errors over distance", caption, _each(runs, curves, "km/h"))


def _couplers(runs: Sequence[_Run]) -> Figure:
    def curves(run: _Run) -> list[Curve]:
        return [
            Curve(f"units {unit} and {unit + 1}", run.ride.position_m / 1000.0, force_n / 1000.0, None, "kN",
                  run=run.number)
            for unit, force_n in enumerate(run.ride.coupler_n, 1)
        ]  # fmt: skip

    caption = "Force of each coupler, tension positive."
    return Figure("couplers", "Coupler forces over distance", caption, _each(runs, curves, "kN"))


def _each(runs: Sequence[_Run], curves: Callable[[_Run], list[Curve]], unit: str) -> list[Chart]:
    """A chart for each run over distance."""
    return [Chart(curves(run), _PLACE if run is runs[-1] else "", f"{run.label} ({unit})", sync=_PLACE) for run in runs]


def _estimates(run: _Run, unit: int) -> list[str]:
    """The figures that the law of a run reports for a unit, without those that are always 0."""
    status = wire(len(run.ride.unit_mps)).status
    names = {field: signal.name for field, signal in status.signals()}
    return [note for note in NOTES if run.trace.raw(status.PORT, names[f"{note}{unit}"]).any()]


def _estimated(runs: Sequence[_Run], unit: int, units: int) -> Figure:
    status = wire(units).status
    names = {field: signal.name for field, signal in status.signals()}
    shown = [note for note in NOTES if any(note in _estimates(run, unit) for run in runs)]

    def chart(note: str) -> Chart:
        curves = []
        if note in _TRUE and unit == 1:
            trace = runs[0].trace
            true = trace.times_s("MUTATION"), trace.values("MUTATION", _TRUE[note])
            curves.append(Curve("true value", *true, TARGET, is_step=True))
        for run in runs:
            if note in _estimates(run, unit):
                values = run.trace.values(status.PORT, names[f"{note}{unit}"])
                curves.append(Curve(run.label, run.trace.times_s(status.PORT), values, run.style.alone, is_step=True,
                                    run=run.number, column=f"{note}{unit}"))  # fmt: skip
        return Chart(curves, TIME if note == shown[-1] else "", _ESTIMATES[note], sync=TIME, height_px=110)

    which = f" of unit {unit}" if units > 1 else ""
    caption = "What the law reports: error of its model over one sample, residual, and parameters that it identifies."
    return Figure(f"estimates{unit}", f"What the law estimates{which}", caption, [chart(note) for note in shown])
