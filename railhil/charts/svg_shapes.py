"""Shapes of a chart as SVG: areas, bands, named lines, points, samples of the legend; the axes that place them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from html import escape

import numpy as np

from railhil.charts.curve_points import pick_rows
from railhil.charts.figure import Area, Band, Chart, FloatArray, Look, Point, extent
from railhil.common.streams import escape_controls

WIDTH_PX, _RIGHT_PX, TOP_PX = 912, 18, 6
#: Space below the axes: of a chart with its own horizontal axis, and of a chart above such a one.
_BOTTOM_PX, _BOTTOM_SHARED_PX = 36, 8
#: Length of areas over all of an axis, as a multiple of the axis.
_BEYOND = 20.0
#: Least distance of the names of two lines, and of a name from the left edge, px.
_NAMES_APART_PX, _FROM_EDGE_PX, _OTHER_SIDE_PX = 13, 14, 17
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


class Axes:
    """The plot area of a chart, and its content."""

    def __init__(self, chart: Chart, left_px: int) -> None:
        self.chart = chart
        self.width_px = round(WIDTH_PX * chart.share)
        bottom_px = _BOTTOM_PX if chart.x_label else _BOTTOM_SHARED_PX
        self.height_px = TOP_PX + chart.height_px + bottom_px
        self.box = (left_px, TOP_PX, self.width_px - left_px - _RIGHT_PX, chart.height_px)
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


def draw_area(axes: Axes, area: Area) -> str:
    """A rectangle, in the units of the axes."""

    def whole(bounds: tuple[float, float]) -> tuple[float, float]:
        reach = _BEYOND * (bounds[1] - bounds[0])
        return bounds[0] - reach, bounds[1] + reach

    x = whole(axes.x) if area.x is None else tuple(axes.scaled(np.array(area.x)).tolist())
    y = whole(axes.y) if area.y is None else tuple(axes.scaled(np.array(area.y)).tolist())
    said = f"<title>{escaped(area.text)}</title>" if area.text else ""
    d = f"M{x[0]:.7g} {y[0]:.7g}V{y[1]:.7g}H{x[1]:.7g}V{y[0]:.7g}Z"
    fill = f' style="fill:var(--rc-{area.colour})"' if area.kind == "block" else ""
    return f'<path class="{area.kind}"{fill}{run_of(area.run)} d="{d}">{said}</path>'


def draw_band(axes: Axes, band: Band, stretches: int) -> str:
    """The area between two lines; a gap of either one divides it.

    :param stretches: as of :func:`railhil.charts.curve_points.pick_rows`.
    """
    low_x = np.asarray(band.x, dtype=np.float64)
    high_x = low_x if band.x_high is None else np.asarray(band.x_high, dtype=np.float64)
    low, high = (np.asarray(one, dtype=np.float64) for one in (band.low, band.high))
    lines = (low_x, high_x, low, high)
    known = np.logical_and.reduce([np.isfinite(one) for one in lines])
    edges = np.flatnonzero(np.diff(known.astype(np.int8), prepend=0, append=0))
    found = []
    for first, after in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        picked = [pick_rows(one[first:after], stretches) for one in lines]
        rows = first + np.unique(np.concatenate(picked))
        # Along the lower line, and back along the upper one.
        x = axes.scaled(np.concatenate((low_x[rows], high_x[rows][::-1])))
        y = axes.scaled(np.concatenate((low[rows], high[rows][::-1])))
        found.append("M" + " ".join(f"{at:.7g} {value:.7g}" for at, value in zip(x, y, strict=True)) + "Z")
    fill = f"fill:var(--rc-{band.look.colour})"
    return f'<path class="band" style="{fill}"{run_of(band.run)} d="{"".join(found)}"/>'


def draw_x_lines(axes: Axes) -> str:
    """The named lines; a name that would stand on the one before is left out until a zoom makes room for it."""
    found, before_px = [], -math.inf
    for at, name in sorted(axes.chart.x_lines.items()):
        x_px = axes.place(math.log10(at) if axes.chart.is_log else at, 0.0)[0]
        has_room = x_px - before_px >= _NAMES_APART_PX
        text = ""
        if name:
            side_px = 11 if x_px < _FROM_EDGE_PX else -3
            hidden = "" if has_room else ' visibility="hidden"'
            text = (
                f'<text transform="rotate(-90)" x="-4" y="{side_px}" text-anchor="end"{hidden}>{escaped(name)}</text>'
            )
        if name and has_room and x_px >= 0.0:
            # Of the first one the name stands on the other side.
            before_px = x_px + _OTHER_SIDE_PX * (x_px < _FROM_EDGE_PX)
        found.append(
            f'<g class="across" data-at="{at:.9g}" transform="translate({x_px:.2f} 0)">'
            f'<path class="line" d="M0 0V{axes.box[3]}"/>{text}</g>'
        )
    return "".join(found)


def draw_point(axes: Axes, point: Point) -> str:
    """A marker, in px of the plot."""
    x, y = axes.place(point.x, point.y)
    at = f"{point.x:.9g} {point.y:.9g}"
    return (
        f'<g class="point"{run_of(point.run)} data-at="{at}" transform="translate({x:.2f} {y:.2f})">'
        f"<title>{escaped(point.text or point.label)}</title>{marker(point.look)}</g>"
    )


def marker(look: Look) -> str:
    """A marker around the origin."""
    radius = look.marker_px / 2
    fill = f"var(--rc-{look.colour})" if look.is_full else "none"
    return (
        f'<path class="marker" d="{_MARKERS[look.marker]}" transform="scale({radius:g})" '
        f'style="stroke:var(--rc-{look.colour});fill:{fill}"/>'
    )


def area_sample(kind: str, colour: str) -> str:
    """A patch of an area for the legend."""
    fill = f' style="fill:var(--rc-{colour})"' if kind in ("block", "band") else ""
    patch = f'<path class="{kind}"{fill} d="M4 2H26V12H4Z"/>'
    return f'<svg class="sample" viewBox="0 0 30 14" aria-hidden="true">{patch}</svg>'


def stroke(look: Look) -> str:
    """Style of a line."""
    dashes = f";stroke-dasharray:{' '.join(f'{dash:g}' for dash in look.dashes)}" if look.dashes else ""
    return f' style="stroke:var(--rc-{look.colour});stroke-width:{look.width:g}{dashes}"'


def run_of(number: int) -> str:
    """The run that an element belongs to."""
    return f' data-run="{number}"' if number >= 0 else ""


def pair(bounds: tuple[float, float]) -> str:
    """Two numbers for the program of the page."""
    return f"{bounds[0]:.9g} {bounds[1]:.9g}"


def name_pairs(names: Mapping[float, str]) -> str:
    """Names of values for the program of the page."""
    return ";".join(f"{at:g}={escaped(name)}" for at, name in names.items())


def escaped(text: str) -> str:
    """Text for a page, without characters that HTML or a terminal would interpret."""
    return escape(escape_controls(text))
