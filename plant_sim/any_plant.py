"""The interface of a plant of any system, as used by the tick loop and the bus."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import ClassVar, Final, Protocol

from railhil.bus.codes import Event
from railhil.bus.layout import Telegram
from railhil.common.exit_codes import INVALID

#: Longest time to wait for a train to stop after its controller was lost.
BRAKING_MAX_NS: Final = 300_000_000_000


class PlantError(Exception):
    """The simulation itself failed: its state is no longer finite, or the wire cannot carry it. A tool error, never a
    verdict on a run."""


class FaultTooLarge(PlantError):
    """A fault drives the plant beyond the range of the truth's signals. The run is INVALID, because its record cannot
    show what happened; the bench has no defect.

    :cvar SAID: part of its sentence.
    """

    exit_code = INVALID
    SAID: ClassVar[str] = "beyond the range of the record"


class Happened(Protocol):
    """Something that happened inside a tick, at its exact instant and true position.

    ``kind``: a milestone in lower case, either the bench's (:class:`railhil.bus.codes.Event`) or the system's own,
    or anything that :meth:`AnyPlant.telegram_of` turns into a telegram.
    """

    @property
    def kind(self) -> str:
        """The kind of event."""

    @property
    def instant_01ms(self) -> int:
        """Its instant, in 0.1 ms."""

    @property
    def position_01mm(self) -> int:
        """Its position, in 0.1 mm."""


class Ending(Protocol):
    """When a run is over."""

    #: No run with a live controller ends before this tick.
    due_tick: int

    def happened(self, kind: str, tick: int) -> None:
        """Note an event that occurred before this tick."""

    def reached(self, tick: int, controller_lost: bool) -> Event | None:
        """The event that ends the run at this tick, None if the run continues."""


class AnyPlant(Protocol):
    """A simulated plant, advanced tick by tick (``scenario.timing.base_tick_ns``), and its telegrams.

    All readings are those of the instant ``tick * base_tick``, before :meth:`advance`.
    """

    tick: int
    #: For each published port, the function that makes its telegram; it returns None when nothing is to be sent.
    makers: Mapping[str, Callable[[], Telegram | None]]

    @property
    def commands(self) -> Mapping[str, type[Telegram]]:
        """Telegram classes of the controller's ports from which it takes commands, in the order of the polls."""

    @property
    def statuses(self) -> Sequence[str]:
        """Ports of the controller that are polled only for the record; once more before the run ends."""

    @property
    def refused(self) -> Mapping[str, int]:
        """Counters of refused commands, by cause."""

    @property
    def position_01mm(self) -> int:
        """Its position, for the milestones."""

    @property
    def ending(self) -> Ending:
        """The condition that ends the run."""

    def take(self, telegram: Telegram) -> None:
        """Take a telegram of one of :attr:`commands` at the current tick; the plant decides whether it is accepted."""

    def advance(self) -> None:
        """Simulate one base tick.

        :raises PlantError: the state is no longer finite.
        """

    def drain_events(self) -> Sequence[Happened]:
        """Events since the last call, in order of their instants."""

    def telegram_of(self, event: Happened) -> Telegram | None:
        """The telegram that reports an event immediately; None: it is a milestone of the run (RUN_EVENT)."""

    def is_abandoned(self, command_age_ns: int) -> bool:
        """Whether a plant whose newest command has this age stands because it got no commands."""
