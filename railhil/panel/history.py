"""The rows of a run that a page gets which connects later."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from railhil.record.trace import FloatArray

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
        picked = rows if self.stride == 1 else rows[(number % self.stride == 0) | is_gap(rows, self._position)]
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
