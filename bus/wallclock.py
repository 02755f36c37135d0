"""Interface of the wall clock: the module :mod:`time`, or a replacement."""

from __future__ import annotations

from typing import Protocol


class WallClock(Protocol):
    """Monotonic wall time and waiting; the module :mod:`time` is one."""

    def monotonic(self) -> float:
        """Monotonic wall time in s."""

    def monotonic_ns(self) -> int:
        """The same in ns."""

    def sleep(self, seconds: float, /) -> None:
        """Wait for this many seconds."""
