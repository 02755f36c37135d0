"""Figures of axes above each other with one horizontal axis, for the systems that draw their own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from railhil.supervisor.report.figures import Picture, svg
from railhil.supervisor.report.panels import drawing
from railhil.supervisor.trace import FloatArray

_WIDTH_IN, _ROW_IN, _TOP_IN, _BOTTOM_IN, _GAP_IN = 8.5, 1.35, 0.35, 0.5, 0.18
_LEFT, _RIGHT = 0.09, 0.985
#: A line has at most twice as many points: minimum and maximum of each stretch.
_STRETCHES = 500


def stacked(name: str, title: str, caption: str, rows: Sequence[Callable[[Axes], None]]) -> Picture:
    """Axes above each other with a common horizontal axis, the legend above them."""
    height_in = _TOP_IN + _BOTTOM_IN + len(rows) * _ROW_IN + (len(rows) - 1) * _GAP_IN
    with drawing("none"):
        figure = Figure(figsize=(_WIDTH_IN, height_in))
        first: Axes | None = None
        for number, draw in enumerate(rows):
            bottom_in = height_in - _TOP_IN - (number + 1) * _ROW_IN - number * _GAP_IN
            box = (_LEFT, bottom_in / height_in, _RIGHT - _LEFT, _ROW_IN / height_in)
            axes = figure.add_axes(box, sharex=first)
            first = first or axes
            draw(axes)
            if number < len(rows) - 1:
                axes.set_xlabel("")
                axes.tick_params(labelbottom=False)
        handles = [pair for axes in figure.axes for pair in zip(*axes.get_legend_handles_labels(), strict=True)]
        if handles:
            lines, labels = zip(*handles, strict=True)
            figure.legend(lines, labels, loc="upper right", ncols=4, frameon=False)
        figure.align_ylabels()
        return Picture(name, title, caption, svg(figure, name, title))


def line(axes: Axes, x: FloatArray, y: FloatArray, where: npt.NDArray[np.bool_] | None = None, **style: Any) -> None:
    """A line with as many points as can be seen: the extremes of each stretch. It is broken at a NaN.

    :param where: points of the line, shape (n,); it is broken at the others. None: all.
    """
    known = np.isfinite(x) & np.isfinite(y)
    if where is not None:
        known &= where
    y = np.where(known, y, np.nan)
    size = int(np.count_nonzero(known)) // _STRETCHES
    if size > 2:
        ends = np.flatnonzero(np.diff(known, prepend=False, append=False)).reshape(-1, 2).tolist()
        picked = np.concatenate([rows for begin, end in ends for rows in (_seen(y, begin, end, size), [end])])
        picked = picked[picked < len(y)].astype(np.int64)
        x, y = x[picked], y[picked]
    axes.plot(x, y, **style)


def _seen(y: FloatArray, begin: int, end: int, size: int) -> npt.NDArray[np.int64]:
    """The places of the extremes of each stretch of a part without gaps, and the part's last one."""
    size = min(size, end - begin)
    whole = (end - begin) // size * size
    rows = y[begin : begin + whole].reshape(-1, size)
    starts = np.arange(begin, begin + whole, size)
    picked = np.sort(np.stack((starts + rows.argmin(axis=1), starts + rows.argmax(axis=1))), axis=0).T.ravel()
    return np.append(picked, end - 1)
