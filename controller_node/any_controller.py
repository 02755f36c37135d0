"""What the controller's side of the bus is to its process, of whatever system."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from railhil.bus.frame import Frame
from railhil.bus.telegrams import Event
from railhil.scenarios.run_spec import LawSpec


class AnyController(Protocol):
    """Reacts to frames; holds no socket, so it runs in a process or in memory alike."""

    ended: Event | None

    def handle(self, frame: Frame, /) -> list[Frame]:
        """Take one frame in bus order; returns the answer to a poll of the controller."""

    def was_out(self, wall_ns: int, /) -> None:
        """The interface was out for ``wall_ns``, now frames come again."""

    @property
    def lockstep(self) -> bool:
        """True while nothing says that time goes on by the wall clock."""

    @property
    def counters(self) -> Mapping[str, int]:
        """What was refused or lost, by cause."""

    @property
    def lost_messages(self) -> int:
        """Frames overwritten in their mailbox before they were read."""

    @property
    def lost_by_mailbox(self) -> Mapping[str, int]:
        """Those by mailbox."""

    @property
    def law(self) -> LawSpec:
        """Law, arithmetic and indexing by their names."""

    @property
    def law_type(self) -> Any:
        """Class of its law, for what that says of itself."""

    @property
    def controller(self) -> Any:
        """What computes, with ``counters``, ``cost`` and ``telemetry`` of its arithmetic; ``kept()``: its memory."""
