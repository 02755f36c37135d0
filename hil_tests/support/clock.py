"""A wall clock for tests: it advances only when it is set or waited on."""

from __future__ import annotations


class SetClock:
    """:class:`railhil.common.patience.WallClock` that moves by waiting and by ``now_ns``.

    :param oversleep_ns: by how much each sleep is too long.
    """

    def __init__(self, now_ns: int = 0, oversleep_ns: int = 0) -> None:
        self.now_ns = now_ns
        self.slept_s: list[float] = []
        self._oversleep_ns = oversleep_ns

    def monotonic(self) -> float:
        """In s."""
        return self.now_ns / 1e9

    def monotonic_ns(self) -> int:
        """In ns."""
        return self.now_ns

    def sleep(self, seconds: float) -> None:
        """Advance by the time slept."""
        self.slept_s.append(seconds)
        self.now_ns += round(seconds * 1e9) + self._oversleep_ns
