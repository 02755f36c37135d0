"""The paper on precise stopping with a wavelet packet and iterative learning: figure 6 and tables 2 and 3; bands of
railhil's specification, ours on a train with scatter, and memories that are damaged."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from railhil.reproduce.ilc.findings import check, compare
from railhil.reproduce.ilc.runs import TEXT, measure, plan
from railhil.reproduce.paper import Paper, Results

if TYPE_CHECKING:
    from railhil.report.pictures import Picture


def draw(results: Results) -> Sequence[Picture]:
    """Figure 6, table 2 as curves, and the learning of ours.

    :raises ImportError: the extra [report] is not installed.
    """
    from railhil.reproduce.ilc.figures import draw

    return draw(results)


PAPER = Paper("ilc", TEXT, plan, measure, compare, check, draw)
