"""The papers on nonlinear generalized predictive control of high-speed trains: with an extreme learning machine (one
power unit, DOI 10.12677/mos.2024.135479) and of three power units.

::

    published.py   what they print
    names.py       names of the runs and of their figures
    runs.py        the protocol, and the figures of a run
    tables.py      modelling error, tracking, emergency stop, computing effort
    statements.py  what the papers say about them
    pictures.py    figures 8 to 13
    readings.py    how the papers are read
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from railhil.reproduce.ngpc.readings import readings
from railhil.reproduce.ngpc.runs import PROTOCOL, curves, measure, planned
from railhil.reproduce.ngpc.statements import statements
from railhil.reproduce.ngpc.tables import tables
from railhil.reproduce.paper import Paper, Results

if TYPE_CHECKING:
    from railhil.report.figures import Picture


def figures(results: Results) -> Sequence[Picture]:
    """Figures 8 to 13.

    :raises ImportError: the extra [report] is not installed.
    """
    from railhil.reproduce.ngpc.pictures import pictures

    return pictures(results)


PAPER = Paper(
    name="ngpc",
    title="Nonlinear generalized predictive control of high-speed trains (ELM-NGPC)",
    source='Xu Jianliang et al., "Application and Research on Nonlinear Generalized Predictive Control Method of '
    'High-Speed Train", Modeling and Simulation 13(5), 2024, DOI 10.12677/mos.2024.135479',
    protocol=PROTOCOL,
    seeds=(211, 212, 213, 214, 215),
    planned=planned,
    measure=measure,
    curves=curves,
    tables=tables,
    statements=statements,
    figures=figures,
    readings=readings,
)
