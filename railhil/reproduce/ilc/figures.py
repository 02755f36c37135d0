"""Figure 6, table 2 as curves, and the learning of ours."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from railhil.report import pictures as panels
from railhil.report.pictures import Picture, svg
from railhil.report.styles import Style
from railhil.reproduce.ilc import runs
from railhil.reproduce.ilc.findings import PRINTED, READINGS, find_mean_errors
from railhil.reproduce.ilc.runs import EPSILONS_M, MEAN, P95, PAPER_CASE, RMS, epsilon_key, filter_key, of_run
from railhil.reproduce.paper import Results

_NUMBERS = range(1, runs.RUNS + 1)
_MARKERS = "osD^v"
_OURS = (
    ("paper's law", runs.OPEN_LEARNED),
    ("observer, no balises", runs.NO_BALISES),
    ("15 % loss", runs.LOSS),
    ("observer, balises", runs.OURS),
)


def draw(results: Results) -> list[Picture]:
    """The figures for which entries were made."""
    drawn = [
        _figure_6(results) if results.has([PAPER_CASE, filter_key(runs.NONE)]) else None,
        _table_2(results) if results.has([epsilon_key(EPSILONS_M[0], runs.CYCLES_MS[0], learned=True)]) else None,
        _ours(results) if results.has([key for _, key in _OURS]) else None,
    ]
    return [one for one in drawn if one is not None]


def _picture(name: str, title: str, caption: str, draw: Callable[[Axes], None]) -> Picture:
    with panels.drawing("none"):
        figure = Figure(figsize=(8.5, 3.6), layout="constrained")
        axes = figure.subplots()
        draw(axes)
        axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
        return Picture(name, title, caption, svg(figure, name, title))


def _curve(
    axes: Axes, x: Sequence[float], y: Sequence[float | None], number: int, label: str, dashed: bool = False
) -> None:
    known = [(a, b) for a, b in zip(x, y, strict=True) if b is not None]
    axes.plot(
        [a for a, _ in known],
        [b for _, b in known],
        color=Style(number).colour,
        marker="" if dashed else _MARKERS[number],
        linestyle="--" if dashed else "-",
        markersize=3.5,
        linewidth=0.9 if dashed else 1.2,
        label=label,
    )


def _mark_printed(axes: Axes, x: float, error_m: float) -> None:
    axes.plot([x], [error_m], "k*", markersize=8, linestyle="none", label="published")


def _by_run(results: Results, key: str, figure: str) -> list[float | None]:
    return [results.value(key, of_run(figure, number)) for number in _NUMBERS]


def _figure_6(results: Results) -> Picture:
    def errors(axes: Axes) -> None:
        for number, (label, key) in enumerate((("packet", PAPER_CASE), ("no filter", filter_key(runs.NONE)))):
            _curve(axes, _NUMBERS, _by_run(results, key, MEAN), number, label)
            _curve(axes, _NUMBERS, _by_run(results, key, P95), number, f"{label}, 95 %", dashed=True)
        _mark_printed(axes, PRINTED["iterations"], PRINTED["error_m"])
        axes.axhline(PRINTED["limit_m"], color="0.7", linewidth=0.8)
        axes.set(yscale="log", ylabel="error (m)", xlabel="number of the run")
        _plain(axes)

    caption = (
        f"Mean error and 95 % of the errors over {len(results.seeds)} sequences. Grey: the limit of 0.3 m. The paper's "
        "figure is one sequence."
    )
    return _picture("figure_6", "Figure 6: error by the number of the run", caption, errors)


def _table_2(results: Results) -> Picture:
    def errors(axes: Axes) -> None:
        for number, (learned, cycle_ms, label) in enumerate(READINGS):
            _curve(axes, EPSILONS_M, [*find_mean_errors(results, learned, cycle_ms).values()], number, label)
        for epsilon_m, (error_m, _) in PRINTED["table_2"].items():
            _mark_printed(axes, float(epsilon_m), error_m)
        axes.set(ylabel="mean error (m)", xlabel="eps (m)", ylim=(0, None))

    caption = "Mean error over eps in four readings of table 2, of whose rows only one is known."
    return _picture("table_2", "Table 2: tolerance eps", caption, errors)


def _ours(results: Results) -> Picture:
    def errors(axes: Axes) -> None:
        for number, (label, key) in enumerate(_OURS):
            _curve(axes, _NUMBERS, _by_run(results, key, RMS), number, label)
        axes.set(yscale="log", ylabel="rms (m)", xlabel="number of the run")
        _plain(axes)

    caption = f"Rms of the stop error over {len(results.seeds)} sequences of trains with scatter, each law learning."
    return _picture("ours", "Learning of the paper's law and of ours on trains with scatter", caption, errors)


def _plain(axes: Axes) -> None:
    """Labels of a logarithmic axis as numbers: the usual ones are formulas, which the style leaves as they are."""
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, place: f"{value:g}"))
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
    axes.yaxis.set_minor_formatter(NullFormatter())
