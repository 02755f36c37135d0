"""Signals that end a run, taken where nothing is half done."""

from __future__ import annotations

import signal
from types import FrameType, TracebackType
from typing import Any


class StopSignals:
    """Notes SIGINT and SIGTERM for a loop to look at.

    As an exception they would strike anywhere, and inside a buffered write they cost what the buffer held.
    """

    def __init__(self) -> None:
        #: Number of the signal that came, 0 for none.
        self.number = 0
        self._before: dict[signal.Signals, Any] = {}

    def __enter__(self) -> StopSignals:
        self._before = {number: signal.signal(number, self._note) for number in (signal.SIGINT, signal.SIGTERM)}
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _note(self, number: int, at: FrameType | None) -> None:
        self.number = number

    def check(self) -> None:
        """Raise what the signal would have raised, here.

        :raises KeyboardInterrupt: SIGINT came.
        :raises SystemExit: SIGTERM came.
        """
        if self.number == signal.SIGINT:
            raise KeyboardInterrupt
        if self.number:
            raise SystemExit(128 + self.number)
