"""The figures of the report as inline SVG: text stays text, identifiers are unique in the page."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from matplotlib.axes import Axes

# What a figure would load when it is drawn, in each process that draws.
from matplotlib.backends import backend_svg as backend_svg
from matplotlib.figure import Figure

from railhil.common.shared_out import shared_out
from railhil.scenarios.model import AnyScenario, Scenario
from railhil.scenarios.system import system_named
from railhil.supervisor.jitter import LATE_MS, LATE_SHARE_MAX
from railhil.supervisor.report import events_panel, panels
from railhil.supervisor.report.histogram import Lateness, lateness
from railhil.supervisor.report.jitter_panel import timing_of
from railhil.supervisor.report.panels import Drawn
from railhil.supervisor.report.recorded import RecordedRun, curves
from railhil.supervisor.report.styles import styles
from railhil.supervisor.sampled import drawn_trace

_WIDTH_IN = 8.5
_LEFT_IN, _RIGHT_IN, _BOTTOM_IN = 0.9, 0.15, 0.5
#: Position of the axis titles left of the axes: the same for all figures, with room for wide tick labels.
_TITLE_IN = 0.7
#: Height of a legend row, and of the row of one law in stacked axes.
_LEGEND_IN, _ROW_IN, _GAP_IN = 0.2, 1.05, 0.3
#: Height of one name in the picture of a bit field.
_FLAGS_IN = 0.18
_LEGEND_COLUMNS = 4
#: Space in a legend: for the line sample with its margins, and for a character.
_SAMPLE_IN, _LETTER_IN = 0.6, 0.075
_LONG_NUMBER = re.compile(r"(\d\.\d\d)\d+")
_IDENTIFIER = re.compile(r'(\bid="|url\(#|href="#)')


@dataclass(frozen=True, slots=True)
class Picture:
    """One figure: ``name`` is its anchor, ``svg`` the element itself."""

    name: str
    title: str
    caption: str
    svg: str


@dataclass(frozen=True, slots=True)
class Record:
    """Data for the panels: the runs that can be drawn, and the lateness of real-time runs."""

    scenario: Scenario
    runs: Sequence[Drawn]
    late: Sequence[Lateness]


@dataclass(frozen=True, slots=True)
class Panel:
    """One kind of figure by its name; ``draw`` gives no picture if the record has no data for it."""

    name: str
    draw: Callable[[Record], list[Picture]]


def system_pictures(scenario: AnyScenario, runs: Sequence[RecordedRun]) -> list[Picture]:
    """The figures of the scenario's system, which gets the records with their gaps
    (:class:`railhil.supervisor.sampled.DrawnTrace`)."""
    drawn = [replace(run, trace=drawn_trace(run.scenario, run.trace)) for run in runs]
    found: list[Picture] = system_named(scenario.system).part("pictures")(scenario, drawn)
    return found


def pictures(scenario: Scenario, runs: Sequence[RecordedRun], shown: Sequence[Panel] | None = None) -> list[Picture]:
    """All figures of the report, in reading order; empty if no run can be drawn.

    :param shown: None: :data:`ATO_PANELS`.
    """
    drawn = [
        Drawn(run.label, style, curves(scenario, run.trace, run.certificate.get("notes")), run.score, run.events)
        for run, style in zip(runs, styles([run.controller for run in runs]), strict=True)
        if run.can_be_drawn
    ]
    if not drawn:
        return []
    late = [
        Lateness(run.label, style, **timing_of(run)["histogram"])
        for run, style in zip(runs, styles([run.controller for run in runs]), strict=True)
        if timing_of(run).get("histogram")
    ]
    return panel_pictures(Record(scenario, drawn, late), shown or ATO_PANELS)


def panel_pictures(record: Record, shown: Sequence[Panel]) -> list[Picture]:
    """The figures of some panels, in their order."""
    with panels.drawing("none"):
        drawn: list[list[Picture]] = shared_out([partial(panel.draw, record) for panel in shown])
    return [picture for pictures in drawn for picture in pictures]


def svg(figure: Figure, name: str, title: str) -> str:
    """The figure as an element of a page.

    Coordinates keep two decimals (a hundredth of a point), which halves the file; identifiers are prefixed with the
    name; the style sheet, which would apply to the whole page, is left to the page.
    """
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    body = text.getvalue()
    body = body[body.index("<svg") :]
    body = re.sub(r"<defs>\s*<style.*?</style>\s*</defs>", "", body, flags=re.DOTALL)
    body = _IDENTIFIER.sub(rf"\g<1>{name}-", body)
    body = _LONG_NUMBER.sub(r"\1", body)
    # The page sets the width; the height follows from the view box.
    body = re.sub(r'^<svg([^>]*?) width="[^"]*"', r"<svg\1", body, count=1)
    body = re.sub(r'^<svg([^>]*?) height="[^"]*"', rf'<svg\1 role="img" aria-label="{title}"', body, count=1)
    return body.strip()


def _legend(labels: Sequence[str]) -> tuple[int, int]:
    """Number of columns that fit with the longest name, and of rows."""
    widest_in = _SAMPLE_IN + _LETTER_IN * max(map(len, labels))
    columns = max(1, min(_LEGEND_COLUMNS, int((_WIDTH_IN - _LEFT_IN - _RIGHT_IN) / widest_in)))
    return columns, -(-len(labels) // columns)


def _axes(
    figure: Figure, bottom_in: float, height_in: float, left: float = 0.0, width: float = 1.0, **given: Any
) -> Axes:
    """Axes at a height in inches above the figure's lower edge; ``left``, ``width``: shares of the usable width."""
    whole_in = figure.get_figheight()
    usable = (_WIDTH_IN - _LEFT_IN - _RIGHT_IN) / _WIDTH_IN
    box = (_LEFT_IN / _WIDTH_IN + left * usable, bottom_in / whole_in, width * usable, height_in / whole_in)
    axes: Axes = figure.add_axes(box, **given)
    axes.yaxis.set_label_coords(-_TITLE_IN / (box[2] * _WIDTH_IN), 0.5)
    return axes


