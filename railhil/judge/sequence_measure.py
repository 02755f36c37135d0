"""Measures over a sequence of runs: the improvement of a criterion with a limit while its law learns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from railhil.judge.criteria import Criterion, limited

if TYPE_CHECKING:
    from railhil.judge.judging import Judging


@dataclass(frozen=True, slots=True)
class SequenceMeasure:
    """A criterion over sequences of runs.

    :param within: limits in the unit of the criterion; the share of runs inside each is given.
    :param converged: a sequence has converged at the first of ``in_a_row`` successive runs inside this limit.
    """

    criterion: Criterion
    within: tuple[float, ...]
    converged: float
    in_a_row: int = 3


def sequence_measures(scenario: Any, judging: Judging) -> Sequence[SequenceMeasure]:
    """The measures of a scenario: its system's, else one for each of its limits."""
    if judging.learned:
        return judging.learned
    found = []
    for criterion in limited(judging.criteria, scenario):
        limit = criterion.limit_in(scenario)
        assert limit is not None
        if criterion.better == "low":
            found.append(SequenceMeasure(criterion, (limit,), limit))
    return found
