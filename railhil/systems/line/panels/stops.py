"""Figures with a row for each stop or section: stop errors, and energy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from railhil.charts.figure import Area, Chart, Figure, Look, Point
from railhil.systems.line.judge.stop import LineStop
from railhil.systems.line.panels.drawn import DrawnRun
from railhil.systems.line.panels.train_graph import shorten_name
from railhil.systems.line.scenario.model import LineScenario

#: Height of a row, and of each further run in it, px.
_ROW_PX, _RUN_PX = 20, 5
#: Half width of the chart of stop errors, as a multiple of the largest limit and of the largest error.
_AROUND, _AROUND_ERROR = 1.2, 1.1
_MJ = 1000.0


def line_stops(run: DrawnRun) -> list[tuple[int, LineStop]]:
    """The scored stops of a run with their numbers, from 0; none of a run that was not scored."""
    return [(place, stop) for place, stop in enumerate(run.record.score.stops) if isinstance(stop, LineStop)]


def stop_errors(line: LineScenario, runs: Sequence[DrawnRun]) -> Figure:
    """A point for each stop of each run over the stop error, with the limit and the door window as bands."""
    served = [place for place, stop in enumerate(line.stops) if stop.service != "pass" and place > 0]
    rows = {place: -float(row) for row, place in enumerate(served)}
    names = {row: f"{place + 1} {shorten_name(line.stops[place].name)}" for place, row in rows.items()}
    points, missed = [], []
    for run in runs:
        look = Look(run.style.look.colour, marker=run.style.look.marker, is_full=True, marker_px=7.0)
        for place, stop in line_stops(run):
            if place not in rows:
                continue
            if stop.error_m is None:
                missed.append(f"{run.label} at {place + 1} {stop.planned.name}")
                continue
            text = f"{run.label} at {place + 1} {stop.planned.name}: {stop.error_m:+.3f} m"
            points.append(Point(run.label, stop.error_m, rows[place], look, run.number, text))
    window_m, limit_m = line.route.door_window_m, max(line.stops[place].stop_error_max_m for place in served)
    half_m = max([_AROUND * max(window_m, limit_m), *(_AROUND_ERROR * abs(point.x) for point in points)])
    areas = [
        Area((-window_m, window_m), None, "allowed", "", label=f"door window, {window_m:g} m"),
        *_limits(line, rows),
        Area((0.0, 0.0), None),
    ]
    caption = "Distance of each standstill past the stopping point; negative: short of it."
    if missed:
        caption += f" No standstill: {', '.join(missed)}."
    chart = Chart(
        (), "stop error (m)", "", (-half_m, half_m), (min(rows.values()) - 0.6, 0.6), areas, points, y_names=names,
        height_px=_height_px(len(rows), len(runs)),
    )  # fmt: skip
    return Figure("stop-errors", "Stop errors", caption, [chart])


def _limits(line: LineScenario, rows: dict[int, float]) -> Iterator[Area]:
    for place, row in rows.items():
        limit_m = line.stops[place].stop_error_max_m
        text = f"allowed at {line.stops[place].name}: {limit_m:g} m"
        yield Area(
            (-limit_m, limit_m), (row - 0.5, row + 0.5), "block", text, label="allowed stop error", colour="line"
        )


def energy(line: LineScenario, runs: Sequence[DrawnRun]) -> list[Figure]:
    """Bars of the traction work of each section, of the part that could be regenerated, and the bound where one is
    shipped.

    :returns: empty if no run has a section.
    """
    rows = {number: -float(number) for number in range(1, len(line.sections) + 1)}
    areas: list[Area] = []
    for place, run in enumerate(runs):
        high = 0.8 / len(runs)
        for _, stop in line_stops(run):
            section = stop.section
            if section is None:
                continue
            top = rows[section.number] + 0.4 - place * high
            areas += _bars(run, section.number, section.traction_kj, section.regenerated_kj, top, high, len(runs) > 1)
    if not areas:
        return []
    points = list(_bounds(runs[0], rows))
    names = {
        row: f"{number} to {shorten_name(line.stops[line.sections[number - 1].arrival].name)}"
        for number, row in rows.items()
    }
    most_mj = max(area.x[1] for area in areas if area.x)
    bounds = (0.0, 1.05 * most_mj), (min(names) - 0.6, max(names) + 0.6)
    height_px = _height_px(len(names), len(runs))
    chart = Chart((), "energy at the wheel (MJ)", "", *bounds, areas, points, y_names=names, height_px=height_px)
    caption = "Traction work of each section; the inner bar is what the electric brake could give back (estimate)."
    if points:
        caption += (
            " Bound: the least work of an ideal train with the limits of a comfortable driving in the same time"
            f"{f' (of {runs[0].label})' if len(runs) > 1 else ''}, uncertainty 0.5 %; it has no lag and no jerk limit."
        )
    return [Figure("energy", "Energy of the sections", caption, [chart])]


def _bars(
    run: DrawnRun, number: int, traction_kj: float, back_kj: float | None, top: float, high: float, is_named: bool
) -> Iterator[Area]:
    colour = run.style.look.colour if is_named else "0"
    told = f"{run.label}, section {number}: traction {traction_kj / _MJ:.1f} MJ"
    label = f"{run.label}: traction" if is_named else "traction"
    yield Area((0.0, traction_kj / _MJ), (top - high, top), "block", told, run.number, label, colour)
    if back_kj is None:
        return
    back = (top - 0.75 * high, top - 0.25 * high)
    told += f", regenerated {back_kj / _MJ:.1f} MJ"
    yield Area((0.0, back_kj / _MJ), back, "block", told, run.number, "regenerated", "line")


def _bounds(run: DrawnRun, rows: dict[int, float]) -> Iterator[Point]:
    """The bound of each section in the time that the run has used."""
    look = Look("ink", marker="D", is_full=True, marker_px=6.0)
    for _, stop in line_stops(run):
        section = stop.section
        if section is None or section.bound_kj is None:
            continue
        bound_kj, share = section.bound_kj, section.energy_share_percent
        text = f"section {section.number}: bound {bound_kj / _MJ:.1f} MJ, the run used {share:.0f} % of it"
        yield Point("bound", bound_kj / _MJ, rows[section.number], look, text=text)


def _height_px(rows: int, runs: int) -> int:
    return rows * (_ROW_PX + _RUN_PX * (runs - 1))