def _speed(scenario: Scenario, runs: Sequence[Drawn]) -> Picture:
    title = "Speed over distance"
    columns, legend_rows = _legend(["limit", "target", *(run.label for run in runs)])
    head_in = _LEGEND_IN * legend_rows + 0.1
    close_in = 1.5 + _BOTTOM_IN + 0.1
    figure = Figure(figsize=(_WIDTH_IN, close_in + _BOTTOM_IN + 0.8 + 0.15 + 2.7 + head_in))
    low = _axes(figure, close_in + _BOTTOM_IN, 0.8)
    high = _axes(figure, close_in + _BOTTOM_IN + 0.8 + 0.15, 2.7, sharex=low)
    panels.speed_over_distance(high, scenario, runs)
    panels.legend(high, columns)
    panels.grade(low, scenario)
    high.tick_params(labelbottom=False)
    low.set(xlabel="distance (m)", xlim=(0, scenario.plan.distance_m * 1.01))
    for place_m, left in zip(panels.widest_places(scenario, runs), (0.0, 0.55), strict=True):
        near = _axes(figure, _BOTTOM_IN, 1.5, left, 0.45)
        panels.speed_near(near, scenario, runs, place_m)
        near.set(xlabel="distance (m)", ylabel="speed (km/h)" if left == 0.0 else "")
    caption = (
        "Train, target and speed limit in force for the whole train; the grade of the line (up positive); close views "
        "where a train differs most from the target, in each half."
    )
    return Picture("speed", title, caption, svg(figure, "speed", title))


