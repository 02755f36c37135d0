"""The paper on precise stopping with a wavelet packet and iterative learning.

::

    published.py   what it prints
    names.py       names of the entries and of their figures
    runs.py        the protocol, and the figures of a set of sequences
    faults.py      memories that are damaged
    bands.py       bands of railhil's specification
    tables.py      figure 6 and tables 2 and 3, and those beside the paper
    statements.py  what the paper says about them
    pictures.py    the same as figures
    readings.py    how the paper is read
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from railhil.reproduce.ilc.readings import readings
from railhil.reproduce.ilc.runs import PROTOCOL, measure, planned
from railhil.reproduce.ilc.statements import statements
from railhil.reproduce.ilc.tables import tables
from railhil.reproduce.paper import Paper, Results

if TYPE_CHECKING:
    from railhil.report.figures import Picture


def figures(results: Results) -> Sequence[Picture]:
    """Figure 6, table 2 as curves, and the learning of ours.

    :raises ImportError: the extra [report] is not installed.
    """
    from railhil.reproduce.ilc.pictures import pictures

    return pictures(results)


PAPER = Paper(
    name="ilc",
    title="Precise stopping with a wavelet packet and iterative learning",
    source="He Hui, Tang Tao (Beijing Jiaotong University), on precise stopping of trains by a wavelet packet and the "
    'iterative "intersection method", after 2016',
    protocol=PROTOCOL,
    seeds=tuple(range(1000, 1150)),
    planned=planned,
    measure=measure,
    tables=tables,
    statements=statements,
    figures=figures,
    readings=readings,
)
