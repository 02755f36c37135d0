"""The timing picture of a real-time run: histogram of the cycles' lateness."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, NullFormatter

from railhil.supervisor.jitter import LATE_MS
from railhil.supervisor.report.styles import Style


@dataclass(frozen=True, slots=True)
class Lateness:
    """Histogram of one run ready to be drawn."""

    label: str
    style: Style
    edges_ms: Sequence[float]
    counts: Sequence[int]


def lateness(axes: Axes, runs: Sequence[Lateness]) -> None:
    """Number of cycles over lateness, both logarithmic, with the limit that counts against the run."""
    for run in runs:
        if len(runs) == 1:
            axes.stairs(run.counts, run.edges_ms, fill=True, color=run.style.colour, alpha=0.6)
        line = {key: run.style.line[key] for key in ("linestyle", "linewidth")}
        axes.stairs(run.counts, run.edges_ms, color=run.style.colour, label=run.label, **line)
    axes.axvline(LATE_MS, color="0.3", linestyle=":", linewidth=1.4, label=f"{LATE_MS:g} ms")
    axes.set(xscale="log", yscale="log", xlabel="lateness", ylabel="cycles", ylim=(0.7, None))
    axes.set_xlim(min(run.edges_ms[0] for run in runs), max(run.edges_ms[-1] for run in runs))
    # Plain numbers: mathematical text is disabled in these pictures.
    axes.xaxis.set_major_formatter(FuncFormatter(lambda late_ms, _: _duration(late_ms)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda count, _: f"{count:g}"))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(NullFormatter())


def _duration(late_ms: float) -> str:
    return f"{late_ms:g} ms" if late_ms >= 1.0 else f"{late_ms * 1e3:g} µs"
