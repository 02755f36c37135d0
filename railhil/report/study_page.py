"""The page of a study: its verdict first, then sentences, tables and figures in their order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from railhil.charts.figure import Figure
from railhil.report.templates import Link, render_page

if TYPE_CHECKING:
    from railhil.report.pictures import Picture


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of texts; the first cell of each names it. A cell that begins with ``railhil`` is a command.

    ``name``: its anchor. ``heads``: of the columns; empty: none. ``kind``: ``scores`` (numbers), ``sources`` (words) or
    ``facts``. ``note``: below it.
    """

    name: str
    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str | Link]]
    kind: str = "scores"
    note: str = ""


#: A sentence, a table or a figure of the page.
Part: TypeAlias = "str | Table | Figure | Picture"


def study_page(
    title: str,
    lead: str,
    parts: Sequence[Part],
    verdicts: Sequence[tuple[str, str]] = (),
    warnings: Sequence[str] = (),
    recorded: str = "",
) -> str:
    """The page as one HTML document.

    :param lead: what was done. ``verdicts``: a badge (it begins with PASS, FAIL or INVALID) and what it is about.
    :param warnings: sentences below the verdicts.
    :param recorded: when, where, by whom and with which version it was begun, in a sentence.
    """
    return render_page(
        "study.html.j2", title=title, lead=lead, parts=parts, verdicts=verdicts, warnings=warnings, recorded=recorded
    )
