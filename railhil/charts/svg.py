"""The charts of a figure as SVG inside a page.

A path has the numbers of the curve: x and y in the units of the axes, which one transformation of the group maps to the
drawing. ``figures.js`` reads them from there and shows another range by another transformation.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from railhil.charts.curve_points import find_deviation, pick_rows
from railhil.charts.figure import Chart, Curve, Figure, FloatArray, Look, looks, ticks
from railhil.charts.svg_shapes import (
    Axes,
    area_sample,
    draw_area,
    draw_band,
    draw_point,
    draw_x_lines,
    escaped,
    marker,
    name_pairs,
    pair,
    run_of,
    stroke,
)

#: Space left of the axes: the least, and for each letter of a name there.
_LEFT_PX, _LETTER_PX = 56, 6.6
_TICK_X_PX, _TICK_Y_PX = 62, 32
#: Largest number of stretches of a curve, each with two points, and of all curves of a figure together.
_STRETCHES, _STRETCHES_TOGETHER, _STRETCHES_MIN = 500, 8000, 150


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
            # The numbers of its horizontal axis stand below the next row.
            found.append(f'<div class="row{"" if chart.x_label else " above"}">')
        found.append(_chart(figure, chart, left_px, stretches))
        filled += chart.share
        if filled > 0.99:
            found.append("</div>")
            filled = 0.0
    return "\n".join(found) + ("\n</div>" if filled else "")


def _chart(figure: Figure, chart: Chart, left_px: int, stretches: int) -> str:
    axes = Axes(chart, left_px)
    every = looks(chart.curves)
    keys = [_key(curve, look) for curve, look in zip(chart.curves, every, strict=True)]
    keys += _area_keys(chart)
    shown = list(dict.fromkeys(point.label for point in chart.points if point.label))
    for label in shown:
        point = next(one for one in chart.points if one.label == label)
        if label not in {curve.label for curve in chart.curves}:
            keys.append(f'<span class="key">{_sample(point.look, is_line=False)}{escaped(label)}</span>')
    box = " ".join(map(str, axes.box))
    flags = ' data-log=""' * chart.is_log
    flags += "" if chart.y_bounds == (None, None) and not chart.y_names else ' data-fixed=""'
    flags += f' data-sync="{escaped(chart.sync)}"' if chart.sync else ""
    said = f"{figure.title}: {_alternative(chart, axes)}"
    style = f' style="flex:0 0 {100 * chart.share:g}%"' if chart.share < 1 else ""
    label = f"<b>{escaped(chart.y_label)}</b>" if chart.y_label else ""
    return (
        f'<div class="chart" tabindex="0"{style}{flags}>'
        f'<p class="keys">{label}{"".join(keys)}<span class="at"></span></p>'
        f'<svg viewBox="0 0 {axes.width_px} {axes.height_px}" role="img" aria-label="{escaped(said)}" '
        f'data-box="{box}" data-x="{pair(axes.x)}" data-y="{pair(axes.y)}" '
        f'data-names="{name_pairs(chart.x_names)}|{name_pairs(chart.y_names)}">'
        f'<g class="axes">{_grid(axes)}</g>{_x_label(axes)}'
        f'<svg class="plot" x="{axes.box[0]}" y="{axes.box[1]}" width="{axes.box[2]}" height="{axes.box[3]}">'
        f'<g class="data" transform="{axes.matrix}">'
        + "".join(draw_area(axes, area) for area in chart.areas)
        + "".join(draw_band(axes, band, stretches) for band in chart.bands)
        + "".join(_path(axes, curve, look, stretches) for curve, look in zip(chart.curves, every, strict=True))
        + "</g>"
        + draw_x_lines(axes)
        + "".join(draw_point(axes, point) for point in chart.points)
        + "</svg></svg></div>"
    )


def _area_keys(chart: Chart) -> Iterator[str]:
    """The entries of areas and bands in the legend, one for equal labels."""
    named = {area.label: (area.kind, area.colour) for area in reversed(chart.areas) if area.label}
    named = dict(reversed(named.items())) | {
        band.label: ("band", band.look.colour) for band in chart.bands if band.label
    }
    for label, (kind, colour) in named.items():
        yield f'<span class="key">{area_sample(kind, colour)}{escaped(label)}</span>'


def _alternative(chart: Chart, axes: Axes) -> str:
    """Description for readers who do not see the chart."""
    names = list(dict.fromkeys(curve.label for curve in chart.curves))
    (low_x, high_x), (low_y, high_y) = axes.x, axes.y
    over = f"{chart.x_label} {low_x:.6g} to {high_x:.6g}" if chart.x_label else f"{low_x:.6g} to {high_x:.6g}"
    return f"{', '.join(names)}; {chart.y_label} {low_y:.4g} to {high_y:.4g} over {over}"


def _grid(axes: Axes) -> str:
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
                yield at, escaped(name)
        return
    if is_log:
        for power in range(math.ceil(bounds[0]), math.floor(bounds[1]) + 1):
            yield float(power), f"{10.0**power:g}"
        return
    found, decimals = ticks(*bounds, most)
    for at in found:
        yield at, f"{at + 0.0:.{decimals}f}"


def _x_label(axes: Axes) -> str:
    if not axes.chart.x_label:
        return ""
    left, top, width, height = axes.box
    return (
        f'<text class="x" x="{left + width / 2:g}" y="{top + height + 30}" text-anchor="middle">'
        f"{escaped(axes.chart.x_label)}</text>"
    )


def _path(axes: Axes, curve: Curve, look: Look, stretches: int) -> str:
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
    given += f' data-unit="{escaped(curve.unit)}"' if curve.unit else ""
    given += f' data-column="{escaped(curve.column)}"' if curve.column else ""
    given += ' data-step=""' if curve.is_step else ""
    filled = " filled" if curve.is_filled else ""
    return f'<path class="curve{filled}"{stroke(look)}{run_of(curve.run)}{given} d="{d}"/>'


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


def _key(curve: Curve, look: Look) -> str:
    """The entry of a curve in the legend, where its value at the cursor stands."""
    return f'<span class="key"{run_of(curve.run)}>{_sample(look)}{escaped(curve.label)}<output></output></span>'


def _sample(look: Look, is_line: bool = True) -> str:
    line = f'<path class="curve"{stroke(look)} d="M0 7H30"/>' if is_line else ""
    point = f'<g transform="translate(15 7)">{marker(look)}</g>' if look.marker else ""
    return f'<svg class="sample" viewBox="0 0 30 14" aria-hidden="true">{line}{point}</svg>'
