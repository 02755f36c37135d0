"""The templates of pages: their escaping and search path; script and styles inside them."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Final

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, Template

from railhil.charts import static_text
from railhil.charts.figure import Figure
from railhil.charts.svg import markup
from railhil.common.streams import escape_controls

if TYPE_CHECKING:
    # This import loads matplotlib, which a page does not need.
    from railhil.report.pictures import Picture


def script() -> str:
    """The program of a page, by which a reader uses its figures."""
    return static_text("figures.js")


def styles_text() -> str:
    """The style sheets of the figures, with the colours of both schemes."""
    return static_text("charts.css") + static_text("figures.css")


_HERE: Final = "railhil.report"


def _element(figure: Figure | Picture) -> str:
    """The element of a figure; a system may have drawn its own."""
    return markup(figure) if isinstance(figure, Figure) else figure.svg


@cache
def template(name: str, package: str = _HERE) -> Template:
    """A template, searched in a package and then in this one; compiling the template of a run takes 30 ms.

    :param package: dotted name.
    :raises jinja2.TemplateNotFound: there is none of this name.
    """
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(folder, ".") for folder in dict.fromkeys((package, _HERE))]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        # Markup and drawings are already escaped.
        finalize=lambda value: escape_controls(value) if type(value) is str else value,
    )
    environment.filters["svg"] = _element
    return environment.get_template(name)
