"""Signals that end a run, handled only at safe points."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any

from railhil.common.exit_codes import Signalled, ending_signals, leave_terminal


class StopSignals:
    """Notes SIGINT, SIGTERM and SIGHUP for a loop to check; re-entrant.

    As exceptions they could occur anywhere, and inside a buffered write the content of the buffer would be lost.
    """

    def __init__(self) -> None:
        #: Number of the first signal received, 0 for none.
        self.number = 0
        self._before: dict[signal.Signals, Any] = {}
        self._entered = 0
        self._at_once = False

    def __enter__(self) -> StopSignals:
        self._entered += 1
        # Python delivers signals only to its main thread; another thread of a user's program cannot handle them.
        if self._entered == 1 and threading.current_thread() is threading.main_thread():
            self._before = {number: signal.signal(number, self._note) for number in ending_signals()}
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._entered -= 1
        if self._entered == 0:
            for number, handler in self._before.items():
                signal.signal(number, handler)
            self._before = {}

    @contextmanager
    def at_once(self) -> Iterator[None]:
        """A section that may be interrupted anywhere: a signal raises there at once, like :meth:`check`."""
        self._at_once = True
        try:
            self.check()
            yield
        finally:
            self._at_once = False

    def _note(self, number: int, at: FrameType | None) -> None:
        if number == signal.SIGHUP:
            leave_terminal()
        self.number = self.number or number
        if self._at_once:
            self.check()

    def check(self) -> None:
        """Raise here what the signal would have raised.

        :raises KeyboardInterrupt: SIGINT came.
        :raises Signalled: SIGTERM or SIGHUP came.
        """
        if self.number == signal.SIGINT:
            raise KeyboardInterrupt
        if self.number:
            raise Signalled(128 + self.number)
