"""Pages from templates: their escaping and search path, script and styles inside them, and their files.

``frame.html.j2`` is the frame of the page of every study; its blocks are ``style`` and ``body``.
"""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple
from urllib.parse import quote

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, Template

from railhil.charts import static_text
from railhil.charts.figure import Figure
from railhil.charts.svg import markup
from railhil.common.streams import escape_controls
from railhil.record.hash_list import REPORT, listed_file

if TYPE_CHECKING:
    # This import loads matplotlib, which a page does not need.
    from railhil.report.pictures import Picture


class Link(NamedTuple):
    """A text that leads to an address relative to the page."""

    text: str
    href: str


def script() -> str:
    """The program of a page, by which a reader uses its figures."""
    return static_text("view.js") + static_text("figures.js")


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


def render_page(name: str, package: str = _HERE, **values: Any) -> str:
    """A page as one HTML document without external references.

    :param name: of its template; ``package`` as in :func:`template`. :param values: names in it.
    """
    return template(name, package).render(chart_scripts=script(), chart_styles=styles_text(), **values)


def address_of(folder: Path, out: Path) -> str:
    """Address of a run in a page: its own report, else its folder; empty if there is no such folder."""
    target = folder / REPORT if (folder / REPORT).is_file() else folder
    return quote(Path(os.path.relpath(target, out.parent)).as_posix()) if target.exists() else ""


def write_html(text: str, out: Path) -> None:
    """Write a page completely or not at all.

    :raises InputError: it is a file of a signed folder.
    :raises OSError: it cannot be written.
    """
    with listed_file(out) as draft:
        draft.write_text(text, encoding="utf-8")
