"""The plant's connection with faults: all frames that the plant sends pass them, on every transport."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from railhil.bus.frame import Frame
from railhil.bus.hub.disturbances import Disturber
from railhil.bus.injector.bus_faults import BusFaults, Flood
from railhil.bus.injector.node_faults import NodeFaults
from railhil.bus.link.base import Endpoint, PackedEnd
from railhil.bus.packing import pack_frames
from railhil.common.python_process import kill_this_process, stop_this_process
from railhil.dbc import Contract
from railhil.faults.activity import Activity


class FaultyEndpoint:
    """:class:`railhil.bus.link.Endpoint` of the plant.

    :param disturber: takes the orders of faults of the bus; None: there are none, or they are not acted out (a replay).
    :param packed: the link for packed frames, which can send them early; None: it has none.
    :param kill: ends the process at once.
    :param stop: stops the process for a time on the wall clock in s; ``sleep``: ``clock.wall pause``.
    """

    def __init__(
        self,
        endpoint: Endpoint,
        faults: NodeFaults,
        contract: Contract,
        disturber: Disturber | None = None,
        packed: PackedEnd | None = None,
        *,
        kill: Callable[[], None] = kill_this_process,
        stop: Callable[[float], None] = stop_this_process,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._endpoint = endpoint
        self.faults = faults
        self._bit_rate = contract.bit_rate
        self._floods: dict[Activity, Flood] = {}
        faults.attach(self._take)
        self._bus = None if disturber is None else BusFaults.of(faults, disturber, contract)
        #: Sends the frames that the faults leave early; the rest is sent with the next frames. None: it cannot.
        self.send_early = None if packed is None or disturber is not None else self._send_early
        self._packed = packed
        # Frames that the faults have left and that were not sent early.
        self._left: list[Frame] = []
        self._kill = kill
        self._stop = stop
        self._sleep = sleep

    def _take(self) -> None:
        """Take the node's faults that are not about a telegram."""
        faults, before = self.faults, self._floods
        self._kills = faults.at("node", "kill")
        self._stops = faults.at("node", "stop")
        self._pauses = faults.at("clock", "pause")
        self._floods = {one: before.get(one) or Flood(one, self._bit_rate) for one in faults.at("bus", "load")}

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

    @property
    def is_private(self) -> bool:
        """See :class:`railhil.bus.link.Endpoint`."""
        return self._endpoint.is_private

    def send(self, frames: Sequence[Frame]) -> None:
        """Send the frames that the faults leave of these, and frames held back before."""
        leaving = self._left + self._passed(frames)
        self._left = []
        if leaving:
            if self._bus is not None:
                self._bus.sending(leaving)
            self._endpoint.send(leaving)

    def _send_early(self, frames: Sequence[Frame]) -> bool:
        leaving = self._left + self._passed(frames)
        self._left = []
        if leaving and self._packed is not None and not self._packed.send_early(b"".join(pack_frames(leaving))):
            self._left = leaving
        return True

    def _passed(self, frames: Sequence[Frame]) -> list[Frame]:
        """The frames that the faults leave of whole telegrams, and frames held back before."""
        faults = self.faults
        leaving: list[Frame] = []
        begun = 0
        opening = faults.follower.clock_ids
        for index, frame in enumerate(frames):
            if frame.can_id in opening:
                # This frame begins an instant, and the frames before it belong to the last one.
                leaving += faults.passes(frames[begun:index])
                begun = index
            if faults.see(frame):
                leaving += faults.due()
                leaving += self._at_once()
        leaving += faults.passes(frames[begun:])
        return leaving

    def _at_once(self) -> list[Frame]:
        """Begin the faults of an instant that are not about a telegram."""
        activities = self.faults.activities
        for one in self._kills:
            if one.active:
                activities.note(one, "running", "killed")
                self.faults.write()
                if self._packed is not None:
                    # The link holds back frames that the record does not have yet.
                    self._endpoint.send([])
                self._kill()
        for one in self._stops:
            if one.active and one.fault.duration_s is not None:
                activities.note(one, "running", "stopped")
                one.order(False, activities.now_ns)
                self._stop(self.faults.follower.wall_s(one.fault.duration_s))
        for one in self._pauses:
            if one.active:
                activities.note(one, "running", "paused")
                one.order(False, activities.now_ns)
                self._sleep(one.fault.parameter("pause_s"))
        if self._bus is not None:
            self._bus.instant()
        flooded: list[Frame] = []
        for flood in self._floods.values():
            flooded += flood.frames(activities)
        return flooded

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """See :class:`railhil.bus.link.Endpoint`."""
        frames = self._endpoint.receive(timeout_s)
        if self._bus is not None:
            self._bus.heard(frames)
        for frame in frames:
            self.faults.see(frame)
        return frames

    def has_ended(self, node: str) -> bool:
        """See :class:`railhil.bus.link.Endpoint`."""
        return self._endpoint.has_ended(node)

    def is_cut_off(self, node: str) -> bool:
        """See :class:`railhil.bus.link.Endpoint`."""
        return self._endpoint.is_cut_off(node)

    def close(self) -> None:
        """See :class:`railhil.bus.link.Endpoint`."""
        self._endpoint.close()