def _distance(scenario: Scenario, runs: Sequence[Drawn]) -> Picture:
    title = "Distance over time, and the stop"
    columns, legend_rows = _legend(["target", "target stop", "allowed", *(run.label for run in runs)])
    head_in = _LEGEND_IN * legend_rows + 0.35
    figure = Figure(figsize=(_WIDTH_IN, _BOTTOM_IN + 2.9 + head_in))
    whole = _axes(figure, _BOTTOM_IN, 2.9, 0.0, 0.44)
    near = _axes(figure, _BOTTOM_IN, 2.9, 0.57, 0.43)
    panels.distance_over_time(whole, scenario, runs)
    whole.set_xlim(0, scenario.plan.running_time_s * 1.01)
    panels.stop(near, scenario, runs)
    handles, labels = whole.get_legend_handles_labels()
    box, allowed = near.get_legend_handles_labels()
    extra = [(handle, label) for handle, label in zip(box, allowed, strict=True) if label == "allowed"]
    figure.legend(
        handles + [handle for handle, _ in extra],
        labels + [label for _, label in extra],
        loc="upper left",
        bbox_to_anchor=(_LEFT_IN / _WIDTH_IN, 1.0),
        ncols=columns,
        frameon=False,
        borderaxespad=0.2,
    )
    plan = scenario.plan
    caption = (
        f"The target stop is {plan.distance_m:g} m at {plan.running_time_s:g} s; the box shows the allowed errors, a "
        "marker where and when each train stood."
    )
    if outside := panels.outside_window(scenario, runs):
        caption += f" Outside the right-hand picture: {', '.join(outside)}."
    return Picture("stop", title, caption, svg(figure, "stop", title))


def _stacked(
    scenario: Scenario, runs: Sequence[Drawn], name: str, title: str, unit: str, caption: str,
    draw: Callable[[Axes, Drawn], None], height_in: float = _ROW_IN, legend: bool = False,
) -> Picture:  # fmt: skip
    """One row of axes per law, all with the same scales, labelled with the law if there are several."""
    row_in = height_in * (1.0 if len(runs) > 1 else 1.4)
    named = len(runs) > 1
    head_in = 0.12 + (_LEGEND_IN if named or legend else 0.0)
    gap_in = _GAP_IN if named else 0.15
    whole_in = _BOTTOM_IN + len(runs) * row_in + (len(runs) - 1) * gap_in + head_in
    figure = Figure(figsize=(_WIDTH_IN, whole_in))
    first: Axes | None = None
    for place, run in enumerate(runs):
        bottom_in = _BOTTOM_IN + (len(runs) - 1 - place) * (row_in + gap_in)
        axes = _axes(figure, bottom_in, row_in, sharex=first, sharey=first)
        first = first or axes
        draw(axes, run)
        panels.time_axis(axes, scenario)
        axes.set_ylabel(unit)
        if named:
            axes.set_title(run.label, loc="left", fontsize=9, pad=3)
        if legend and place == 0:
            axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False, borderaxespad=0.2)
        if place < len(runs) - 1:
            axes.tick_params(labelbottom=False)
        else:
            axes.set_xlabel("time (s)")
    return Picture(name, title, caption, svg(figure, name, title))


def _error(scenario: Scenario, runs: Sequence[Drawn]) -> Picture:
    caption = "Set-point minus true speed; positive: the train is too slow."
    return _stacked(scenario, runs, "error", "Speed error over time", "error (km/h)", caption, panels.speed_error)


def _notch(scenario: Scenario, runs: Sequence[Drawn]) -> Picture:
    caption = "Notch as commanded; negative values brake."
    return _stacked(scenario, runs, "notch", "Notch over time", "notch", caption, panels.notch)


def _force(scenario: Scenario, runs: Sequence[Drawn]) -> Picture:
    caption = "Forces applied by the train: traction force positive, brake force negative."
    return _stacked(scenario, runs, "force", "Traction and brake force over time", "force (kN)", caption, panels.force)


def _flags(scenario: Scenario, runs: Sequence[Drawn]) -> list[Picture]:
    """One picture for each bit field reported by laws, with the runs that have it."""
    notes = {note.name: note for run in runs for note, _ in run.curves.told(flags=True)}
    found = []
    for name, note in notes.items():
        telling = [run for run in runs if name in {told.name for told, _ in run.curves.told(flags=True)}]
        used = panels.flag_sets(telling, name)

        def draw(axes: Axes, run: Drawn, name: str = name, used: Sequence[int] = used) -> None:
            panels.flags(axes, run, name, used)

        caption = "As reported by the controller (CTL_STAT); laws that do not report it are left out."
        title = f"{_capital(note.title)} over time"
        height_in = _FLAGS_IN * max(3, len(used))
        found.append(_stacked(scenario, telling, name, title, "", caption, draw, height_in))
    return found


