"""Signals that end a run, taken where nothing is half done."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any

from railhil.common.exit_codes import ending_signals, leave_terminal


class StopSignals:
    """Notes SIGINT, SIGTERM and SIGHUP for a loop to look at; may be entered again while it is entered.

    As an exception they would strike anywhere, and inside a buffered write they cost what the buffer held.
    """

    def __init__(self) -> None:
        #: Number of the first signal that came, 0 for none.
        self.number = 0
        self._before: dict[signal.Signals, Any] = {}
        self._entered = 0
        self._at_once = False

    def __enter__(self) -> StopSignals:
        self._entered += 1
        # Python hands signals to its main thread only; in another, of a user's program, none can be taken.
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
        """A part in which nothing can be half done: a signal raises there as it comes, as :meth:`check` would."""
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
        """Raise what the signal would have raised, here.

        :raises KeyboardInterrupt: SIGINT came.
        :raises SystemExit: SIGTERM or SIGHUP came.
        """
        if self.number == signal.SIGINT:
            raise KeyboardInterrupt
        if self.number:
            raise SystemExit(128 + self.number)
