"""Speed over the distance of the whole line, and the approach to each stop."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from railhil.charts.figure import TARGET, ZERO, Area, Band, Chart, Curve, Figure, Look
from railhil.record.trace import FloatArray
from railhil.systems.ato.judge.measures import KMH, limits_under_train
from railhil.systems.line.panels.drawn import DrawnRun
from railhil.systems.line.panels.train_graph import shorten_name
from railhil.systems.line.planned import planned_motion
from railhil.systems.line.scenario.model import LineScenario, Section

_LIMIT = Look("dim", 1.4, (2.0, 2.0))
_PERMITTED, _EBI = Look("dim", 1.4), Look("fault", 1.2)
_INTERVAL = Look("6")
#: Width and dashes of P and EBI beside other runs, whose colours they have.
_AMONG = ((1.0, (5.0, 2.0)), (1.0, (1.5, 2.0)))
#: Interval of the limit, m.
_STEP_M = 5.0
_SPEED_PX, _GRADE_PX, _APPROACH_PX = 310, 60, 170
#: Share of the chart that the speeds fill below the names of the stops, and letters of a name there.
_SPEEDS, _LETTERS = 0.61, 17
#: The approach: before and behind the stopping point, m.
_BEFORE_M, _BEHIND_M = 300.0, 15.0
#: Charts of approaches beside each other.
_ACROSS = 3
_DISTANCE = "position in the run (m)"
_LEFT = "distance to the stopping point (m)"


def speed(line: LineScenario, runs: Sequence[DrawnRun]) -> Figure:
    """Speed over distance, a chart for each leg, the grade of the line below it."""
    caption = (
        "Train, planned speed of the timetable, and speed limit in force for the whole train; the grade of the line "
        "(up positive)."
    )
    caption += _protection_words(runs)
    charts = [chart for leg in range(len(line.legs)) for chart in _leg(line, leg, runs)]
    return Figure("speed", "Speed over distance", caption, charts)


def _protection_words(runs: Sequence[DrawnRun]) -> str:
    """What P and EBI are, and of which runs; empty if no run has a train protection."""
    told = [run.label for run in runs if run.has_protection]
    if not told:
        return ""
    whose = "" if len(told) == len(runs) else f" (of {', '.join(told)} only)"
    return f" P: permitted speed, EBI: intervention of the emergency brake, as the train protection told them{whose}."


def _protection_curves(run: DrawnRun, at_m: FloatArray, rows: npt.NDArray[np.int64]) -> list[Curve]:
    """P and EBI of a run at some of its rows; none without a train protection. Beside other runs they carry its name
    and its colour."""
    if not run.has_protection:
        return []
    of = f" {run.label}" if run.is_among else ""
    permitted, ebi = _PERMITTED, _EBI
    if run.is_among:
        permitted, ebi = (Look(run.style.look.colour, width, dashes) for width, dashes in _AMONG)
    return [
        Curve(f"P{of}", at_m, run.permitted_kmh[rows], permitted, "km/h", run=run.number),
        Curve(f"EBI{of}", at_m, run.ebi_kmh[rows], ebi, "km/h", run=run.number),
    ]


def leg_bounds(line: LineScenario, leg: int) -> tuple[float, float]:
    """First and last position of a leg, in m of the run."""
    turns = [stop.position_m for stop in line.stops if stop.turn_back]
    edges = [0.0, *turns, line.stops[-1].position_m]
    return edges[leg], edges[leg + 1]


def _leg(line: LineScenario, leg: int, runs: Sequence[DrawnRun]) -> list[Chart]:
    low_m, high_m = leg_bounds(line, leg)
    margin_m = 0.01 * (high_m - low_m)
    bounds = (low_m, high_m + margin_m)
    front_m = np.arange(low_m, high_m + _STEP_M, _STEP_M)
    limit_kmh = limits_under_train(line.legs[leg].speed_limit_mps, front_m, line.train.length_m) * KMH
    planned = planned_motion(line)
    own = (planned.position_m >= low_m) & (planned.position_m <= high_m)
    curves = [
        Curve("limit", front_m, limit_kmh, _LIMIT, "km/h", is_step=True),
        Curve("plan", planned.position_m[own], planned.speed_mps[own] * KMH, TARGET, "km/h"),
    ]
    for run in runs:
        rows = run.leg_rows(leg)
        at_m = run.position_m[rows]
        curves += _protection_curves(run, at_m, rows)
        curves.append(Curve(run.label, at_m, run.speed_kmh[rows], run.look, "km/h", run=run.number))
    names = {
        stop.position_m: shorten_name(stop.name, _LETTERS) for stop in line.stops if low_m <= stop.position_m <= high_m
    }
    word = f" of leg {leg + 1}" if len(line.legs) > 1 else ""
    sync = f"{_DISTANCE}{word}"
    return [
        Chart(curves, "", f"speed (km/h){word}", bounds, (0.0, _highest(curves)), x_lines=names, sync=sync,
              height_px=_SPEED_PX),
        _grade(line, leg, bounds, names, sync),
    ]  # fmt: skip


def _highest(curves: Sequence[Curve]) -> float:
    """Upper end of the axis: the names of the stops have room above the speeds."""
    highest = max(float(np.nanmax(curve.y)) for curve in curves if np.isfinite(curve.y).any())
    return highest / _SPEEDS


def _grade(line: LineScenario, leg: int, bounds: tuple[float, float], names: dict[float, str], sync: str) -> Chart:
    rows = [row for row in line.legs[leg].grade_permil if row[0] < bounds[1]]
    starts = np.array([max(bounds[0], start_m) for start_m, _ in rows] + [bounds[1]])
    values = np.array([value for _, value in rows] + [rows[-1][1]])
    stairs = Curve("grade", starts, values, Look("dim", 0.8), "‰", is_step=True, is_filled=True)
    lines = dict.fromkeys(names, "")
    return Chart([stairs], _DISTANCE, "grade (‰)", bounds, areas=[ZERO], x_lines=lines, sync=sync, height_px=_GRADE_PX)


def approaches(line: LineScenario, runs: Sequence[DrawnRun]) -> Figure:
    """The last metres before each served stop: speeds, and the interval of the train protection's position."""
    caption = (
        f"The last {_BEFORE_M:g} m before each stop; the narrow band is the allowed stop error. The planned curve is "
        "that of the timetable: a run that departed late follows another one."
    )
    if words := _protection_words(runs):
        caption += f"{words} The band along the speed is its interval of the position."
    charts = [
        # Charts of one row are equally high.
        _approach(line, number, section, runs, (number - 1) // _ACROSS >= (len(line.sections) - _ACROSS) // _ACROSS)
        for number, section in enumerate(line.sections, start=1)
    ]
    return Figure("approaches", "Approach to each stop", caption, charts)


def _approach(line: LineScenario, number: int, section: Section, runs: Sequence[DrawnRun], is_lowest: bool) -> Chart:
    stop = line.stops[section.arrival]
    planned = planned_motion(line)
    near = (planned.position_m >= stop.position_m - _BEFORE_M) & (planned.position_m <= stop.position_m)
    until_s = stop.arrive_s if stop.arrive_s is not None else np.inf
    near &= planned.time_s <= until_s
    curves = [Curve("plan", planned.position_m[near] - stop.position_m, planned.speed_mps[near] * KMH, TARGET,
                    "km/h")]  # fmt: skip
    bands = []
    for run in runs:
        first, after = run.section_rows(number)
        at_m = run.position_m[first:after] - stop.position_m
        rows = first + np.flatnonzero((at_m >= -_BEFORE_M) & (at_m <= _BEHIND_M) | np.isnan(at_m))
        at_m, kmh = run.position_m[rows] - stop.position_m, run.speed_kmh[rows]
        if run.has_protection:
            half_m = run.uncertainty_m[rows]
            label = f"interval {run.label}" if run.is_among else "interval"
            look = Look(run.style.look.colour) if run.is_among else _INTERVAL
            bands.append(Band(label, at_m - half_m, kmh, kmh, look, at_m + half_m, run.number))
        curves += _protection_curves(run, at_m, rows)
        curves.append(Curve(run.label, at_m, kmh, run.look, "km/h", run=run.number))
    limit_m = stop.stop_error_max_m
    return Chart(
        curves,
        _LEFT if is_lowest else "",
        f"{section.arrival + 1} {shorten_name(stop.name)} (km/h)",
        (-_BEFORE_M, _BEHIND_M),
        (0.0, None),
        [Area((-limit_m, limit_m), None, "allowed", f"allowed stop error, {limit_m:g} m")],
        bands=bands,
        height_px=_APPROACH_PX,
        share=1 / _ACROSS,
    )
