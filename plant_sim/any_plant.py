"""What a plant of any system is to the tick loop and to the bus."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

from railhil.bus.layout import Telegram
from railhil.bus.telegrams import Event


class PlantError(Exception):
    """The simulation itself failed: its state is no longer a number. A tool error, never a verdict on a run."""


class Happened(Protocol):
    """Something that happened inside a tick, at its exact instant and true position.

    ``kind``: a milestone in small letters, the house's (:class:`railhil.bus.telegrams.Event`) or the system's own, or
    anything that :meth:`AnyPlant.telegram_of` turns into a telegram.
    """

    @property
    def kind(self) -> str:
        """What it was."""

    @property
    def instant_01ms(self) -> int:
        """When, in 0.1 ms."""

    @property
    def position_01mm(self) -> int:
        """Where, in 0.1 mm."""


class Ending(Protocol):
    """When a run is over."""

    #: Before this tick no run ends whose controller is there.
    due_tick: int

    def happened(self, kind: str, tick: int) -> None:
        """Something has happened before this tick."""

    def reached(self, tick: int, controller_lost: bool) -> Event | None:
        """The event that ends the run at this tick, None when it goes on."""


class AnyPlant(Protocol):
    """A simulated plant, advanced tick by tick (``scenario.timing.base_tick_ns``), and its telegrams.

    All readings are those of the instant ``tick * base_tick``, before :meth:`advance`.
    """

    tick: int
    #: What makes the telegram of each published port; None of it: nothing is to be sent now.
    makers: Mapping[str, Callable[[], Telegram | None]]

    @property
    def commands(self) -> Mapping[str, type[Telegram]]:
        """Telegram class of each port of the controller that it takes commands from, in the order of the polls."""

    @property
    def statuses(self) -> Sequence[str]:
        """Ports of the controller that are polled for the record alone; once more before the run ends."""

    @property
    def refused(self) -> Mapping[str, int]:
        """What became of the commands that have come, by cause."""

    @property
    def position_01mm(self) -> int:
        """Where it is, for the milestones."""

    @property
    def ending(self) -> Ending:
        """When the run is over."""

    def take(self, telegram: Telegram) -> None:
        """A telegram of one of :attr:`commands` has come at the current tick; the plant judges whether it may act."""

    def advance(self) -> None:
        """Simulate one base tick.

        :raises PlantError: the state is no longer finite.
        """

    def drain_events(self) -> Sequence[Happened]:
        """What has happened since the last call, in order of the instants."""

    def telegram_of(self, event: Happened) -> Telegram | None:
        """The telegram that tells of an event at once; None: it is a milestone of the run (RUN_EVENT)."""

    def is_abandoned(self, command_age_ns: int) -> bool:
        """Whether a plant whose newest command is so old stands because nobody commanded it."""
