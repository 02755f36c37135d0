"""Random numbers that a test has written down."""

from __future__ import annotations

from collections.abc import Iterable


class Scripted:
    """:class:`railhil.faults.model.Random` with given numbers, then 0.5.

    ``ranges``: those asked for by ``integers``.
    """

    def __init__(self, numbers: Iterable[float] = ()) -> None:
        self._numbers = list(numbers)
        self.ranges: list[tuple[int, int]] = []

    @property
    def left(self) -> int:
        """How many numbers have not been asked for."""
        return len(self._numbers)

    def random(self) -> float:
        """The next number."""
        return self._numbers.pop(0) if self._numbers else 0.5

    def integers(self, low: int, high: int, /) -> int:
        """The next number, whatever the range."""
        self.ranges.append((low, high))
        return int(self._numbers.pop(0))
