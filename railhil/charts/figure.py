"""A figure as data: charts with curves, areas, bands and points.

Pages draw it as SVG (:mod:`railhil.charts.svg`), files with matplotlib (:mod:`railhil.report.pictures.printed`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
#: Bounds of an axis; None: the bounds of the curves.
Bounds: TypeAlias = tuple[float | None, float | None]
FREE: Bounds = (None, None)
TIME = "time (s)"


@dataclass(frozen=True, slots=True)
class Look:
    """Style of a curve or a point.

    ``colour``: ``0`` to ``6`` of the palette, ``target``, ``dim``, ``ink`` or ``fault`` (``--rc-NAME`` of
    ``charts.css``). ``width``, ``dashes``, ``marker_px``: px. ``marker``: ``o s D ^ v P X`` or ``+``, of a point and in
    the legend.
    """

    colour: str
    width: float = 1.2
    dashes: tuple[float, ...] = ()
    marker: str = ""
    is_full: bool = False
    marker_px: float = 8.0


#: Style of a set-point, drawn below the runs.
TARGET = Look("target", 3.5)


@dataclass(frozen=True, slots=True)
class Curve:
    """One curve: arrays of one length, NaN where there is no line.

    :param look: None: the next colour of the palette.
    :param unit: of the values at the cursor.
    :param is_step: each value holds until the next.
    :param is_filled: down to zero.
    :param run: number of the run on the page, by which a reader shows and hides it; -1: of no run.
    :param column: its column of ``signals.csv``, empty if it is none.
    """

    label: str
    x: FloatArray
    y: FloatArray
    look: Look | None = None
    unit: str = ""
    is_step: bool = False
    is_filled: bool = False
    run: int = -1
    column: str = ""


@dataclass(frozen=True, slots=True)
class Area:
    """A rectangle; without an extent in one direction it is a line.

    ``x``, ``y``: from and to; None: over all of the axis. ``kind``: ``allowed``, ``line``, ``event``, ``fault`` or
    ``block``. ``text``: shown under the pointer. ``label``: its entry in the legend, once for equal ones; empty: none.
    ``colour``: of a ``block``, as in :class:`Look`.
    """

    x: tuple[float, float] | None
    y: tuple[float, float] | None
    kind: str = "line"
    text: str = ""
    run: int = -1
    label: str = ""
    colour: str = "dim"


#: The line at zero.
ZERO = Area(None, (0.0, 0.0))


@dataclass(frozen=True, slots=True)
class Band:
    """The area between two lines, shape (n,) each; NaN where there is none.

    :param x: places of both lines, or of the lower one alone.
    :param x_high: places of the upper line where they differ.
    """

    label: str
    x: FloatArray
    low: FloatArray
    high: FloatArray
    look: Look
    x_high: FloatArray | None = None
    run: int = -1


@dataclass(frozen=True, slots=True)
class Point:
    """A marker at one place. ``label``: in the legend, if any. ``text``: shown under the pointer; empty: the label."""

    label: str
    x: float
    y: float
    look: Look
    run: int = -1
    text: str = ""


@dataclass(frozen=True, slots=True)
class Chart:
    """One pair of axes.

    :param x_label: with its unit; empty: the label of the chart below, which has the same axis.
    :param y_label: with its unit; above the chart.
    :param x_names: texts at some values instead of numbers; ``y_names`` likewise.
    :param x_lines: lines across the chart at some values; a name stands along its line, an empty one has none.
    :param bands: below the curves.
    :param is_log: both axes are logarithmic.
    :param sync: charts with the same word share cursor and zoom; empty: this one is alone.
    :param share: of the width of the figure; further charts follow beside it.
    """

    curves: Sequence[Curve] = ()
    x_label: str = ""
    y_label: str = ""
    x_bounds: Bounds = FREE
    y_bounds: Bounds = FREE
    areas: Sequence[Area] = ()
    points: Sequence[Point] = ()
    x_names: Mapping[float, str] = field(default_factory=dict)
    y_names: Mapping[float, str] = field(default_factory=dict)
    x_lines: Mapping[float, str] = field(default_factory=dict)
    bands: Sequence[Band] = ()
    is_log: bool = False
    sync: str = ""
    height_px: int = 150
    share: float = 1.0


@dataclass(frozen=True, slots=True)
class Figure:
    """Charts below each other. ``name`` is the anchor in the page."""

    name: str
    title: str
    caption: str
    charts: Sequence[Chart]


def looks(curves: Sequence[Curve]) -> list[Look]:
    """The look of each curve of a chart."""
    return [curve.look or Look(str(place % 7)) for place, curve in enumerate(curves)]


def extent(chart: Chart, axis: str) -> tuple[float, float]:
    """Range of an axis: its bounds, or the range of curves, points and bands with a margin above and below.

    :param axis: ``x`` or ``y``.
    """
    low, high = chart.x_bounds if axis == "x" else chart.y_bounds
    if low is None or high is None:
        found = [getattr(curve, axis) for curve in chart.curves] + [
            np.array([getattr(point, axis)]) for point in chart.points
        ]
        found += [edge for band in chart.bands for edge in (band.low, band.high)] if axis == "y" else []
        values = np.concatenate([np.asarray(one, dtype=np.float64) for one in found]) if found else np.empty(0)
        values = values[np.isfinite(values) & (values > 0.0)] if chart.is_log else values[np.isfinite(values)]
        least, most = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
        if most == least:
            least, most = least - (abs(least) or 1.0) / 2, most + (abs(most) or 1.0) / 2
        margin = 0.0 if axis == "x" or chart.is_log else 0.05 * (most - least)
        low = least - margin if low is None else low
        high = most + margin if high is None else high
    return (low, high) if high > low else (low, low + 1.0)


def ticks(low: float, high: float, most: int) -> tuple[list[float], int]:
    """Round values between two bounds, up to a largest number, and their number of decimals."""
    rough = (high - low) / most
    power = float(10.0 ** np.floor(np.log10(rough)))
    step = power * next(factor for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= rough * (1 - 1e-9))
    decimals = max(0, -int(np.floor(np.log10(step) + 1e-9)))
    first, last = int(np.ceil(low / step - 1e-9)), int(np.floor(high / step + 1e-9))
    return [step * number for number in range(first, last + 1)], decimals
