"""The faults of one node: their list, their effect on the telegrams that it sends, and their log."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

from railhil.bus.frame import Frame
from railhil.bus.injector.activities import Activities
from railhil.bus.injector.follower import Follower
from railhil.bus.injector.port_faults import SILENT, PortFaults
from railhil.bus.injector.telegram_frames import is_whole
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import TimeSync
from railhil.dbc import Contract, Port
from railhil.faults.activity import Activity
from railhil.faults.capability import instruments, port_names
from railhil.faults.model import Fault, Injection

#: Words of the bus that act at every node.
_SILENT_OR_OK: Final = (*SILENT, "ok")


def ports_of(fault: Fault, injection: Injection, contract: Contract) -> list[Port]:
    """Ports whose telegrams a fault changes or keeps back."""
    level = fault.place.level
    if level in ("telegram", "command"):
        return [contract.port(name) for name in port_names(fault, contract, injection.units, injection.named)]
    if level == "clock" and fault.place.name == "time":
        return [contract.port(TimeSync.PORT)]
    spared = instruments(injection.truth)
    if level == "bus" and fault.what in _SILENT_OR_OK:
        return [port for port in contract.ports if port.name not in spared]
    if level == "node" and fault.what == "slow":
        return [port for port in contract.ports if port.name not in spared and port.source == fault.place.name]
    return []


def nodes_of(fault: Fault, injection: Injection, contract: Contract) -> set[str]:
    """Nodes whose injectors act for a fault; empty for one inside the plant."""
    if fault.place.level == "node":
        return {fault.place.name}
    if fault.place.level == "clock":
        return {"plant"}
    if fault.place.level == "bus":
        return {"plant", "controller"} if fault.what in _SILENT_OR_OK else {"plant"}
    return {port.source for port in ports_of(fault, injection, contract)}


class NodeFaults:
    """The faults of one node in one run.

    :param node: ``plant`` or ``controller``.
    :param folder: the run folder, for the log; None: no log is written.
    """

    def __init__(
        self,
        injection: Injection,
        contract: Contract,
        schedule: Schedule,
        node: str,
        folder: Path | None = None,
    ) -> None:
        own = [
            (number, fault)
            for number, fault in enumerate(injection.faults, start=1)
            if node in nodes_of(fault, injection, contract)
        ]
        self.node = node
        self._folder = folder
        #: Number of a fault -> its random numbers.
        self.samples = injection.samples
        self.follower = Follower(injection, contract, schedule, at_plant=node == "plant")
        self.activities = Activities(own)
        self.ports: dict[str, PortFaults] = {}
        self._by_id: dict[int, PortFaults] = {}
        for activity in self.activities.all:
            for port in ports_of(activity.fault, injection, contract):
                if port.source == node:
                    self._faults_of(port, injection, contract).add(activity)

    def _faults_of(self, port: Port, injection: Injection, contract: Contract) -> PortFaults:
        if port.name not in self.ports:
            polled = port.mode == "poll"
            self.ports[port.name] = made = PortFaults(port, polled, self.activities, injection, contract)
            self._by_id |= dict.fromkeys((*port.can_ids, port.fd_id), made)
        return self.ports[port.name]

    def at(self, level: str, *words: str) -> list[Activity]:
        """The node's faults of a level with one of these words."""
        return [one for one in self.activities.all if one.fault.place.level == level and one.fault.what in words]

    def see(self, frame: Frame) -> bool:
        """Take a frame that passes in either direction; True if a new instant begins, at which faults begin and end."""
        follower, activities = self.follower, self.activities
        if not follower.see(frame):
            return False
        activities.happened(follower.take_events())
        activities.order(follower.take_orders())
        activities.look(follower.now_ns, follower.position_m, follower.speed_mps)
        return True

    def passes(self, frames: Sequence[Frame]) -> Iterator[Frame]:
        """The frames that leave instead of these. They must be whole telegrams; other frames are not touched."""
        index = 0
        while index < len(frames):
            found = self._by_id.get(frames[index].can_id)
            if found is None:
                yield frames[index]
                index += 1
                continue
            count = 1 if frames[index].can_id == found.port.fd_id else len(found.port.can_ids)
            telegram = list(frames[index : index + count])
            assert is_whole(found.port, telegram), found.port.name
            for leaving in found.passes(telegram, self.follower):
                yield from leaving
            index += count

    def due(self) -> Iterator[Frame]:
        """Frames held back that leave at the beginning of an instant."""
        for port in self.ports.values():
            for telegram in port.due():
                yield from telegram

    def write(self) -> None:
        """Write the log."""
        self.activities.write(self._folder, self.node)
