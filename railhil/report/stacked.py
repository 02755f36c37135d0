"""Pictures of axes above each other with one horizontal axis, drawn by matplotlib."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from railhil.report.figures import Picture, svg
from railhil.report.panels import drawing

_WIDTH_IN, _ROW_IN, _TOP_IN, _BOTTOM_IN, _GAP_IN = 8.5, 1.35, 0.35, 0.5, 0.18
_LEFT, _RIGHT = 0.09, 0.985


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
