"""Figures drawn by matplotlib: as files, and as inline SVG whose text stays text and whose identifiers are unique."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, ScalarFormatter

from railhil.charts.figure import Area, Chart, Curve, Figure, Look, extent, looks
from railhil.record.trace import Trace
from railhil.report.over_time import signal_charts

_WIDTH_IN = 8.5
#: Pixels of a page in an inch of paper.
_PX_PER_IN = 107.0
#: Height of the numbers and the label below a chart, of the legend above it, and of a title, in.
_LABEL_IN, _LEGEND_IN, _TITLE_IN = 0.45, 0.25, 0.3
_LEGEND_COLUMNS, _LEGEND_MARKER_PT = 4, 6
_COLOURS = {
    "0": "#0072b2", "1": "#d55e00", "2": "#009e73", "3": "#cc79a7", "4": "#000000", "5": "#e69f00", "6": "#56b4e9",
    "target": "0.75", "dim": "0.3", "ink": "black", "fault": "firebrick",
}  # fmt: skip
_AREAS: dict[str, dict[str, Any]] = {
    "allowed": {"facecolor": "0.93", "edgecolor": "0.5"},
    "event": {"facecolor": "#0072b2", "edgecolor": "#0072b2"},
    "fault": {"facecolor": "firebrick", "edgecolor": "firebrick", "alpha": 0.3},
}


@contextmanager
def drawing(fonttype: str = "path") -> Iterator[None]:
    """Settings under which the bytes of a picture depend only on its content.

    :param fonttype: ``path`` for a picture that looks the same everywhere, ``none`` for text that stays text.
    """
    settings: dict[Any, Any] = {
        "svg.hashsalt": "railhil",
        "svg.fonttype": fonttype,
        # Names of laws and lines are literal text with any characters.
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


def legend(axes: Axes, columns: int = _LEGEND_COLUMNS) -> None:
    """Legend above the axes, where there are no curves: lines without their markers, and markers that have no line."""
    made = axes.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, frameon=False, borderaxespad=0.2, markerscale=0
    )
    for handle in made.legend_handles:
        if isinstance(handle, Line2D) and handle.get_linestyle() == "None":
            handle.set_markersize(_LEGEND_MARKER_PT)


def sheet(figure: Figure, title: str = "") -> Sheet:
    """The charts of a figure below each other, charts of one row beside each other.

    :param title: above all charts; empty: none.
    """
    rows = _rows(figure.charts)
    heights_in = [row[0].height_px / _PX_PER_IN + _LEGEND_IN + (_LABEL_IN if row[0].x_label else 0.0) for row in rows]
    made = Sheet(figsize=(_WIDTH_IN, sum(heights_in) + _TITLE_IN * bool(title)), layout="constrained")
    if title:
        made.suptitle(title)
    grid = made.add_gridspec(len(rows), 1, height_ratios=heights_in)
    before: dict[str, Axes] = {}
    firsts = []
    said: set[str] = set()
    for place, row in enumerate(rows):
        cells = grid[place].subgridspec(1, len(row), width_ratios=[chart.share for chart in row])
        for column, chart in enumerate(row):
            axes = made.add_subplot(cells[column], sharex=before.get(chart.sync) if chart.share == 1.0 else None)
            if chart.sync:
                before.setdefault(chart.sync, axes)
            _draw(axes, chart, said)
            firsts += [axes] * (column == 0)
    made.align_ylabels(firsts)
    return made


def save(figure: Figure, out: Path, title: str) -> None:
    """Draw a figure into a file whose bytes depend only on its content (fixed ids, no date).

    :raises OSError: it cannot be written.
    """
    with drawing():
        sheet(figure, title).savefig(out, metadata={"Date": None} if out.suffix.lower() == ".svg" else None)


def _rows(charts: Sequence[Chart]) -> list[list[Chart]]:
    rows: list[list[Chart]] = []
    filled = 1.0
    for chart in charts:
        if filled > 0.99:
            rows.append([])
            filled = 0.0
        rows[-1].append(chart)
        filled += chart.share
    return rows


def _draw(axes: Axes, chart: Chart, said: set[str]) -> None:
    """
    :param said: labels that the legends above have already.
    """
    named: set[str] = set()
    for area in chart.areas:
        label = area.label or (area.text if area.kind == "allowed" else "")
        _area(axes, area, "_" if label in named or not label else label)
        named.add(label)
    for band in chart.bands:
        x_high = band.x if band.x_high is None else band.x_high
        known = np.isfinite(band.low) & np.isfinite(band.high)
        edges = ((band.x, x_high), (band.low, band.high))
        outline = [np.concatenate((first[known], second[known][::-1])) for first, second in edges]
        axes.fill(*outline, color=_COLOURS[band.look.colour], alpha=0.25, linewidth=0.0, label=band.label)
    for at, name in chart.x_lines.items():
        axes.axvline(at, color="0.6", linewidth=0.6)
        axes.annotate(name, (at, 0.98), xycoords=axes.get_xaxis_transform(), rotation=90, ha="right", va="top")
    for curve, look in zip(chart.curves, looks(chart.curves), strict=True):
        _curve(axes, curve, look, curve.label if curve.label not in said else "_")
    for point in chart.points:
        label = point.label if point.label not in {*said, *(curve.label for curve in chart.curves)} else "_"
        axes.plot(point.x, point.y, linestyle="none", zorder=4, label=label, **_marker(point.look))
    if chart.is_log:
        axes.set(xscale="log", yscale="log")
    axes.set(xlim=extent(chart, "x"), ylim=extent(chart, "y"), xlabel=chart.x_label, ylabel=chart.y_label)
    for axis, names in ((axes.xaxis, chart.x_names), (axes.yaxis, chart.y_names)):
        if names:
            axis.set_ticks(list(names), list(names.values()), minor=False)
            axis.set_ticks([], minor=True)
        elif not chart.is_log:
            axis.set_major_locator(MaxNLocator("auto"))
            axis.set_major_formatter(ScalarFormatter(useOffset=False))
    axes.tick_params(labelbottom=bool(chart.x_label))
    labels = axes.get_legend_handles_labels()[1]
    said.update(labels)
    if labels:
        legend(axes)


def _curve(axes: Axes, curve: Curve, look: Look, label: str) -> None:
    # matplotlib measures dashes in units of the line width.
    dashes = tuple(px / look.width for px in look.dashes)
    style: dict[str, Any] = {
        "color": _COLOURS[look.colour],
        "linewidth": look.width,
        "linestyle": (0, dashes) if dashes else "-",
    }
    if curve.is_filled:
        axes.fill_between(curve.x, curve.y, step="post" if curve.is_step else None, color=style["color"], alpha=0.2)
    x, y = np.asarray(curve.x, dtype=np.float64), np.asarray(curve.y, dtype=np.float64)
    axes.plot(x, y, label=label, drawstyle="steps-post" if curve.is_step else "default", **style)


def _marker(look: Look) -> dict[str, Any]:
    return {
        "color": _COLOURS[look.colour],
        "marker": look.marker,
        "fillstyle": "full" if look.is_full else "none",
        "markersize": look.marker_px,
        "markeredgewidth": 1.3,
    }


def _area(axes: Axes, area: Area, label: str) -> None:
    low_x, high_x = area.x or (None, None)
    low_y, high_y = area.y or (None, None)
    style = _AREAS.get(area.kind, {"facecolor": _COLOURS[area.colour], "edgecolor": "none"})
    if area.kind == "line":
        line: dict[str, Any] = {"color": "0.6", "linewidth": 0.6}
        if low_y is not None:
            axes.axhline(low_y, **line)
        if low_x is not None:
            axes.axvline(low_x, **line)
    elif low_x is not None and low_y is not None and high_x is not None and high_y is not None:
        corners = [low_x, high_x, high_x, low_x], [low_y, low_y, high_y, high_y]
        axes.fill(*corners, linewidth=0.8, **style, label=label)
    elif low_x is not None and high_x is not None:
        axes.axvspan(low_x, high_x, **style)
    elif low_y is not None and high_y is not None:
        axes.axhspan(low_y, high_y, **style)


_LONG_NUMBER = re.compile(r"(\d\.\d\d)\d+")
_IDENTIFIER = re.compile(r'(\bid="|url\(#|href="#)')


@dataclass(frozen=True, slots=True)
class Picture:
    """One figure: ``name`` is its anchor, ``svg`` the element itself."""

    name: str
    title: str
    caption: str
    svg: str


def printed(figures: Sequence[Figure]) -> list[Picture]:
    """Figures of a page as pictures that need no page around them."""
    with drawing("none"):
        return [Picture(one.name, one.title, one.caption, svg(sheet(one), one.name, one.title)) for one in figures]


def svg(figure: Sheet, name: str, title: str) -> str:
    """The figure as an element of a page.

    Coordinates keep two decimals (a hundredth of a point), which halves the file; identifiers are prefixed with the
    name; the style sheet is left out, because it would apply to the whole page.
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


def draw_signals(scenario: Any, trace: Trace, out: Path) -> None:
    """Draw the signals of ``signals.csv`` into a file whose bytes depend only on the record (fixed ids, no date)."""
    save(Figure("signals", scenario.title, "", signal_charts(scenario, trace)), out, scenario.title)
