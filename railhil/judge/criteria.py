"""Criteria by which the runs of a system are judged. Each system defines its own, each once.

Score, tables, JUnit cases, campaign, tuning, audit and report iterate over such a tuple and know no criterion by name.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from railhil.common.digits import text_beside_limit

#: Key of the distance from the stopping point, in every system that scores it.
STOP_ERROR_KEY = "stop_error_m"
#: Stop errors, in m, for which runs are counted in addition to the scenario's own limit: the stricter figures stay
#: visible.
STOP_WITHIN_M = (0.1, 0.2, 0.3)
#: Description of a run without a value, for a criterion of a stop.
DID_NOT_STOP = "did not stop"


def _always(scenario: Any) -> bool:
    return True


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit of a scenario: ``of`` reads it, ``place`` is its position where the limits are listed."""

    of: Callable[[Any], float]
    place: int


@dataclass(frozen=True, slots=True)
class Criterion:
    """One score of a run.

    ``key`` names it in ``score.json`` and in columns, ``title`` for readers; ``unit`` in ASCII. ``measure`` gives its
    value, with the sign if it has one; None: the run ended before. ``digits`` are the decimals for one run in a table;
    published rows, statistics over runs and a tuning's table have the same unless specified.

    ``signed``: key of the same value with its sign; the score itself then has no sign. ``limit``: None if the
    scenario has none. ``audit_allowed``: allowed difference of a median in fixed point from the median in float64, in
    ``unit``; None: a share of the value is allowed.

    ``on_terminal``: whether a terminal's table of runs, which has 100 columns, shows it.

    ``applies``: whether runs of a scenario have it at all. If so, a run without a value is infinitely bad in
    statistics; ``without`` describes it in words.
    """

    key: str
    title: str
    unit: str
    digits: int
    measure: Callable[[Any], float | None]
    better: Literal["low", "high"] = "low"
    limit: Limit | None = None
    signed: str | None = None
    published_digits: int | None = None
    statistics_digits: int | None = None
    tuning_digits: int | None = None
    audit_allowed: float | None = None
    applies: Callable[[Any], bool] = _always
    without: str = "no value"
    on_terminal: bool = True

    @property
    def unit_typeset(self) -> str:
        """The unit with superscripts, for a page: m/s²."""
        return re.sub(r"(?<=[a-z])[23]", lambda power: {"2": "²", "3": "³"}[power[0]], self.unit)

    @property
    def heading(self) -> str:
        """Title and unit on two lines, for a terminal."""
        return f"{self.title} {self.unit}".replace(" ", "\n", 1)

    @property
    def brief(self) -> str:
        """The title without the word ``error`` at its end."""
        return self.title.removesuffix(" error")

    @property
    def name(self) -> str:
        """The title as one word, for JUnit."""
        return self.title.replace(" ", "_")

    def shown(self, value: float | None, digits: int | None = None) -> str:
        """A value formatted with its digits; ``-`` for none."""
        return "-" if value is None else f"{value:.{self.digits if digits is None else digits}f}"

    def bound(self, limit: float) -> str:
        """A limit with its unit and the side on which values are allowed."""
        sign = "+-" if self.signed else "<= " if self.better == "low" else ">= "
        return f"{sign}{limit:.10g} {self.unit}"

    def best(self, values: Sequence[float]) -> float:
        """The best of the values."""
        return min(values) if self.better == "low" else max(values)

    def badness(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values with their sign changed if necessary, so that less is better; NaN is kept."""
        return values if self.better == "low" else -values

    def limit_in(self, scenario: Any) -> float | None:
        """The limit of the scenario; None: the scenario has no limit for this criterion."""
        return None if self.limit is None or not self.applies(scenario) else self.limit.of(scenario)

    def inside(self, scenario: Any, values: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Marks the values (without sign) that the scenario allows; NaN (a run that ended before) is not allowed."""
        limit = self.limit_in(scenario)
        assert limit is not None
        return np.asarray(values <= limit if self.better == "low" else values >= limit, dtype=np.bool_)

    def missed(self, scenario: Any, value: float | None) -> str:
        """The miss of a value (with its sign) in words; empty if it keeps the limit, or if there is no limit."""
        limit = self.limit_in(scenario)
        if value is None or limit is None:
            return ""
        if self.signed is not None:
            shown = text_beside_limit(value, limit, 3, "+")
            return "" if abs(value) <= limit else f"{shown} {self.unit}, allowed +-{limit:.10g} {self.unit}"
        if value <= limit if self.better == "low" else value >= limit:
            return ""
        bound = "at most" if self.better == "low" else "at least"
        return f"{text_beside_limit(value, limit, self.digits)} {self.unit}, allowed {bound} {limit:.10g} {self.unit}"


@dataclass(frozen=True, slots=True)
class Extra:
    """A figure of a run that is not a score: 0 in a good run, otherwise the size of a forbidden event.

    ``key`` names it in ``score.json`` and in columns, ``name`` for readers; ``counted`` is the key in ``summary.json``
    for the number of runs in which it is not 0, ``heading`` the heading of that number on a terminal.
    ``tuning_weight``: its part of the objective of ``railhil tune``, per unit.
    """

    key: str
    name: str
    counted: str
    heading: str
    tuning_weight: float = 1.0


def limited(criteria: Sequence[Criterion], scenario: Any = None) -> list[Criterion]:
    """The criteria with a limit, in the order in which limits are listed.

    :param scenario: only the criteria that apply to it; None: all.
    """
    if scenario is not None:
        criteria = [criterion for criterion in criteria if criterion.applies(scenario)]
    placed = [(criterion.limit.place, criterion) for criterion in criteria if criterion.limit is not None]
    return [criterion for _, criterion in sorted(placed, key=lambda pair: pair[0])]


def limit_key(criterion: Criterion) -> str:
    """Key of a limit in documents: the key of the limited value, with sign if it has one."""
    return criterion.signed or criterion.key


def with_sign(criteria: Sequence[Criterion]) -> dict[str, Criterion]:
    """The criteria that have a sign, by the key of the signed value."""
    return {criterion.signed: criterion for criterion in criteria if criterion.signed is not None}


def scores(
    measured: Mapping[str, float | None], criteria: Sequence[Criterion]
) -> tuple[dict[str, float | None], dict[str, float | None]]:
    """Scores by key, and the signed values by their keys, from the measurements (by key, with sign)."""
    values: dict[str, float | None] = {}
    signed: dict[str, float | None] = {}
    for criterion in criteria:
        value = values[criterion.key] = measured[criterion.key]
        if criterion.signed is not None:
            signed[criterion.signed] = value
            values[criterion.key] = None if value is None else abs(value)
    return values, signed


def unscored(criteria: Sequence[Criterion]) -> tuple[dict[str, float | None], dict[str, float | None]]:
    """As :func:`scores`, for a record without a complete run."""
    return scores(dict.fromkeys(criterion.key for criterion in criteria), criteria)
