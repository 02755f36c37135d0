"""The controller of an environment: each command comes from outside.

The handshake of a run has name and digest of the controller's file. A run of an environment and one that plays its
commands again have the same bytes, since both have the class of this file as their controller.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

#: One number for each command of the system, in its unit.
Command = Sequence[float]


class GymCommands:
    """A controller in Python, for one run.

    :param ask: gives the command for a reading.
    """

    def __init__(self, ask: Callable[[Any], Command]) -> None:
        self._ask = ask

    @classmethod
    def play(cls, commands: Iterable[Command]) -> GymCommands:
        """A controller that plays the commands of an episode again (``RunEnv.commands``).

        A run with more control periods than commands is INVALID.
        """
        listed = list(commands)
        each = iter(listed)

        def ask(reading: Any) -> Command:
            try:
                return next(each)
            except StopIteration:
                raise LookupError(f"no command after the {len(listed)} given") from None

        return cls(ask)

    def step(self, reading: Any) -> Command:
        """One control period."""
        return self._ask(reading)
