"""The figures of a train that drives automatically from one stop to the next (``ato``), one function for each chart."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from railhil.charts.figure import TARGET, TIME, ZERO, Area, Chart, Curve, Figure, FloatArray, Look, Point
from railhil.judge.record import Record
from railhil.judge.score import Score
from railhil.record.notes import ReportedNote
from railhil.record.trace import Trace
from railhil.report.display_columns import ERROR
from railhil.report.styles import Style, styles
from railhil.systems.ato.judge.criteria import STOP_ERROR, TIME_ERROR
from railhil.systems.ato.judge.curves import Curves, curves
from railhil.systems.ato.judge.measures import KMH, limits_under_train
from railhil.systems.ato.judge.score import score
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.target import Target

_POINTS = 800
#: Half height of the chart of the stop, m: minimum and maximum.
_STOP_MIN_M, _STOP_MAX_M = 0.4, 3.0
#: Half width of an enlarged view, as a share of the distance.
_NEAR_SHARE = 0.02
#: Height of the row of one law, alone and among others, and of one name of a bit field, px.
_ROW_PX, _ROW_AMONG_PX, _NAME_PX = 150, 105, 20
_LIMIT = Look("dim", 1.4, (2.0, 2.0))
_DISTANCE = "distance (m)"


@dataclass(frozen=True, slots=True)
class Drawn:
    """One run ready to be drawn: its name, style and curves. ``number``: of the run on the page."""

    label: str
    style: Style
    curves: Curves
    score: Score
    number: int = -1


def pictures(scenario: Scenario, runs: Sequence[Record]) -> list[Figure]:
    """All figures, in reading order; empty if no run can be drawn."""
    drawn = [
        Drawn(run.label, style, curves(scenario, run.trace, run.certificate.get("notes")), run.score, number)
        for number, (run, style) in enumerate(zip(runs, styles([run.controller for run in runs]), strict=True))
        if run.can_be_drawn
    ]
    if not drawn:
        return []
    return [
        speed(scenario, drawn),
        error(scenario, drawn),
        stop(scenario, drawn),
        notch(scenario, drawn),
        force(scenario, drawn),
        *flags(scenario, drawn),
        *told_figures(scenario, drawn),
    ]


def speed(scenario: Scenario, runs: Sequence[Drawn]) -> Figure:
    """Speed over distance with limit, target and grade (fig. 7 of the paper), and enlarged views of the largest
    deviations."""
    caption = (
        "Train, target and speed limit in force for the whole train; the grade of the line (up positive); close views "
        "where a train differs most from the target, in each half."
    )
    near = [speed_near(scenario, runs, place_m) for place_m in widest_places(scenario, runs)]
    return Figure(
        "speed", "Speed over distance", caption, [speed_over_distance(scenario, runs), grade(scenario), *near]
    )


def speed_over_distance(scenario: Scenario, runs: Sequence[Drawn]) -> Chart:
    """Speed of each run, the limit under the whole train, and the target."""
    target = Target(scenario.target)
    planned_s = np.linspace(0.0, target.stop_time_s, _POINTS)
    front_m = np.linspace(0.0, scenario.plan.distance_m, _POINTS)
    limit_kmh = limits_under_train(scenario.line.speed_limit_mps, front_m, scenario.train.length_m) * KMH
    wanted_m = np.asarray(target.position_m(planned_s))
    every = [
        Curve("limit", front_m, limit_kmh, _LIMIT, "km/h"),
        Curve("target", wanted_m, np.asarray(target.speed_mps(planned_s)) * KMH, TARGET, "km/h"),
        *(Curve(run.label, run.curves.position_m, run.curves.speed_kmh, run.style.look, "km/h", run=run.number)
          for run in runs),
    ]  # fmt: skip
    return Chart(every, "", "speed (km/h)", _whole_m(scenario), (0.0, None), sync=_DISTANCE, height_px=230)


def _whole_m(scenario: Scenario) -> tuple[float, float]:
    return 0.0, scenario.plan.distance_m * 1.01


def widest_places(scenario: Scenario, runs: Sequence[Drawn]) -> list[float]:
    """Positions at which a run deviates most from the target, in each half of the distance, in m.

    Only where the target is faster than half its highest speed, because close to standstill a metre takes very long.
    """
    target = Target(scenario.target)
    place_m = np.linspace(0.0, scenario.plan.distance_m, _POINTS)
    wanted_kmh = np.asarray(target.speed_mps(target.time_s(place_m))) * KMH
    off_kmh = np.zeros(_POINTS)
    for run in runs:
        at_m = run.curves.position_m
        # A gap begins at the last known place of the train.
        at_m = np.where(np.isnan(at_m), np.roll(at_m, 1), at_m)
        known = np.interp(place_m, at_m, run.curves.speed_kmh, right=np.nan)
        off_kmh = np.fmax(off_kmh, np.abs(known - wanted_kmh))
    off_kmh[wanted_kmh < wanted_kmh.max() / 2] = 0.0
    half = _POINTS // 2
    return [float(place_m[np.argmax(off_kmh[:half])]), float(place_m[half + np.argmax(off_kmh[half:])])]


def speed_near(scenario: Scenario, runs: Sequence[Drawn], place_m: float) -> Chart:
    """Speed over distance around one position, enlarged enough to tell the runs apart."""
    reach_m = scenario.plan.distance_m * _NEAR_SHARE
    place_m = min(max(place_m, reach_m), scenario.plan.distance_m - reach_m)
    target = Target(scenario.target)
    begin_s, end_s = target.time_s(np.array([place_m - reach_m, place_m + reach_m]))
    planned_s = np.linspace(float(begin_s), float(end_s), _POINTS // 4)
    wanted_kmh = np.asarray(target.speed_mps(planned_s)) * KMH
    every = [Curve("target", np.asarray(target.position_m(planned_s)), wanted_kmh, TARGET, "km/h")]
    for run in runs:
        # With the gaps.
        near = ~(np.abs(run.curves.position_m - place_m) > reach_m)
        x, y = run.curves.position_m[near], run.curves.speed_kmh[near]
        every.append(Curve(run.label, x, y, run.style.look, "km/h", run=run.number))
    return Chart(every, _DISTANCE, "speed (km/h)", (place_m - reach_m, place_m + reach_m), height_px=130, share=0.5)


def grade(scenario: Scenario) -> Chart:
    """Grade of the line from the scenario."""
    rows = [row for row in scenario.line.grade_permil if row[0] < scenario.plan.distance_m]
    starts = [max(0.0, start_m) for start_m, _ in rows] + [scenario.plan.distance_m]
    values = [value for _, value in rows]
    stairs = Curve("grade", np.array(starts), np.array([*values, values[-1]]), Look("dim", 0.8), "‰", is_step=True,
                   is_filled=True)  # fmt: skip
    return Chart([stairs], _DISTANCE, "grade (‰)", _whole_m(scenario), areas=[ZERO], sync=_DISTANCE, height_px=65)


def _rows(
    scenario: Scenario, name: str, title: str, caption: str, charts: Sequence[tuple[Sequence[Curve], str]],
    y_names: dict[float, str] | None = None, height_px: int = 0, has_zero: bool = True,
) -> Figure:  # fmt: skip
    """One chart for each law over time, all with the same scales."""
    values = [curve.y[np.isfinite(curve.y)] for every, _ in charts for curve in every]
    low = min((float(one.min()) for one in values if len(one)), default=0.0)
    high = max((float(one.max()) for one in values if len(one)), default=1.0)
    margin = 0.05 * ((high - low) or 1.0)
    bounds = (min(y_names) - 0.5, max(y_names) + 0.5) if y_names else (low - margin, high + margin)
    height_px = height_px or (_ROW_AMONG_PX if len(charts) > 1 else _ROW_PX)
    made = [
        Chart(every, TIME if place == len(charts) - 1 else "", y_label, (0.0, scenario.plan.running_time_s * 1.01),
              bounds, [ZERO] if has_zero else [], y_names=y_names or {}, sync=TIME, height_px=height_px)
        for place, (every, y_label) in enumerate(charts)
    ]  # fmt: skip
    return Figure(name, title, caption, made)


def error(scenario: Scenario, runs: Sequence[Drawn]) -> Figure:
    """Set-point minus speed (fig. 8 of the paper)."""
    caption = "Set-point minus true speed; positive: the train is too slow."
    charts = [
        ([Curve(run.label, run.curves.time_s, run.curves.error_kmh, run.style.alone, "km/h", run=run.number,
                column=ERROR)], "error (km/h)")
        for run in runs
    ]  # fmt: skip
    return _rows(scenario, "error", "Speed error over time", caption, charts)


def notch(scenario: Scenario, runs: Sequence[Drawn]) -> Figure:
    """Notch as commanded."""
    caption = "Notch as commanded; negative values brake."
    charts = [
        ([Curve(run.label, run.curves.notch_s, run.curves.notch, run.style.alone, is_step=True, run=run.number,
                column="notch_command")], "notch")
        for run in runs
    ]  # fmt: skip
    return _rows(scenario, "notch", "Notch over time", caption, charts)


def force(scenario: Scenario, runs: Sequence[Drawn]) -> Figure:
    """Traction and brake force."""
    caption = "Forces applied by the train: traction force positive, brake force negative."
    many = len(runs) > 1
    charts = [
        ([Curve(f"{run.label}: {name}" if many else name, run.curves.time_s, values, run.style.alone, "kN",
                run=run.number, column=column)
          for name, values, column in (("traction", run.curves.traction_kn, "traction_n"),
                                       ("brake", -run.curves.brake_kn, "brake_n"))], "force (kN)")
        for run in runs
    ]  # fmt: skip
    return _rows(scenario, "force", "Traction and brake force over time", caption, charts)


def flags(scenario: Scenario, runs: Sequence[Drawn]) -> list[Figure]:
    """One figure for each bit field reported by laws, with the runs that have it."""
    notes = {note.name: note for run in runs for note, _ in run.curves.told(flags=True)}
    found = []
    for name, note in notes.items():
        telling = [run for run in runs if name in {told.name for told, _ in run.curves.told(flags=True)}]
        used = flag_sets(telling, name)
        charts = [([_flags(run, name, used)], note.title) for run in telling]
        names = {float(row): _flag_names(bits, note.bits) for row, bits in enumerate(used)}
        caption = "As reported by the controller (CTL_STAT); laws that do not report it are left out."
        height_px = _NAME_PX * max(3, len(used))
        title = f"{_capital(note.title)} over time"
        found.append(_rows(scenario, name, title, caption, charts, names, height_px, has_zero=False))
    return found


def flag_sets(runs: Sequence[Drawn], name: str) -> list[int]:
    """Every set of flags reported by a run in the note of that name, as bit fields."""
    told = (_told(run, name)[1] for run in runs)
    return sorted({int(value) for values in told for value in np.unique(values[np.isfinite(values)])})


def _flags(run: Drawn, name: str, used: Sequence[int]) -> Curve:
    """A bit field of a law, its sets as rows."""
    _, values = _told(run, name)
    row = np.where(np.isnan(values), np.nan, np.searchsorted(np.asarray(used), values))
    return Curve(run.label, run.curves.status_s, row, run.style.alone, is_step=True, run=run.number, column=name)


def _told(run: Drawn, name: str) -> tuple[ReportedNote, FloatArray]:
    return next((note, values) for note, values in run.curves.notes if note.name == name)


def _flag_names(value: int, known: Sequence[str]) -> str:
    names = [name for place, name in enumerate(known) if value >> place & 1]
    if unknown := value >> len(known):
        names.append(f"bits {unknown << len(known):#x}")
    return "+".join(names) or "none"


def told_figures(scenario: Scenario, runs: Sequence[Drawn]) -> list[Figure]:
    """One figure of the numbers reported by laws, with the runs that have them."""
    telling = [run for run in runs if run.curves.told(flags=False)]
    notes = {note.name: note for run in telling for note, _ in run.curves.told(flags=False)}
    # A number that stayed at 0 is drawn together with one that did not.
    notes |= {note.name: note for run in telling for note, _ in run.curves.notes if not note.bits}
    if not notes:
        return []
    symbols = ", ".join(note.symbol or note.unit for note in notes.values() if note.symbol or note.unit)
    charts = [
        (list(_numbers(run, list(notes), len(telling) > 1)), symbols or "number")
        for run in telling
    ]  # fmt: skip
    title = f"{_capital(' and '.join(note.title for note in notes.values()))} over time"
    caption = "As reported by the controller (CTL_STAT); laws that report no such figure are left out."
    return [_rows(scenario, next(iter(notes)), title, caption, charts, has_zero=False)]


def _numbers(run: Drawn, names: Sequence[str], is_named: bool) -> Iterator[Curve]:
    told = [(note, values) for note, values in run.curves.notes if note.name in names]
    for place, (note, values) in enumerate(told):
        look = run.style.alone if place == 0 else _LIMIT
        label = f"{run.label}: {note.label}" if is_named else note.label
        yield Curve(label, run.curves.status_s, values, look, note.unit, is_step=True, run=run.number, column=note.name)


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def stop(scenario: Scenario, runs: Sequence[Drawn]) -> Figure:
    """Distance over time (fig. 9 of the paper), and the stop."""
    plan = scenario.plan
    caption = (
        f"The target stop is {plan.distance_m:g} m at {plan.running_time_s:g} s; the box shows the allowed errors, a "
        "marker where and when each train stood."
    )
    if outside := outside_window(scenario, runs):
        caption += f" Outside the right-hand picture: {', '.join(outside)}."
    charts = [distance_over_time(scenario, runs), stop_near(scenario, runs)]
    return Figure("stop", "Distance over time, and the stop", caption, charts)


def _target_stop(scenario: Scenario) -> Point:
    plan = scenario.plan
    return Point("target stop", plan.running_time_s, plan.distance_m, Look("ink", marker="+", marker_px=9.0))


def distance_over_time(scenario: Scenario, runs: Sequence[Drawn]) -> Chart:
    """Distance of each run and of the target, the target stop marked."""
    target = Target(scenario.target)
    planned_s = np.linspace(0.0, target.stop_time_s, _POINTS)
    every = [
        Curve("target", planned_s, np.asarray(target.position_m(planned_s)), TARGET, "m"),
        *(Curve(run.label, run.curves.time_s, run.curves.position_m, run.style.look, "m", run=run.number,
                column="true_position_m") for run in runs),
    ]  # fmt: skip
    bounds = (0.0, scenario.plan.running_time_s * 1.01)
    return Chart(every, TIME, "distance (m), whole run", bounds, (0.0, None), points=[_target_stop(scenario)],
                 sync=TIME, height_px=270, share=0.5)  # fmt: skip


def stop_window(scenario: Scenario, runs: Sequence[Drawn]) -> tuple[float, float]:
    """Half width in s and half height in m of the chart of the stop: includes all stops, as long as it stays
    readable."""
    plan = scenario.plan
    errors_m = [found for run in runs if (found := run.score.values[STOP_ERROR.key]) is not None]
    errors_s = [found for run in runs if (found := run.score.values[TIME_ERROR.key]) is not None]
    half_m = max([1.4 * plan.stop_error_max_m, *(1.3 * found for found in errors_m)])
    half_s = max([1.4 * plan.time_error_max_s, *(1.3 * found for found in errors_s)])
    return max(0.5, min(half_s, 6.0)), min(max(half_m, _STOP_MIN_M), _STOP_MAX_M)


def outside_window(scenario: Scenario, runs: Sequence[Drawn]) -> list[str]:
    """Labels of the runs whose stop lies outside the chart of the stop."""
    half_s, half_m = stop_window(scenario, runs)
    windows = {STOP_ERROR.key: half_m, TIME_ERROR.key: half_s}

    def outside(score: Score) -> bool:
        return any((found := score.values[key]) is None or found > half for key, half in windows.items())

    return [run.label for run in runs if outside(run.score)]


def stop_near(scenario: Scenario, runs: Sequence[Drawn]) -> Chart:
    """Distance over time around the target stop, with the allowed errors and the point where each train stood."""
    plan = scenario.plan
    half_s, half_m = stop_window(scenario, runs)
    allowed = Area(
        (plan.running_time_s - plan.time_error_max_s, plan.running_time_s + plan.time_error_max_s),
        (plan.distance_m - plan.stop_error_max_m, plan.distance_m + plan.stop_error_max_m),
        "allowed",
        "allowed",
    )
    every, points = [], []
    for run in runs:
        near = np.abs(run.curves.time_s - plan.running_time_s) < 2 * half_s
        x, y = run.curves.time_s[near], run.curves.position_m[near]
        every.append(Curve(run.label, x, y, run.style.look, "m", run=run.number))
        late_s, past_m = (run.score.with_sign(criterion) for criterion in (TIME_ERROR, STOP_ERROR))
        if late_s is not None and past_m is not None:
            x_s, y_m = plan.running_time_s + late_s, plan.distance_m + past_m
            points.append(Point(run.label, x_s, y_m, run.style.look, run.number))
    return Chart(
        every, TIME, "distance (m), at the stop",
        (plan.running_time_s - half_s, plan.running_time_s + half_s),
        (plan.distance_m - half_m, plan.distance_m + half_m),
        [allowed], [*points, _target_stop(scenario)], height_px=270, share=0.5,
    )  # fmt: skip


def run_figure(scenario: Scenario, run: Drawn) -> Figure:
    """The picture of one run that ``railhil plot`` draws: speed over distance, error and notch over time."""
    track = speed_over_distance(scenario, [run])
    charts = [track, grade(scenario), *error(scenario, [run]).charts, *notch(scenario, [run]).charts]
    return Figure("run", scenario.title, "", charts)


def draw(scenario: Scenario, trace: Trace, out: Path) -> None:
    """Draw one run into a file whose bytes depend only on the record (fixed ids, no date)."""
    # Only files need matplotlib.
    from railhil.report.pictures import save

    save(
        run_figure(scenario, Drawn("train", Style(), curves(scenario, trace), score(scenario, trace))),
        out,
        scenario.title,
    )
