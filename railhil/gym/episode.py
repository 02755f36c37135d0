"""A run that waits at each control period for its commands.

The run is in a thread of its own, since the node of the controller asks for a command from within the run. Only one
side computes at a time: the run while the caller waits, and the caller while the run waits.
"""

from __future__ import annotations

from collections.abc import Callable
from queue import SimpleQueue
from threading import Thread
from typing import Any

from railhil.gym.commands import Command, GymCommands
from railhil.judge.result import Result


class EpisodeLeft(BaseException):
    """Ends a run that nobody will give commands any more. No ``Exception``: code that reports those of a controller
    must let it pass."""


class Episode:
    """One run, from its first control period to its result.

    :param make: makes the run with a controller; called in the thread of the run.
    """

    def __init__(self, make: Callable[[GymCommands], Result]) -> None:
        self._said: SimpleQueue[Any] = SimpleQueue()
        self._commands: SimpleQueue[Command | None] = SimpleQueue()
        # A program that ends does not wait for a run that waits for it.
        self._thread = Thread(target=self._work, args=(make,), name="railhil.gym", daemon=True)
        self._thread.start()

    def _work(self, make: Callable[[GymCommands], Result]) -> None:
        try:
            found: object = make(GymCommands(self._ask))
        except EpisodeLeft:
            return
        except BaseException as error:
            # Raised again where the caller waits.
            found = error
        self._said.put(found)

    def _ask(self, reading: Any) -> Command:
        self._said.put(reading)
        command = self._commands.get()
        if command is None:
            raise EpisodeLeft
        return command

    def wait(self) -> Any:
        """The readings of the next control period, or the :class:`~railhil.judge.result.Result` of the run.

        :raises BaseException: that with which the run has ended.
        """
        found = self._said.get()
        if isinstance(found, BaseException):
            raise found
        return found

    def give(self, command: Command) -> None:
        """Give the commands for the readings that :meth:`wait` has returned."""
        self._commands.put(command)

    def leave(self) -> None:
        """End the run, unless it has ended; nothing waits for its result."""
        self._commands.put(None)
        self._thread.join()
