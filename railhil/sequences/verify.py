"""Repeats sequences of ``railhil learn`` through the nodes of the bench: commands, scores and memories must agree."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from railhil.sequences.one import sequence, through_nodes
from railhil.sequences.plan import Plan
from railhil.sequences.study import LEARN
from railhil.sequences.table import row
from railhil.study.table import row as row_of
from railhil.study.verify import Verified, differences, finished_rows


def verify(plan: Plan, folder: Path, sequences: int, draw: int) -> Iterator[Verified]:
    """Run some sequences again through the nodes and compare every run to the last digit.

    :param plan: of the study in the folder.
    :param sequences: their number.
    :param draw: seed of the choice.
    :raises InputError: the folder has no finished study.
    """
    table = finished_rows(LEARN, plan, folder)
    runs = plan.request.runs
    for index in np.random.default_rng(draw).permutation(len(plan.seeds))[:sequences]:
        seed = plan.seeds[int(index)]
        for number, run in enumerate(sequence(plan.scenario, plan.specs(seed), through_nodes), 1):
            ours = row_of(table, int(index) * runs + number - 1)
            bench = row_of(row(seed, number, run, plan.judging), 0)
            which = {"sequence": seed, "run": number}
            yield Verified(f"sequence {seed}, run {number}", which, differences(ours, bench))
