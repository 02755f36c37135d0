"""The drawing functions, one per pair of axes, for the pictures of ``railhil plot`` and the report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.ticker import MultipleLocator

from railhil.scenarios.model import Scenario
from railhil.scenarios.target import Target
from railhil.supervisor.criteria import STOP_ERROR, TIME_ERROR
from railhil.supervisor.events.event import RecordedEvent
from railhil.supervisor.measures import KMH, limits_under_train
from railhil.supervisor.notes import ToldNote
from railhil.supervisor.report.recorded import Curves
from railhil.supervisor.report.styles import Style
from railhil.supervisor.score import Score
from railhil.supervisor.trace import FloatArray

_POINTS = 800
#: Half height of the picture of the stop, m: minimum and maximum.
_STOP_MIN_M, _STOP_MAX_M = 0.4, 3.0
#: Half width of an enlarged view, as a share of the distance.
_NEAR_SHARE = 0.02


@dataclass(frozen=True, slots=True)
class Drawn:
    """One run ready to be drawn: its name, style, curves and events."""

    label: str
    style: Style
    curves: Curves
    score: Score
    events: Sequence[RecordedEvent] = ()


@contextmanager
def drawing(fonttype: str = "path") -> Iterator[None]:
    """Settings under which the bytes of a picture depend only on its content.

    :param fonttype: ``path`` for a picture that looks the same everywhere, ``none`` for text that stays text.
    """
    settings: dict[Any, Any] = {
        "svg.hashsalt": "railhil",
        "svg.fonttype": fonttype,
        # Names of laws and lines are literal text, whatever they contain.
        "text.parse_math": False,
        "font.size": 9,
        "font.family": "sans-serif",
        "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial"],
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "0.9",
        "grid.linewidth": 0.5,
    }
    with mpl.rc_context(settings):
        yield


def speed_over_distance(axes: Axes, scenario: Scenario, runs: Sequence[Drawn]) -> None:
    """Speed of each run over distance, with limit and target (fig. 7 of the paper)."""
    target = Target(scenario.target)
    planned_s = np.linspace(0.0, target.stop_time_s, _POINTS)
    front_m = np.linspace(0.0, scenario.plan.distance_m, _POINTS)
    limit_kmh = limits_under_train(scenario.line.speed_limit_mps, front_m, scenario.train.length_m) * KMH
    axes.plot(front_m, limit_kmh, color="0.3", linestyle=":", linewidth=1.4, label="limit")
    axes.plot(
        np.asarray(target.position_m(planned_s)),
        np.asarray(target.speed_mps(planned_s)) * KMH,
        color="0.75",
        linewidth=3.5,
        label="target",
    )
    for run in runs:
        axes.plot(run.curves.position_m, run.curves.speed_kmh, label=run.label, **run.style.line)
    axes.set(ylabel="speed (km/h)", ylim=(0, None))


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
        # A gap begins where the train was last seen.
        at_m = np.where(np.isnan(at_m), np.roll(at_m, 1), at_m)
        known = np.interp(place_m, at_m, run.curves.speed_kmh, right=np.nan)
        off_kmh = np.fmax(off_kmh, np.abs(known - wanted_kmh))
    off_kmh[wanted_kmh < wanted_kmh.max() / 2] = 0.0
    half = _POINTS // 2
    return [float(place_m[np.argmax(off_kmh[:half])]), float(place_m[half + np.argmax(off_kmh[half:])])]


def speed_near(axes: Axes, scenario: Scenario, runs: Sequence[Drawn], place_m: float) -> None:
    """Speed over distance around one position, enlarged enough to tell the runs apart."""
    reach_m = scenario.plan.distance_m * _NEAR_SHARE
    place_m = min(max(place_m, reach_m), scenario.plan.distance_m - reach_m)
    target = Target(scenario.target)
    begin_s, end_s = target.time_s(np.array([place_m - reach_m, place_m + reach_m]))
    planned_s = np.linspace(float(begin_s), float(end_s), _POINTS // 4)
    wanted_kmh = np.asarray(target.speed_mps(planned_s)) * KMH
    axes.plot(np.asarray(target.position_m(planned_s)), wanted_kmh, color="0.75", linewidth=3.5)
    for run in runs:
        # With the gaps.
        near = ~(np.abs(run.curves.position_m - place_m) > reach_m)
        axes.plot(run.curves.position_m[near], run.curves.speed_kmh[near], **run.style.line)
    axes.set_xlim(place_m - reach_m, place_m + reach_m)


def grade(axes: Axes, scenario: Scenario) -> None:
    """Grade of the line from the scenario."""
    rows = [row for row in scenario.line.grade_permil if row[0] < scenario.plan.distance_m]
    starts = [max(0.0, start_m) for start_m, _ in rows] + [scenario.plan.distance_m]
    values = [value for _, value in rows]
    axes.stairs(values, starts, fill=True, color="0.85")
    axes.stairs(values, starts, color="0.3", linewidth=0.8)
    axes.axhline(0, color="0.6", linewidth=0.6)
    axes.set(ylabel="grade (‰)")


def speed_error(axes: Axes, run: Drawn) -> None:
    """Set-point minus speed over time (fig. 8 of the paper)."""
    axes.plot(run.curves.time_s, run.curves.error_kmh, **run.style.alone)
    axes.axhline(0, color="0.6", linewidth=0.6)


def notch(axes: Axes, run: Drawn) -> None:
    """Notch as commanded, over time."""
    # Only points where it changes, and the end: it is sent 25 times per control period.
    count = len(run.curves.notch)
    at = np.union1d(np.flatnonzero(np.diff(run.curves.notch, prepend=np.nan)), np.arange(count)[-1:])
    axes.step(run.curves.notch_s[at], run.curves.notch[at], where="post", **run.style.alone)
    axes.axhline(0, color="0.6", linewidth=0.6)


def force(axes: Axes, run: Drawn) -> None:
    """Traction (up) and brake force (down) over time."""
    axes.plot(run.curves.time_s, run.curves.traction_kn - run.curves.brake_kn, **run.style.alone)
    axes.axhline(0, color="0.6", linewidth=0.6)


def flag_sets(runs: Sequence[Drawn], name: str) -> list[int]:
    """Every set of flags reported by a run in the note of that name, as bit fields."""
    told = (_told(run, name)[1] for run in runs)
    return sorted({int(value) for values in told for value in np.unique(values[np.isfinite(values)])})


def flags(axes: Axes, run: Drawn, name: str, used: Sequence[int]) -> None:
    """A bit field of a law over time.

    :param name: of the note.
    :param used: the rows of the picture, from :func:`flag_sets`.
    """
    note, values = _told(run, name)
    row = np.where(np.isnan(values), np.nan, np.searchsorted(np.asarray(used), values))
    axes.step(run.curves.status_s, row, where="post", **run.style.alone)
    axes.set_yticks(range(len(used)), [_flag_names(bits, note.bits) for bits in used], fontsize=8)
    axes.set_ylim(-0.5, len(used) - 0.5)


def _told(run: Drawn, name: str) -> tuple[ToldNote, FloatArray]:
    return next((note, values) for note, values in run.curves.notes if note.name == name)


def _flag_names(value: int, known: Sequence[str]) -> str:
    names = [name for place, name in enumerate(known) if value >> place & 1]
    if unknown := value >> len(known):
        names.append(f"bits {unknown << len(known):#x}")
    return "+".join(names) or "none"


#: Styles that distinguish the figures of one law.
_FIGURE_LINES: tuple[dict[str, Any], ...] = ({}, {"color": "0.45", "linestyle": ":", "linewidth": 1.2})


def figures(axes: Axes, run: Drawn, names: Sequence[str]) -> None:
    """Figures reported by a law, over time.

    :param names: of the notes of all laws in the picture.
    """
    told = [(note, values) for note, values in run.curves.notes if note.name in names]
    for (note, values), line in zip(told, _FIGURE_LINES, strict=False):
        axes.step(run.curves.status_s, values, where="post", label=note.label, **{**run.style.alone, **line})
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -0.05), max(high, 1.05))


def distance_over_time(axes: Axes, scenario: Scenario, runs: Sequence[Drawn]) -> None:
    """Distance over time (fig. 9 of the paper), the target stop marked."""
    target = Target(scenario.target)
    planned_s = np.linspace(0.0, target.stop_time_s, _POINTS)
    axes.plot(planned_s, np.asarray(target.position_m(planned_s)), color="0.75", linewidth=3.5, label="target")
    for run in runs:
        axes.plot(run.curves.time_s, run.curves.position_m, label=run.label, **run.style.line)
    _mark_stop(axes, scenario)
    axes.set(xlabel="time (s)", ylabel="distance (m)", ylim=(0, None), title="whole run")


def stop_window(scenario: Scenario, runs: Sequence[Drawn]) -> tuple[float, float]:
    """Half width in s and half height in m of the picture of the stop: includes all stops, as long as it stays
    readable."""
    plan = scenario.plan
    errors_m = [error for run in runs if (error := run.score.values[STOP_ERROR.key]) is not None]
    errors_s = [error for run in runs if (error := run.score.values[TIME_ERROR.key]) is not None]
    half_m = max([1.4 * plan.stop_error_max_m, *(1.3 * error for error in errors_m)])
    half_s = max([1.4 * plan.time_error_max_s, *(1.3 * error for error in errors_s)])
    return max(0.5, min(half_s, 6.0)), min(max(half_m, _STOP_MIN_M), _STOP_MAX_M)


def outside_window(scenario: Scenario, runs: Sequence[Drawn]) -> list[str]:
    """Labels of the runs whose stop lies outside the picture of the stop."""
    half_s, half_m = stop_window(scenario, runs)
    windows = {STOP_ERROR.key: half_m, TIME_ERROR.key: half_s}

    def outside(score: Score) -> bool:
        return any((error := score.values[key]) is None or error > half for key, half in windows.items())

    return [run.label for run in runs if outside(run.score)]


def stop(axes: Axes, scenario: Scenario, runs: Sequence[Drawn]) -> None:
    """Distance over time around the target stop, with the allowed errors and the point where each train stood."""
    plan = scenario.plan
    half_s, half_m = stop_window(scenario, runs)
    axes.add_patch(
        Rectangle(
            (plan.running_time_s - plan.time_error_max_s, plan.distance_m - plan.stop_error_max_m),
            2 * plan.time_error_max_s,
            2 * plan.stop_error_max_m,
            facecolor="0.93",
            edgecolor="0.5",
            linewidth=0.8,
            label="allowed",
        )
    )
    for run in runs:
        near = np.abs(run.curves.time_s - plan.running_time_s) < 2 * half_s
        axes.plot(run.curves.time_s[near], run.curves.position_m[near], **run.style.line)
        late_s, past_m = (run.score.with_sign(criterion) for criterion in (TIME_ERROR, STOP_ERROR))
        if late_s is not None and past_m is not None:
            point = (plan.running_time_s + late_s, plan.distance_m + past_m)
            axes.plot(*point, zorder=4, **run.style.marker)
    _mark_stop(axes, scenario)
    axes.set_xlim(plan.running_time_s - half_s, plan.running_time_s + half_s)
    axes.set_ylim(plan.distance_m - half_m, plan.distance_m + half_m)
    axes.ticklabel_format(useOffset=False)
    axes.set(xlabel="time (s)", title="at the stop")


def _mark_stop(axes: Axes, scenario: Scenario) -> None:
    plan = scenario.plan
    axes.plot(
        plan.running_time_s, plan.distance_m, "+", color="black", markersize=11, markeredgewidth=1.2, zorder=5,
        label="target stop",
    )  # fmt: skip


def time_axis(axes: Axes, scenario: Scenario) -> None:
    """The common time axis of all pictures."""
    axes.set_xlim(0, scenario.plan.running_time_s * 1.01)
    if 100 < scenario.plan.running_time_s < 400:
        axes.xaxis.set_major_locator(MultipleLocator(20))


def legend(axes: Axes, columns: int = 4) -> None:
    """Legend of lines above the axes, where there are no curves."""
    axes.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, frameon=False, borderaxespad=0.2, markerscale=0
    )
