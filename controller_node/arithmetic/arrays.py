"""Operations that are the same for N trains in every number system."""

from __future__ import annotations

from typing import Any

import numpy as np

from railhil.controller_node.arithmetic.base import Arithmetic, Condition, T


class ManyTrains(Arithmetic[T]):
    """Choices between the elements of arrays, and places in tables."""

    def minimum(self, a: Any, b: Any) -> Any:
        return np.minimum(a, b)

    def maximum(self, a: Any, b: Any) -> Any:
        return np.maximum(a, b)

    def where(self, condition: Condition, a: Any, b: Any) -> Any:
        return np.where(condition, a, b)

    def index(self, k: Any, last: int) -> Any:
        return np.clip(k, 0, last)

    def locate(self, table: Any, a: Any) -> Any:
        return np.clip(np.searchsorted(table, a, side="right") - 1, 0, table.size - 2)
