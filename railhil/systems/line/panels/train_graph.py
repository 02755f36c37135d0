"""The train graph: place over time of the timetable and of each run, what happens at the stops, and the lateness."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from railhil.charts.figure import TARGET, TIME, ZERO, Area, Band, Chart, Curve, Figure, Look, Point
from railhil.systems.line.panels.drawn import DOORS, EXCHANGE, HOLD, DrawnRun
from railhil.systems.line.planned import fold_positions, planned_motion
from railhil.systems.line.scenario.model import LineScenario

#: Height of the graph: the least, the most, and for each stop of the line, px.
_LEAST_PX, _MOST_PX, _STOP_PX = 260, 620, 34
_LATENESS_PX = 120
#: Colours of the parts of a stop, in their order.
_COLOURS = {DOORS: "6", EXCHANGE: "2", HOLD: "3"}
#: Height of the bars at a stop as a share of the line, of all runs together; for more runs there are none.
_BARS, _BAR_RUNS_MAX = 0.022, 4
#: A train that is less late has no shading, s.
_LATE_S = 0.5
_LATE = Look("fault")
#: Letters of a stop's name beside an axis.
_LETTERS = 26


def train_graph(line: LineScenario, runs: Sequence[DrawnRun]) -> Figure:
    """Place over time, and lateness over time below it."""
    end_s = max(line.plan.running_time_s, *(float(run.time_s[-1]) for run in runs)) * 1.01
    bounds = (0.0, end_s)
    caption = (
        "The grey line keeps the timetable. Where a run is late, the area between both is shaded. Bars at a stop: the "
        "doors open or close, the exchange of passengers, and the rest of the time until the departure."
    )
    if any(stop.turn_back for stop in line.stops):
        caption += " The graph turns back where the train does."
    if len(runs) > _BAR_RUNS_MAX:
        caption = caption.partition(" Bars")[0]
    return Figure("train-graph", "Train graph", caption, [_graph(line, runs, bounds), _lateness(line, runs, bounds)])


def stop_names(line: LineScenario) -> dict[float, str]:
    """Names of the stops at their places on the line; a place that the train comes back to is named once."""
    found: dict[float, str] = {}
    for stop in line.stops:
        place_m = float(fold_positions(line, stop.position_m))
        if not any(abs(place_m - known) < 1.0 for known in found):
            found[place_m] = shorten_name(stop.name)
    return found


def shorten_name(name: str, letters: int = _LETTERS) -> str:
    """A name that has room beside an axis."""
    return name if len(name) <= letters else f"{name[: letters - 1].rstrip()}…"


def _graph(line: LineScenario, runs: Sequence[DrawnRun], bounds: tuple[float, float]) -> Chart:
    planned, names = planned_motion(line), stop_names(line)
    low_m, high_m = min(names), max(names)
    curves = [Curve("timetable", planned.time_s, fold_positions(line, planned.position_m), TARGET, "m")]
    curves += [
        Curve(run.label, run.time_s, fold_positions(line, run.position_m), run.look, "m", run=run.number)
        for run in runs
    ]
    bars = list(_bars(line, runs, high_m - low_m)) if len(runs) <= _BAR_RUNS_MAX else []
    margin_m = 0.03 * (high_m - low_m)
    return Chart(
        curves,
        "",
        "",
        bounds,
        (low_m - margin_m, high_m + margin_m),
        areas=[*bars, *_signals(line), *_held_signals(line, runs)],
        bands=[_late_band(line, run, len(runs) > 1) for run in runs],
        y_names=names,
        sync=TIME,
        height_px=max(_LEAST_PX, min(_MOST_PX, _STOP_PX * len(names))),
    )


def _late_band(line: LineScenario, run: DrawnRun, is_named: bool) -> Band:
    """From a run to the timetable, where it is late."""
    planned = planned_motion(line)
    late_s = planned.lateness_s(run.time_s, run.position_m, run.speed_kmh / 3.6)
    is_late = late_s >= _LATE_S
    wanted_m = fold_positions(line, planned.positions_at(run.time_s))
    made_m = fold_positions(line, run.position_m)
    label = f"{run.label}: late" if is_named else "late"
    label = label if is_late.any() else ""
    look = Look(run.style.look.colour) if is_named else _LATE
    low, high = (np.where(is_late, one, np.nan) for one in (made_m, wanted_m))
    return Band(label, run.time_s, low, high, look, run=run.number)


def _bars(line: LineScenario, runs: Sequence[DrawnRun], length_m: float) -> Iterator[Area]:
    """The parts of each stop; the bars of several runs lie above each other."""
    height_m = _BARS * length_m / len(runs)
    for place, run in enumerate(runs):
        for spell in run.spells():
            stop = line.stops[spell.stop - 1]
            at_m = float(fold_positions(line, stop.position_m)) + (place - len(runs) / 2) * height_m
            text = f"{stop.name}: {spell.kind} {spell.until_s - spell.begun_s:.1f} s from {spell.begun_s:.1f} s on"
            yield Area(
                (spell.begun_s, spell.until_s),
                (at_m, at_m + height_m),
                "block",
                f"{run.label}, {text}" if len(runs) > 1 else text,
                run.number,
                spell.kind,
                _COLOURS[spell.kind],
            )


def _signals(line: LineScenario) -> Iterator[Area]:
    """Red signals until they clear."""
    for signal in line.signals:
        place_m = float(fold_positions(line, signal.position_m))
        text = f"signal at {signal.position_m:g} m, red until {signal.clear_s:g} s"
        yield Area((0.0, signal.clear_s), (place_m, place_m), "fault", text, label="red signal")


def _held_signals(line: LineScenario, runs: Sequence[DrawnRun]) -> Iterator[Area]:
    """Signals that are red in a record, and not by the scenario."""
    for run in runs:
        for red in run.reds():
            place_m = float(fold_positions(line, red.position_m))
            text = f"signal at {red.position_m:g} m, held red from {red.begun_s:.1f} s to {red.until_s:.1f} s"
            text = f"{run.label}, {text}" if len(runs) > 1 else text
            yield Area((red.begun_s, red.until_s), (place_m, place_m), "fault", text, run.number, "red signal")


def _lateness(line: LineScenario, runs: Sequence[DrawnRun], bounds: tuple[float, float]) -> Chart:
    """Lateness as a step at each arrival and departure, with the limits of both."""
    route = line.route
    curves, points = [], []
    for run in runs:
        steps = list(_steps(run))
        if not steps:
            continue
        x, y = ([*(step[place] for step in steps)] for place in (0, 1))
        end_s = float(run.time_s[-1])
        curves.append(
            Curve(run.label, np.array([*x, end_s]), np.array([*y, y[-1]]), run.look, "s", is_step=True,
                  run=run.number)
        )  # fmt: skip
        marked = Look(run.style.look.colour, marker=run.style.look.marker, is_full=True, marker_px=5.0)
        points += [Point(run.label, at_s, late_s, marked, run.number, text) for at_s, late_s, text in steps]
    allowed = Area(
        None,
        (-route.arrival_error_max_s, route.arrival_error_max_s),
        "allowed",
        f"arrivals within {route.arrival_error_max_s:g} s",
        label="allowed at an arrival",
    )
    late_s = [point.y for point in points]
    limit_s = 1.2 * route.arrival_error_max_s
    y_bounds = (min([-limit_s, *(1.1 * one for one in late_s)]), max([limit_s, *(1.1 * one for one in late_s)]))
    return Chart(curves, TIME, "late (s)", bounds, y_bounds, areas=[allowed, ZERO], points=points, sync=TIME,
                 height_px=_LATENESS_PX)  # fmt: skip


def _steps(run: DrawnRun) -> Iterator[tuple[float, float, str]]:
    """Instant, lateness and words of each arrival and departure."""
    for stop in run.record.score.stops:
        standstill, late_s = stop.standstill, stop.late_s
        if standstill is not None and late_s is not None:
            yield standstill.instant_s, late_s, f"{stop.planned.name}: arrival {late_s:+.2f} s"
        departed_s, late_s = stop.departed_s, stop.departure_late_s
        if departed_s is not None and late_s is not None:
            yield departed_s, late_s, f"{stop.planned.name}: departure {late_s:+.2f} s"
