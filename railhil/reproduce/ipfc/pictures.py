"""Figures 6 to 9 in the style of the report, drawn from the runs in the controller's fixed point."""

from __future__ import annotations

from dataclasses import replace

from railhil.charts.figure import Figure
from railhil.report.figures import Picture, printed
from railhil.report.styles import styles
from railhil.reproduce.ipfc.runs import USUAL, Drawable, key, laws, scenario
from railhil.reproduce.paper import Results
from railhil.systems.ato import panels as ato_panels
from railhil.systems.ato.panels import Drawn


def pictures(results: Results) -> list[Picture]:
    """The figures, of the first seed."""
    drawn = []
    for law, style in zip(laws(), styles(laws()), strict=True):
        found = results.runs[key(law, USUAL, results.seeds[0])].curves
        assert isinstance(found, Drawable)
        drawn.append(Drawn(law, style, found.curves, found.score))
    figures = {
        "figure_6": _line(),
        "figure_7": ato_panels.speed(scenario(), drawn),
        "figure_8": ato_panels.error(scenario(), drawn),
        "figure_9": ato_panels.stop(scenario(), drawn),
    }
    return printed([_named(figure, name) for name, figure in figures.items()])


def _named(figure: Figure, name: str) -> Figure:
    title = f"{name.capitalize().replace('_', ' ')}: {figure.title[:1].lower()}{figure.title[1:]}"
    return replace(figure, name=name, title=title)


def _line() -> Figure:
    """Figure 6; the curves of the paper's cannot be read from its text."""
    charts = [ato_panels.speed_over_distance(scenario(), []), ato_panels.grade(scenario())]
    caption = "Grades and target curve are chosen: the paper has them only as a picture. The limit is that of Table 1."
    return Figure("figure_6", "Grade and speed limit", caption, charts)
