"""The rows of a run since its beginning, in bounded memory, for pages that join later."""

from __future__ import annotations

import numpy as np

from railhil.supervisor.trace import FloatArray

#: Rows kept at most; then the older ones become half as dense.
ROWS_MAX = 24_000


class History:
    """Rows of one run; ``stride``: every how many rows one is kept."""

    def __init__(self, width: int) -> None:
        self._rows: FloatArray = np.empty((ROWS_MAX, width))
        self._count = 0
        self._seen = 0
        self.stride = 1

    def add(self, rows: FloatArray) -> None:
        """Append rows in the order of time."""
        picked = rows[-self._seen % self.stride :: self.stride]
        self._seen += len(rows)
        for start in range(0, len(picked), ROWS_MAX // 2):
            part = picked[start : start + ROWS_MAX // 2]
            if self._count + len(part) > ROWS_MAX:
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
        kept = self._rows[: self._count : 2].copy()
        self._count = len(kept)
        self._rows[: self._count] = kept
        self.stride *= 2
