"""Rows of the page's columns from telegrams: while they come, and of a whole record."""

from __future__ import annotations

from typing import Any

import numpy as np

from railhil.panel.declared import ERROR, LAMP, Layout
from railhil.scenarios.model import AnyScenario
from railhil.supervisor.judging import judging_of
from railhil.supervisor.sampled import Sampler
from railhil.supervisor.signals import table_of
from railhil.supervisor.trace import FloatArray, Trace


class Rows:
    """Makes rows of one layout.

    :param notes: the law's declaration of its notes; None: not known.
    """

    def __init__(self, scenario: AnyScenario, layout: Layout, notes: Any = None) -> None:
        self._scenario, self._layout, self._notes = scenario, layout, notes
        self._judging = judging_of(scenario)
        plain = [column for column in layout.columns if column.kind != LAMP and column.name != ERROR]
        self._factors = np.array([1.0, *(column.factor for column in plain)])
        self._has_error = any(column.name == ERROR for column in layout.columns)

    def of(self, trace: Trace, after_s: float = -1.0, before_s: float = np.inf) -> FloatArray:
        """One row for each telegram of the truth: time in s, then the columns in their shown units.

        :param after_s, before_s: only rows later than the one and earlier than the other; the present tick is not
            complete.
        :returns: shape (n, 1 + columns); unknown values are NaN.
        """
        layout = self._layout
        _, table = table_of(self._judging, self._scenario, trace, self._notes)
        table = table[(table[:, 0] > after_s) & (table[:, 0] < before_s)]
        time_s, told = table[:, 0], table.shape[1]
        rows: FloatArray = np.empty((len(table), 1 + len(layout.columns)))
        rows[:, :told] = table
        sampler = Sampler(trace, time_s)
        for place, (_, port, signal) in enumerate(self._judging.shown, start=told):
            rows[:, place] = sampler.signal(port, signal)
        plain = len(self._factors)
        rows[:, :plain] *= self._factors
        if self._has_error:
            rows[:, plain] = rows[:, 1 + layout.target] - rows[:, 1 + layout.speed]
        for lamp in layout.lamps:
            rows[:, 1 + lamp.column] = sampler.signal(lamp.port, lamp.signal)
        return rows
