"""The plant's connection with faults: what the plant sends passes them, on every transport."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Sequence

from railhil.bus.frame import Frame
from railhil.bus.injector.changes import number_of
from railhil.bus.injector.flood import Flood
from railhil.bus.injector.node_faults import NodeFaults
from railhil.bus.link import Endpoint


def kill_this_process() -> None:
    """What ``kill`` does to a process of its own."""
    os.kill(os.getpid(), signal.SIGKILL)


class FaultyEndpoint:
    """:class:`railhil.bus.link.Endpoint` of the plant.

    :param bit_rate: of the bus in bit/s.
    :param kill: ends the process at once.
    :param sleep: ``clock.wall pause``.
    """

    def __init__(
        self,
        endpoint: Endpoint,
        faults: NodeFaults,
        bit_rate: int,
        kill: Callable[[], None] = kill_this_process,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._endpoint = endpoint
        self.faults = faults
        self._kills = faults.at("node", "kill")
        self._pauses = faults.at("clock", "pause")
        self._floods = [Flood(one, bit_rate) for one in faults.at("bus", "load")]
        self._kill = kill
        self._sleep = sleep

    @property
    def lossless(self) -> bool:
        """See :class:`railhil.bus.link.Endpoint`."""
        return self._endpoint.lossless

    @lossless.setter
    def lossless(self, value: bool) -> None:
        self._endpoint.lossless = value

    @property
    def is_down(self) -> bool:
        """See :class:`railhil.bus.link.Endpoint`."""
        return self._endpoint.is_down

    def send(self, frames: Sequence[Frame]) -> None:
        """Send what the faults leave of these frames, and what they held back before."""
        faults = self.faults
        leaving: list[Frame] = []
        begun = 0
        for index, frame in enumerate(frames):
            if faults.see(frame):
                # The frame that begins an instant is itself one of it.
                leaving += faults.passes(frames[begun:index])
                begun = index
                leaving += faults.due()
                leaving += self._at_once()
        leaving += faults.passes(frames[begun:])
        if leaving:
            self._endpoint.send(leaving)

    def _at_once(self) -> list[Frame]:
        """What begins with an instant and is not about a telegram."""
        activities = self.faults.activities
        for one in self._kills:
            if one.active:
                activities.note(one, "running", "killed")
                self.faults.write()
                self._kill()
        for one in self._pauses:
            if one.active:
                activities.note(one, "running", "paused")
                one.order(False, activities.now_ns)
                self._sleep(number_of(one.fault, "pause_s"))
        flooded: list[Frame] = []
        for flood in self._floods:
            flooded += flood.frames(activities)
        return flooded

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """See :class:`railhil.bus.link.Endpoint`."""
        frames = self._endpoint.receive(timeout_s)
        for frame in frames:
            self.faults.see(frame)
        return frames

    def has_ended(self, node: str) -> bool:
        """See :class:`railhil.bus.link.Endpoint`."""
        return self._endpoint.has_ended(node)

    def close(self) -> None:
        """See :class:`railhil.bus.link.Endpoint`."""
        self._endpoint.close()
