"""A paper whose run is INVALID: its fault never begins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hil_tests.support import short_paper
from railhil.reproduce.paper import Planned


def planned(seeds: Sequence[int]) -> list[Planned]:
    made = short_paper.planned(seeds)
    return [replace(one, spec=replace(one.spec, faults=("TRN_SPEED loss 30% @1000s",))) for one in made]


PAPER = replace(short_paper.PAPER, name="late", planned=planned)
