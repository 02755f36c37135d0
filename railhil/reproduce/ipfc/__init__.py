"""The paper of IPFC: Tables 1 and 2 and figures 6 to 9, measured on the published scenario.

::

    runs.py        the protocol, and the figures of a run
    tables.py      Tables 1 and 2, the improvements that the text claims, figures 8 and 9 in numbers
    statements.py  what the paper says about them
    pictures.py    figures 6 to 9
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from railhil.report.deviations import Deviation, deviations
from railhil.reproduce.ipfc.runs import PROTOCOL, curves, measure, planned
from railhil.reproduce.ipfc.statements import statements
from railhil.reproduce.ipfc.tables import tables
from railhil.reproduce.paper import Paper, Results

if TYPE_CHECKING:
    from railhil.report.figures import Picture


def figures(results: Results) -> Sequence[Picture]:
    """Figures 6 to 9.

    :raises ImportError: the extra [report] is not installed.
    """
    from railhil.reproduce.ipfc.pictures import pictures

    return pictures(results)


def readings() -> Sequence[Deviation]:
    """Misprints, gaps and choices."""
    return deviations()[1]


PAPER = Paper(
    name="ipfc",
    title="Improved predictive functional control of a metro train (IPFC)",
    source=deviations()[0],
    protocol=PROTOCOL,
    seeds=(0,),
    planned=planned,
    measure=measure,
    curves=curves,
    tables=tables,
    statements=statements,
    figures=figures,
    readings=readings,
)
