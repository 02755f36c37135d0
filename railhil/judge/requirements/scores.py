"""Sentences on the scores of a run alone, such as ``at stopped abs(stop_error) <= 0.3 m``, for many runs at once: their
margins need no record."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from railhil.common.errors import InputError
from railhil.judge.requirements import syntax
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.names import Names, Quantity, Values
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.score import Score
from railhil.record.trace import FloatArray, Trace

#: (scores of n runs) -> their margins, shape (n,); NaN: the run has no such score.
ScoreMargins: TypeAlias = Callable[[Sequence[Score]], FloatArray]
_AT_ITS_END = ("stopped", "end")


class _Runs(Grid):
    """Many runs in the place of the ticks of one."""

    def __init__(self, scores: Sequence[Score]) -> None:
        # A grid without a record: its values are the scores.
        self.scores, self.count = scores, len(scores)
        self.kept: dict[object, FloatArray] = {}


class _ScoreNames(Names):
    """The scores are the only names."""

    @cached_property
    def values(self) -> Mapping[str, Quantity]:
        return {}

    @cached_property
    def levels(self) -> Mapping[str, list[Quantity]]:
        return {}

    def score_values(self, key: str) -> Values:
        def values(grid: Grid) -> FloatArray:
            assert isinstance(grid, _Runs)
            found = [one.signed.get(key, one.values.get(key)) for one in grid.scores]
            return np.array([np.nan if value is None else value for value in found], dtype=np.float64)

        return values


def score_margins(requirement: Requirement, scenario: Any) -> ScoreMargins | None:
    """The margins of a requirement from scores; None: it needs the record of a run.

    The run has one stop, or none. The requirement fits the scenario
    (:func:`railhil.judge.requirements.requirement.check_requirements`).
    """
    names = _ScoreNames(scenario, Trace(scenario.installed_system.contract))
    try:
        bound = requirement.bind(names)
    except InputError:
        # It names something else than scores.
        return None
    body = bound.sentence.body
    if bound.sentence.scope is not None or not isinstance(body, syntax.At):
        return None
    event = body.event
    name = event.word if isinstance(event, syntax.Limit) else getattr(event, "name", "")
    if name not in _AT_ITS_END:
        return None
    return lambda scores: bound.condition.on(_Runs(scores))
