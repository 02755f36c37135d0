"""Rows of the page's columns from telegrams: as they arrive, for a whole record, and for a run since its beginning."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from railhil.judge.judging import judging_of
from railhil.judge.signals import table_of
from railhil.panel.layout import LAMP, Layout
from railhil.record.sampling import Sampler, gap_after, holding_s, silences
from railhil.record.trace import FloatArray, Trace
from railhil.report.display_columns import ERROR
from railhil.scenarios.model import AnyScenario

#: Largest number of rows; beyond it the older ones become half as dense.
HISTORY_ROWS_MAX = 24_000


def is_gap(rows: FloatArray, position: int) -> npt.NDArray[np.bool_]:
    """Marks the rows of gaps, in which only time and position are known; shape (n,).

    :param position: place of its column; -1: there is none.
    """
    known = ~np.isnan(rows[:, 1:])
    if position >= 0:
        known[:, position] = False
    return np.asarray(~known.any(axis=1))


class History:
    """Rows of one run; ``stride``: one of this number of rows is kept, besides the rows of gaps.

    :param position: place of its column; -1: there is none.
    """

    def __init__(self, width: int, position: int = -1) -> None:
        self._position = position
        self._rows: FloatArray = np.empty((HISTORY_ROWS_MAX, width))
        self._count = 0
        self._seen = 0
        self.stride = 1

    def add(self, rows: FloatArray) -> None:
        """Append rows in the order of time."""
        number = self._seen + np.arange(len(rows))
        picked = rows[(number % self.stride == 0) | is_gap(rows, self._position)]
        self._seen += len(rows)
        for start in range(0, len(picked), HISTORY_ROWS_MAX // 2):
            part = picked[start : start + HISTORY_ROWS_MAX // 2]
            if self._count + len(part) > HISTORY_ROWS_MAX:
                self._halve()
            self._rows[self._count : self._count + len(part)] = part
            self._count += len(part)

    @property
    def rows(self) -> FloatArray:
        """The kept rows, shape (n, width)."""
        return self._rows[: self._count]

    def clear(self) -> None:
        """Begin again."""
        self._count = self._seen = 0
        self.stride = 1

    def _halve(self) -> None:
        even, odd = self._rows[: self._count : 2].copy(), self._rows[1 : self._count : 2]
        gaps = is_gap(odd, self._position)
        kept = even
        kept[: len(odd)][gaps] = odd[gaps]
        self._count = len(kept)
        self._rows[: self._count] = kept
        self.stride *= 2


class Rows:
    """Makes rows of one layout.

    :param notes: the law's declaration of its notes; None: not known.
    """

    def __init__(self, scenario: AnyScenario, layout: Layout, notes: Any = None) -> None:
        self._scenario, self._layout, self._notes = scenario, layout, notes
        self._judging = judging_of(scenario)
        self._holds_s = holding_s(scenario, scenario.installed_system.contract)
        self._truth_holds_s = self._holds_s.get(self._judging.truth, np.inf)
        plain = [column for column in layout.columns if column.kind != LAMP and column.name != ERROR]
        self._factors = np.array([1.0, *(column.factor for column in plain)])
        self._has_error = any(column.name == ERROR for column in layout.columns)

    def make(self, trace: Trace, after_s: float = -1.0, before_s: float = np.inf) -> FloatArray:
        """One row for each telegram of the truth: time in s, then the columns in their shown units.

        :param after_s, before_s: only rows after the first and before the second; the present tick is not complete.
        :returns: shape (n, 1 + columns); unknown values are NaN.
        """
        layout = self._layout
        _, table = table_of(self._judging, self._scenario, trace, self._notes, self._holds_s)
        table = table[(table[:, 0] > after_s) & (table[:, 0] < before_s)]
        time_s, width = table[:, 0], table.shape[1]
        rows: FloatArray = np.empty((len(table), 1 + len(layout.columns)))
        rows[:, :width] = table
        sampler = Sampler(trace, time_s, self._holds_s)
        for place, (_, port, signal) in enumerate(self._judging.shown, start=width):
            rows[:, place] = sampler.signal(port, signal)
        plain = len(self._factors)
        rows[:, :plain] *= self._factors
        if self._has_error:
            rows[:, plain] = rows[:, 1 + layout.target] - rows[:, 1 + layout.speed]
        for lamp in layout.lamps:
            rows[:, 1 + lamp.column] = sampler.signal(lamp.port, lamp.signal)
        return rows

    def gap_after(self, rows: FloatArray) -> FloatArray:
        """For each row the row after which nothing is known (:func:`is_gap`)."""
        position = self._layout.position
        return gap_after(rows, 1 + position if position >= 0 else -1)

    def is_over(self, last_s: float, now_s: float) -> bool:
        """Whether the newest row, at ``last_s``, is out of date."""
        return bool(len(silences(np.array([last_s, now_s]), self._truth_holds_s)))

    def insert_gaps(self, rows: FloatArray, before: FloatArray | None = None) -> FloatArray:
        """The rows, with an additional one for each gap between them, so that no line is drawn across it.

        :param before: the row before them, shape (1 + columns,); None: there is none.
        """
        whole = rows if before is None else np.vstack((before, rows))
        last = silences(whole[:, 0], self._truth_holds_s)
        # A gap that is known already.
        last = last[~is_gap(whole[last], self._layout.position)]
        found: FloatArray = np.insert(whole, last + 1, self.gap_after(whole[last]), axis=0)
        return found if before is None else found[1:]
