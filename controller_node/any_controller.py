"""The interface of the controller's side of the bus, of any system, as used by its process."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from railhil.bus.codes import Event
from railhil.bus.frame import Frame
from railhil.scenarios.run_spec import LawSpec


class AnyController(Protocol):
    """Handles frames; it has no socket, so it runs in a process of its own or in memory."""

    ended: Event | None

    def handle(self, frame: Frame, /) -> list[Frame]:
        """Take one frame in bus order; returns the answer to a poll of the controller."""

    def was_out(self, wall_ns: int, /) -> None:
        """Note that the interface was down for ``wall_ns`` and now delivers frames again."""

    def was_stopped(self, sim_ns: int, /) -> None:
        """Note that it was stopped for ``sim_ns`` of simulation time and got none of the frames (a fault)."""

    @property
    def lockstep(self) -> bool:
        """True unless the pace is known to follow the wall clock."""

    @property
    def counters(self) -> Mapping[str, int]:
        """Counters of refused and lost frames, by cause."""

    @property
    def lost_messages(self) -> int:
        """Frames overwritten in their mailbox before they were read."""

    @property
    def lost_by_mailbox(self) -> Mapping[str, int]:
        """The same by mailbox."""

    @property
    def law(self) -> LawSpec:
        """Names of law, arithmetic and indexing."""

    @property
    def law_type(self) -> Any:
        """Class of its law, for the declarations in it."""

    @property
    def controller(self) -> Any:
        """The object that computes, with ``counters``, ``cost`` and ``telemetry``; ``kept()``: the law's memory."""
