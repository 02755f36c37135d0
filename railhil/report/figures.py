"""Pictures that matplotlib has drawn, as inline SVG: text stays text, identifiers are unique in the page."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure as Sheet

from railhil.charts.figure import Figure
from railhil.report.panels import drawing, sheet

_LONG_NUMBER = re.compile(r"(\d\.\d\d)\d+")
_IDENTIFIER = re.compile(r'(\bid="|url\(#|href="#)')


@dataclass(frozen=True, slots=True)
class Picture:
    """One figure: ``name`` is its anchor, ``svg`` the element itself."""

    name: str
    title: str
    caption: str
    svg: str


def printed(figures: Sequence[Figure]) -> list[Picture]:
    """Figures of a page as pictures that need no page around them."""
    with drawing("none"):
        return [Picture(one.name, one.title, one.caption, svg(sheet(one), one.name, one.title)) for one in figures]


def svg(figure: Sheet, name: str, title: str) -> str:
    """The figure as an element of a page.

    Coordinates keep two decimals (a hundredth of a point), which halves the file; identifiers are prefixed with the
    name; the style sheet, which would apply to the whole page, is left to the page.
    """
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    body = text.getvalue()
    body = body[body.index("<svg") :]
    body = re.sub(r"<defs>\s*<style.*?</style>\s*</defs>", "", body, flags=re.DOTALL)
    body = _IDENTIFIER.sub(rf"\g<1>{name}-", body)
    body = _LONG_NUMBER.sub(r"\1", body)
    # The page sets the width; the height follows from the view box.
    body = re.sub(r'^<svg([^>]*?) width="[^"]*"', r"<svg\1", body, count=1)
    body = re.sub(r'^<svg([^>]*?) height="[^"]*"', rf'<svg\1 role="img" aria-label="{title}"', body, count=1)
    return body.strip()
