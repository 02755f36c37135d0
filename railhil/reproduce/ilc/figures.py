"""Figure 6, table 2 as curves, and the learning of ours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from railhil.batch.case import column
from railhil.charts.figure import Area, Chart, Curve, Figure, Look, Point, extent
from railhil.reproduce.ilc.findings import EPSILONS_M, PRINTED, READINGS, find_mean_errors, list_entries
from railhil.reproduce.ilc.runs import MEAN, NO_FILTER, P95, PAPER_CASE, RMS, RUNS, name_run_figure
from railhil.reproduce.paper import Results

#: Curves of the figure of ours: title, entry.
_DRAWN = {
    "paper's law": "open-learned",
    "observer, no balises": "reaim-no-balises-learned",
    "15 % loss": "reaim-loss-learned",
    "observer, balises": "reaim-learned",
}
_PUBLISHED, _HEIGHT_PX = Look("ink", marker="P", is_full=True), 300
#: Values named at a logarithmic axis, m.
_ROUND_M = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0)


def draw(results: Results) -> list[Figure]:
    """Figure 6, table 2 as curves, and the learning of ours, as far as their entries were made."""
    return [
        *([_draw_figure_6(results)] if results.has([PAPER_CASE, NO_FILTER]) else []),
        *([_draw_table_2(results)] if results.has(READINGS["learned, 16 ms"]) else []),
        *([_draw_ours(results)] if results.has(_DRAWN.values()) else []),
    ]


def _draw_figure_6(results: Results) -> Figure:
    curves = []
    for number, (label, key) in enumerate(list_entries("figure_6").items()):
        curves.append(_draw_runs(results, key, MEAN, label, Look(f"{number}", 1.5)))
        curves.append(_draw_runs(results, key, P95, f"{label}, 95 %", Look(f"{number}", 1.0, (5.0, 3.0))))
    limit = float(np.log10(PRINTED["limit_m"]))
    published = Point("published", PRINTED["iterations"], float(np.log10(PRINTED["error_m"])), _PUBLISHED)
    caption = (
        f"Mean error and 95 % of the errors over {len(results.seeds)} sequences. Grey: the limit of 0.3 m. The paper's "
        "figure is one sequence."
    )
    chart = _make_log_chart(curves, "error (m)", [Area(None, (limit, limit))], [published])
    return Figure("figure_6", "Figure 6: error by the number of the run", caption, [chart])


def _draw_table_2(results: Results) -> Figure:
    tolerances = np.array(EPSILONS_M)
    curves = [
        Curve(reading, tolerances, column(find_mean_errors(results, reading)), Look(f"{number}", 1.5))
        for number, reading in enumerate(READINGS)
    ]
    published = [Point("published", float(at), pair[0], _PUBLISHED) for at, pair in PRINTED["table_2"].items()]
    chart = Chart(curves, "eps (m)", "mean error (m)", y_bounds=(0.0, None), points=published, height_px=_HEIGHT_PX)
    caption = "Mean error over eps in four readings of table 2, of whose rows only one is known."
    return Figure("table_2", "Table 2: tolerance eps", caption, [chart])


def _draw_ours(results: Results) -> Figure:
    curves = [
        _draw_runs(results, key, RMS, label, Look(f"{number}", 1.5))
        for number, (label, key) in enumerate(_DRAWN.items())
    ]
    caption = f"Rms of the stop error over {len(results.seeds)} sequences of trains with scatter, each law learning."
    title = "Learning of the paper's law and of ours on trains with scatter"
    return Figure("ours", title, caption, [_make_log_chart(curves, "rms (m)")])


def _draw_runs(results: Results, key: str, figure: str, label: str, look: Look) -> Curve:
    """The decimal logarithm of a figure over the number of the run."""
    numbers = range(1, RUNS + 1)
    values = column([results.find(key, name_run_figure(figure, number)) for number in numbers])
    return Curve(label, np.array(numbers, dtype=np.float64), np.log10(np.where(values > 0, values, np.nan)), look)


def _make_log_chart(
    curves: Sequence[Curve], label: str, areas: Sequence[Area] = (), points: Sequence[Point] = ()
) -> Chart:
    """Curves of logarithms over the number of the run, with round values at their axis."""
    chart = Chart(curves, "number of the run", label, areas=areas, points=points, height_px=_HEIGHT_PX)
    low, high = extent(chart, "y")
    names = {float(np.log10(value)): f"{value:g}" for value in _ROUND_M}
    return replace(chart, y_names={at: name for at, name in names.items() if low <= at <= high})
