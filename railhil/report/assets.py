"""Script and styles that stand inside the pages, so that each is one file that fetches nothing."""

from __future__ import annotations

from railhil.charts import static_text


def script() -> str:
    """The program of a page: what a reader can do with its figures."""
    return static_text("figures.js")


def styles_text() -> str:
    """The style sheets of the figures, with the colours of both schemes."""
    return static_text("charts.css") + static_text("figures.css")
