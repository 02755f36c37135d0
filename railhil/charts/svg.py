"""The charts of a figure as SVG inside a page.

A path has the numbers of the curve: x and y in the units of the axes, which one transformation of the group maps to the
drawing. ``figures.js`` reads them from there and zooms by another transformation.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from html import escape

import numpy as np

from railhil.charts.curve_points import find_deviation, pick_rows
from railhil.charts.figure import Area, Chart, Curve, Figure, FloatArray, Look, Point, extent, looks, ticks
from railhil.common.streams import escape_controls

_WIDTH_PX, _RIGHT_PX, _TOP_PX = 912, 18, 6
#: Space left of the axes: the least, and for each letter of a name there.
_LEFT_PX, _LETTER_PX = 56, 6.6
#: Space below the axes: of a chart with its own horizontal axis, and of a chart above such a one.
_BOTTOM_PX, _BOTTOM_SHARED_PX = 36, 8
_TICK_X_PX, _TICK_Y_PX = 62, 32
#: Largest number of stretches of a curve, each with two points, and of all curves of a figure together.
_STRETCHES, _STRETCHES_TOGETHER, _STRETCHES_MIN = 500, 8000, 150
#: Length of areas over all of an axis, as a multiple of the axis.
_BEYOND = 20.0
#: Markers around the origin, one pixel in radius.
_MARKERS: Mapping[str, str] = {
    "o": "M-1 0a1 1 0 1 0 2 0a1 1 0 1 0-2 0Z",
    "s": "M-.9-.9H.9V.9H-.9Z",
    "D": "M0-1.2L1.2 0L0 1.2L-1.2 0Z",
    "^": "M0-1.1L1.1.9H-1.1Z",
    "v": "M0 1.1L1.1-.9H-1.1Z",
    "P": "M-.35-1H.35V-.35H1V.35H.35V1H-.35V.35H-1V-.35H-.35Z",
    "X": "M-1-.5L-.5-1L0-.5L.5-1L1-.5L.5 0L1 .5L.5 1L0 .5L-.5 1L-1 .5L-.5 0Z",
    "+": "M-1.4 0H1.4M0-1.4V1.4",
}


def markup(figure: Figure) -> str:
    """The charts of a figure, in order; those beside each other in one row."""
    names = [name for chart in figure.charts for name in chart.y_names.values()]
    left_px = max(_LEFT_PX, round(_LETTER_PX * max(map(len, names), default=0)) + 12)
    count = sum(len(chart.curves) for chart in figure.charts)
    stretches = max(_STRETCHES_MIN, min(_STRETCHES, _STRETCHES_TOGETHER // max(count, 1)))
    found: list[str] = []
    filled = 0.0
    for chart in figure.charts:
        if filled == 0.0:
            found.append('<div class="row">')
        found.append(_chart(figure, chart, left_px, stretches))
        filled += chart.share
        if filled > 0.99:
            found.append("</div>")
            filled = 0.0
    return "\n".join(found) + ("\n</div>" if filled else "")


class _Axes:
    """The plot area of a chart, and its content."""

    def __init__(self, chart: Chart, left_px: int) -> None:
        self.chart = chart
        self.width_px = round(_WIDTH_PX * chart.share)
        bottom_px = _BOTTOM_PX if chart.x_label else _BOTTOM_SHARED_PX
        self.height_px = _TOP_PX + chart.height_px + bottom_px
        self.box = (left_px, _TOP_PX, self.width_px - left_px - _RIGHT_PX, chart.height_px)
        self.x = self._scaled(extent(chart, "x"))
        self.y = self._scaled(extent(chart, "y"))

    def _scaled(self, bounds: tuple[float, float]) -> tuple[float, float]:
        low, high = bounds
        return (math.log10(low), math.log10(high)) if self.chart.is_log else bounds

    def scaled(self, values: FloatArray) -> FloatArray:
        """Values as numbers of a path."""
        if not self.chart.is_log:
            return np.asarray(values, dtype=np.float64)
        with np.errstate(divide="ignore"):
            # Values that a logarithmic axis cannot show lie below it.
            return np.maximum(np.log10(values), -99.0)

    def place(self, x: float, y: float) -> tuple[float, float]:
        """A point in px of the plot."""
        (low_x, high_x), (low_y, high_y), box = self.x, self.y, self.box
        return (x - low_x) / (high_x - low_x) * box[2], (high_y - y) / (high_y - low_y) * box[3]

    @property
    def matrix(self) -> str:
        """The transformation from the units of the axes to px of the plot."""
        (low_x, high_x), (low_y, high_y), box = self.x, self.y, self.box
        a, d = box[2] / (high_x - low_x), -box[3] / (high_y - low_y)
        return f"matrix({a:.9g} 0 0 {d:.9g} {-a * low_x:.9g} {-d * high_y:.9g})"


def _chart(figure: Figure, chart: Chart, left_px: int, stretches: int) -> str:
    axes = _Axes(chart, left_px)
    every = looks(chart.curves)
    keys = [_key(curve, look) for curve, look in zip(chart.curves, every, strict=True)]
    shown = list(dict.fromkeys(point.label for point in chart.points))
    for label in shown:
        point = next(one for one in chart.points if one.label == label)
        if label not in {curve.label for curve in chart.curves}:
            keys.append(f'<span class="key">{_sample(point.look, is_line=False)}{_text(label)}</span>')
    box = " ".join(map(str, axes.box))
    flags = ' data-log=""' * chart.is_log
    flags += "" if chart.y_bounds == (None, None) and not chart.y_names else ' data-fixed=""'
    flags += f' data-sync="{_text(chart.sync)}"' if chart.sync else ""
    said = f"{figure.title}: {_alternative(chart, axes)}"
    style = f' style="flex:0 0 {100 * chart.share:g}%"' if chart.share < 1 else ""
    label = f"<b>{_text(chart.y_label)}</b>" if chart.y_label else ""
    return (
        f'<div class="chart" tabindex="0"{style}{flags}>'
        f'<p class="keys">{label}{"".join(keys)}<span class="at"></span></p>'
        f'<svg viewBox="0 0 {axes.width_px} {axes.height_px}" role="img" aria-label="{_text(said)}" '
        f'data-box="{box}" data-x="{_pair(axes.x)}" data-y="{_pair(axes.y)}" '
        f'data-names="{_names(chart.x_names)}|{_names(chart.y_names)}">'
        f'<g class="axes">{_grid(axes)}</g>{_x_label(axes)}'
        f'<svg class="plot" x="{axes.box[0]}" y="{axes.box[1]}" width="{axes.box[2]}" height="{axes.box[3]}">'
        f'<g class="data" transform="{axes.matrix}">'
        + "".join(_area(axes, area) for area in chart.areas)
        + "".join(_path(axes, curve, look, stretches) for curve, look in zip(chart.curves, every, strict=True))
        + "</g>"
        + "".join(_point(axes, point) for point in chart.points)
        + "</svg></svg></div>"
    )


def _alternative(chart: Chart, axes: _Axes) -> str:
    """Description for readers who do not see the chart."""
    names = list(dict.fromkeys(curve.label for curve in chart.curves))
    (low_x, high_x), (low_y, high_y) = axes.x, axes.y
    over = f"{chart.x_label} {low_x:.6g} to {high_x:.6g}" if chart.x_label else f"{low_x:.6g} to {high_x:.6g}"
    return f"{', '.join(names)}; {chart.y_label} {low_y:.4g} to {high_y:.4g} over {over}"


def _grid(axes: _Axes) -> str:
    """Lines and numbers of both axes; ``figures.js`` draws the same after a zoom."""
    left, top, width, height = axes.box
    chart = axes.chart
    found = []
    for at, text in _marks(axes.y, chart.y_names, max(2, height // _TICK_Y_PX), chart.is_log):
        y_px = top + axes.place(0.0, at)[1]
        found.append(f'<path d="M{left} {y_px:.2f}h{width}"/>')
        found.append(f'<text x="{left - 5}" y="{y_px + 4:.2f}" text-anchor="end">{text}</text>')
    for at, text in _marks(axes.x, chart.x_names, max(2, width // _TICK_X_PX), chart.is_log):
        x_px = left + axes.place(at, 0.0)[0]
        found.append(f'<path d="M{x_px:.2f} {top}v{height}"/>')
        if chart.x_label:
            found.append(f'<text x="{x_px:.2f}" y="{top + height + 14}" text-anchor="middle">{text}</text>')
    return "".join(found)


def _marks(
    bounds: tuple[float, float], names: Mapping[float, str], most: int, is_log: bool
) -> Iterator[tuple[float, str]]:
    """Places of the lines of an axis, and the texts there."""
    if names:
        for at, name in names.items():
            at = math.log10(at) if is_log else at
            if bounds[0] <= at <= bounds[1]:
                yield at, _text(name)
        return
    if is_log:
        for power in range(math.ceil(bounds[0]), math.floor(bounds[1]) + 1):
            yield float(power), f"{10.0**power:g}"
        return
    found, decimals = ticks(*bounds, most)
    for at in found:
        yield at, f"{at + 0.0:.{decimals}f}"


def _x_label(axes: _Axes) -> str:
    if not axes.chart.x_label:
        return ""
    left, top, width, height = axes.box
    return (
        f'<text class="x" x="{left + width / 2:g}" y="{top + height + 30}" text-anchor="middle">'
        f"{_text(axes.chart.x_label)}</text>"
    )


def _path(axes: _Axes, curve: Curve, look: Look, stretches: int) -> str:
    x, y = np.asarray(curve.x, dtype=np.float64), np.asarray(curve.y, dtype=np.float64)
    within = 0.0
    if len(x) and not curve.is_filled:
        rows = pick_rows(y, len(y) if curve.is_step else stretches)
        if not _is_even(x):
            # Between two rows the place is on a line, too.
            rows = np.union1d(rows, pick_rows(x, stretches))
        if not curve.is_step:
            known = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
            kept = np.flatnonzero(np.isin(known, rows))
            within = find_deviation(kept, y[known], x[known]) if len(kept) else 0.0
        x, y = x[rows], y[rows]
    x, y = axes.scaled(x), axes.scaled(y)
    if curve.is_filled and len(x):
        floor = axes.y[0] - 1.0 if axes.chart.is_log else 0.0
        x, y = np.concatenate((x[:1], x, x[-1:])), np.concatenate(([floor], y, [floor]))
    d = (_stairs if curve.is_step else _line)(x, y)
    given = f' data-within="{within:.2g}"' if within else ""
    given += f' data-unit="{_text(curve.unit)}"' if curve.unit else ""
    given += f' data-column="{_text(curve.column)}"' if curve.column else ""
    given += ' data-step=""' if curve.is_step else ""
    filled = " filled" if curve.is_filled else ""
    return f'<path class="curve{filled}"{_stroke(look)}{_run(curve.run)}{given} d="{d}"/>'


def _is_even(x: FloatArray) -> bool:
    """Whether the places are evenly spaced."""
    steps = np.diff(x)
    return not len(steps) or bool(np.ptp(steps) <= 1e-6 * abs(float(x[-1] - x[0])))


def _line(x: FloatArray, y: FloatArray) -> str:
    """Straight lines between the points, broken where there is no value."""
    found: list[str] = []
    is_open = False
    for at, value in zip(x.tolist(), y.tolist(), strict=True):
        if value != value or at != at:
            is_open = False
            continue
        found.append(f"{'' if is_open else 'M'}{at:.7g} {value:.7g}")
        is_open = True
    return " ".join(found)


def _stairs(x: FloatArray, y: FloatArray) -> str:
    """Each value until the next; a value that stays is one line."""
    found: list[str] = []
    before = math.nan
    for at, value in zip(x.tolist(), y.tolist(), strict=True):
        if before == before:
            if found[-1][0] == "H":
                # The same value goes on.
                found.pop()
            found.append(f"H{at:.7g}")
        if value == value and value != before:
            found.append(f"V{value:.7g}" if before == before else f"M{at:.7g} {value:.7g}")
        before = value
    return "".join(found)


def _area(axes: _Axes, area: Area) -> str:
    def whole(bounds: tuple[float, float]) -> tuple[float, float]:
        reach = _BEYOND * (bounds[1] - bounds[0])
        return bounds[0] - reach, bounds[1] + reach

    x = whole(axes.x) if area.x is None else tuple(axes.scaled(np.array(area.x)).tolist())
    y = whole(axes.y) if area.y is None else tuple(axes.scaled(np.array(area.y)).tolist())
    said = f"<title>{_text(area.text)}</title>" if area.text else ""
    d = f"M{x[0]:.7g} {y[0]:.7g}V{y[1]:.7g}H{x[1]:.7g}V{y[0]:.7g}Z"
    return f'<path class="{area.kind}"{_run(area.run)} d="{d}">{said}</path>'


def _point(axes: _Axes, point: Point) -> str:
    x, y = axes.place(point.x, point.y)
    at = f"{point.x:.9g} {point.y:.9g}"
    return (
        f'<g class="point"{_run(point.run)} data-at="{at}" transform="translate({x:.2f} {y:.2f})">'
        f"<title>{_text(point.label)}</title>{_marker(point.look)}</g>"
    )


def _marker(look: Look) -> str:
    radius = look.marker_px / 2
    fill = f"var(--rc-{look.colour})" if look.is_full else "none"
    return (
        f'<path class="marker" d="{_MARKERS[look.marker]}" transform="scale({radius:g})" '
        f'style="stroke:var(--rc-{look.colour});fill:{fill}"/>'
    )


def _key(curve: Curve, look: Look) -> str:
    """The entry of a curve in the legend, where its value at the cursor stands."""
    return f'<span class="key"{_run(curve.run)}>{_sample(look)}{_text(curve.label)}<output></output></span>'


def _sample(look: Look, is_line: bool = True) -> str:
    line = f'<path class="curve"{_stroke(look)} d="M0 7H30"/>' if is_line else ""
    marker = f'<g transform="translate(15 7)">{_marker(look)}</g>' if look.marker else ""
    return f'<svg class="sample" viewBox="0 0 30 14" aria-hidden="true">{line}{marker}</svg>'


def _stroke(look: Look) -> str:
    dashes = f";stroke-dasharray:{' '.join(f'{dash:g}' for dash in look.dashes)}" if look.dashes else ""
    return f' style="stroke:var(--rc-{look.colour});stroke-width:{look.width:g}{dashes}"'


def _run(number: int) -> str:
    return f' data-run="{number}"' if number >= 0 else ""


def _pair(bounds: tuple[float, float]) -> str:
    return f"{bounds[0]:.9g} {bounds[1]:.9g}"


def _names(names: Mapping[float, str]) -> str:
    return ";".join(f"{at:g}={_text(name)}" for at, name in names.items())


def _text(text: str) -> str:
    return escape(escape_controls(text))