def _told_figures(scenario: Scenario, runs: Sequence[Drawn]) -> list[Picture]:
    """One picture of the figures reported by laws, with the runs that have them."""
    telling = [run for run in runs if run.curves.told(flags=False)]
    notes = {note.name: note for run in telling for note, _ in run.curves.told(flags=False)}
    # A figure that stayed at 0 is drawn together with one that did not.
    notes |= {note.name: note for run in telling for note, _ in run.curves.notes if not note.bits}
    if not notes:
        return []

    def draw(axes: Axes, run: Drawn) -> None:
        panels.figures(axes, run, list(notes))

    title = f"{_capital(' and '.join(note.title for note in notes.values()))} over time"
    symbols = ", ".join(note.symbol or note.unit for note in notes.values() if note.symbol or note.unit)
    caption = "As reported by the controller (CTL_STAT); laws that report no such figure are left out."
    return [_stacked(scenario, telling, next(iter(notes)), title, symbols, caption, draw, legend=True)]


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _reactions(scenario: Scenario, run: Drawn, place: int) -> Picture:
    title = "Reactions and events over time" + (f": {run.label}" if place else "")
    rows_in = _FLAGS_IN * max(1, len(events_panel.kinds(run.events)))
    figure = Figure(figsize=(_WIDTH_IN, _BOTTOM_IN + rows_in + 0.15 + _ROW_IN + _GAP_IN + 2.0 + _LEGEND_IN + 0.1))
    marks = _axes(figure, _BOTTOM_IN, rows_in)
    track = _axes(figure, _BOTTOM_IN + rows_in + 0.15, _ROW_IN, sharex=marks)
    speed = _axes(figure, _BOTTOM_IN + rows_in + 0.15 + _ROW_IN + _GAP_IN, 2.0, sharex=marks)
    end_s = float(run.curves.time_s[-1])
    events_panel.speed_over_time(speed, run)
    panels.legend(speed)
    events_panel.ladder(track, scenario, run, end_s)
    events_panel.markers(marks, run)
    for axes in (speed, track):
        axes.tick_params(labelbottom=False)
    marks.set(xlabel="time (s)", xlim=(0, end_s))
    caption = (
        "Speed with the levels of the watches below it, and the instants of all other events; a line lasts as long as "
        "its event."
    )
    name = f"reactions-{place}" if place else "reactions"
    return Picture(name, title, caption, svg(figure, name, title))


def _all_reactions(scenario: Scenario, runs: Sequence[Drawn]) -> list[Picture]:
    """One picture for each run in which something unusual happened."""
    shown = [run for run in runs if events_panel.has_unusual(run.events)]
    return [_reactions(scenario, run, place if len(runs) > 1 else 0) for place, run in enumerate(shown, 1)]


def _lateness(runs: Sequence[Lateness]) -> Picture:
    title = "Lateness of the cycles"
    caption = (
        "How long after its absolute deadline each cycle began, in wall time; both axes are logarithmic. The dotted "
        f"line is {LATE_MS:g} ms: a run with more than {LATE_SHARE_MAX:.1%} of its cycles beyond it is INVALID."
    )
    columns, legend_rows = _legend([*(run.label for run in runs), f"{LATE_MS:g} ms"])
    figure = Figure(figsize=(_WIDTH_IN, _BOTTOM_IN + 2.2 + _LEGEND_IN * legend_rows + 0.1))
    axes = _axes(figure, _BOTTOM_IN, 2.2)
    lateness(axes, runs)
    panels.legend(axes, columns)
    return Picture("lateness", title, caption, svg(figure, "lateness", title))


#: The report of a train that drives automatically from one stop to the next, in reading order.
ATO_PANELS = (
    Panel("speed", lambda of: [_speed(of.scenario, of.runs)]),
    Panel("reactions", lambda of: _all_reactions(of.scenario, of.runs)),
    Panel("error", lambda of: [_error(of.scenario, of.runs)]),
    Panel("stop", lambda of: [_distance(of.scenario, of.runs)]),
    Panel("notch", lambda of: [_notch(of.scenario, of.runs)]),
    Panel("force", lambda of: [_force(of.scenario, of.runs)]),
    Panel("flags of laws", lambda of: _flags(of.scenario, of.runs)),
    Panel("figures of laws", lambda of: _told_figures(of.scenario, of.runs)),
    Panel("lateness", lambda of: [_lateness(of.late)] if of.late else []),
)
