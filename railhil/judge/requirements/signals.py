"""Sentences over the signals of any model: the same language, judged without a record, a scenario and a bus."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property

import numpy as np
import numpy.typing as npt

from railhil.dbc import Contract
from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.names import Names, Quantity
from railhil.judge.requirements.outcome import Outcome, judge_one
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.units import unit_of
from railhil.record.trace import FloatArray


class _SignalGrid(Grid):
    """Given values at each tick; there are no ports, no events and no scores."""

    def __init__(self, signals: Mapping[str, FloatArray], tick_ns: int) -> None:
        self.tick_ns = tick_ns
        self.signals = signals
        self.count = len(next(iter(signals.values())))
        self.kept = {}

    def occurs(self, event: str) -> npt.NDArray[np.bool_]:
        """None at any tick."""
        return np.zeros(self.count, dtype=bool)


class SignalNames(Names):
    """The names of given signals.

    :param units: of each signal by its name. :param tick_ns: time from one sample to the next.
    """

    def __init__(self, units: Mapping[str, str], tick_ns: int) -> None:
        self.contract = Contract(0, 0, 0, tick_ns, (), "")
        self.tick_ns = tick_ns
        self._units = dict(units)

    @cached_property
    def values(self) -> Mapping[str, Quantity]:
        """The signals."""
        return {name: self._column(name, unit) for name, unit in self._units.items()}

    @staticmethod
    def _column(name: str, unit: str) -> Quantity:
        def values(grid: Grid) -> FloatArray:
            assert isinstance(grid, _SignalGrid)
            return grid.signals[name]

        return Quantity(unit_of(unit), values)

    @cached_property
    def levels(self) -> Mapping[str, list[Quantity]]:
        """None."""
        return {}

    @cached_property
    def events(self) -> frozenset[str]:
        """None."""
        return frozenset()

    @cached_property
    def scores(self) -> Mapping[str, Quantity]:
        """None."""
        return {}


class SignalJudge:
    """Judges the signals of many runs of a model by the same requirements.

    :raises InputError: a sentence does not fit the signals.
    """

    def __init__(self, requirements: Iterable[Requirement], units: Mapping[str, str], tick_ns: int) -> None:
        names = SignalNames(units, tick_ns)
        self._bound = [(one, one.bind(names)) for one in requirements]
        self._units, self._tick_ns = names.values.keys(), tick_ns

    def outcomes(self, signals: Mapping[str, FloatArray]) -> tuple[Outcome, ...]:
        """What a run makes of each requirement.

        :param signals: of every name an array of the same shape (ticks,), from instant 0 on; NaN: not known.
        :raises ValueError: a signal is missing, or one is longer than another.
        """
        if signals.keys() != self._units or len({len(values) for values in signals.values()}) != 1:
            raise ValueError(f"found signals {sorted(signals)}, allowed {sorted(self._units)}, all of the same length")
        grid = _SignalGrid(signals, self._tick_ns)
        return tuple(judge_one(one, bound, grid) for one, bound in self._bound)
