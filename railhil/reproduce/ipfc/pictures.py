"""Figures 6 to 9 in the style of the report, drawn from the runs in the controller's fixed point."""

from __future__ import annotations

from dataclasses import replace

from matplotlib.figure import Figure

from railhil.reproduce.ipfc.runs import USUAL, Drawable, key, laws, scenario
from railhil.reproduce.paper import Results
from railhil.supervisor.report import panels
from railhil.supervisor.report.figures import ATO_PANELS, Picture, Record, panel_pictures, svg
from railhil.supervisor.report.panels import Drawn
from railhil.supervisor.report.styles import styles

#: The report's picture for each figure of the paper.
_FIGURES = {"speed": "figure_7", "error": "figure_8", "stop": "figure_9"}


def pictures(results: Results) -> list[Picture]:
    """The figures, of the first seed."""
    drawn = []
    for law, style in zip(laws(), styles(laws()), strict=True):
        found = results.runs[key(law, USUAL, results.seeds[0])].curves
        assert isinstance(found, Drawable)
        drawn.append(Drawn(law, style, found.curves, found.score))
    shown = [panel for panel in ATO_PANELS if panel.name in _FIGURES]
    made = panel_pictures(Record(scenario(), drawn, ()), shown)
    return [_line(), *(_named(picture, _FIGURES[picture.name]) for picture in made)]


def _named(picture: Picture, name: str) -> Picture:
    return replace(picture, name=name, title=_title(name, picture.title))


def _title(name: str, title: str) -> str:
    return f"{name.capitalize().replace('_', ' ')}: {title[:1].lower()}{title[1:]}"


def _line() -> Picture:
    """Figure 6; the curves of the paper's cannot be read from its text."""
    name = "figure_6"
    title = _title(name, "Grade and speed limit")
    with panels.drawing("none"):
        figure = Figure(figsize=(8.5, 3.6), layout="constrained")
        high, low = figure.subplots(2, 1, sharex=True, height_ratios=(1.6, 1))
        panels.speed_over_distance(high, scenario(), [])
        panels.legend(high)
        panels.grade(low, scenario())
        low.set(xlabel="distance (m)", xlim=(0, scenario().plan.distance_m * 1.01))
        figure.align_ylabels([high, low])
        drawn = svg(figure, name, title)
    caption = "Grades and target curve are chosen: the paper has them only as a picture. The limit is that of Table 1."
    return Picture(name, title, caption, drawn)
