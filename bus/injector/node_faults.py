"""The faults of one node: their list, their effect on the telegrams of each port that it sends, and their log."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Final, Protocol

from railhil.bus.frame import Frame
from railhil.bus.injector.activities import Activities, Hit
from railhil.bus.injector.changes import (
    Change,
    ChecksChange,
    CounterChange,
    FrameChange,
    SignalChange,
    TimeChange,
)
from railhil.bus.injector.follower import Follower
from railhil.bus.injector.holding import HOLDING, Holding, Silence
from railhil.bus.injector.telegram_frames import Telegram, is_whole, shown
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import TimeSync
from railhil.dbc import Contract, Port
from railhil.faults.activity import Activity
from railhil.faults.capability import instruments, life_signal, port_names, signal_of
from railhil.faults.model import Fault, Injection
from railhil.faults.words import CLEAR

#: Words of the bus that keep frames from leaving.
SILENT = ("off", "down", "full")
_LEVELS = ("command", "clock", "telegram", "bus")


class _Keeps(Protocol):
    """Loses telegrams or holds them back."""

    @property
    def waits(self) -> bool:
        """Whether telegrams are held back."""

    def take(self, frames: Telegram, now_ns: int) -> tuple[list[Telegram], str]:
        """The telegrams that leave now, and the change to this one."""

    def due(self, now_ns: int) -> list[Telegram]:
        """Telegrams held back that may leave now."""

    def end_process(self) -> None:
        """Forget what a process that has ended would still have sent."""


class PortFaults:
    """The telegrams that leave a source at one port.

    :param polled: whether the telegram is an answer to a poll.
    """

    def __init__(
        self,
        port: Port,
        polled: bool,
        activities: Activities,
        injection: Injection,
        contract: Contract,
    ) -> None:
        self.port = port
        self._activities = activities
        self._changes: list[tuple[Activity, Change]] = []
        self._keeps: list[tuple[Activity, _Keeps]] = []
        self._watched: list[Activity] = []
        self._polled = polled
        self._count = 0
        self._injection = injection
        self._contract = contract

    def take(self, activities: Sequence[Activity], injection: Injection) -> None:
        """Have these faults, in the order of their numbers; those that it has already keep their state.

        Faults of signals come before faults of the telegram, faults of the bus come last.
        """
        self._injection = injection
        self._watched = [*activities]
        changes, keeps = dict(self._changes), dict(self._keeps)
        self._changes, self._keeps = [], []
        for one in activities:
            if one.fault.what == CLEAR:
                continue
            if one.fault.place.level == "bus" or (one.fault.what in HOLDING and not one.fault.place.part):
                self._keeps.append((one, keeps.get(one) or self._keep(one)))
            else:
                self._changes.append((one, changes.get(one) or self._change(one)))
        self._keeps.sort(key=lambda one: one[0].fault.place.level == "bus")
        self._changes.sort(key=lambda one: (_LEVELS.index(one[0].fault.place.level), not one[0].fault.place.part))

    def _keep(self, activity: Activity) -> _Keeps:
        if activity.fault.place.level == "bus":
            return Silence(activity, self._polled)
        return Holding(activity, self._injection.samples(activity.number), self._polled)

    def _change(self, activity: Activity) -> Change:
        fault, port = activity.fault, self.port
        random = self._injection.samples(activity.number)
        if fault.place.level == "clock":
            return TimeChange(activity, port)
        if fault.place.part == "checksum":
            return ChecksChange(activity, port, random)
        if fault.place.part == "counter":
            life = life_signal(port)
            assert life is not None
            return CounterChange(activity, port, life, random)
        name = signal_of(fault, self._injection.named)
        if name:
            signal = next(one for one in port.signals if one.name == name)
            return SignalChange(activity, port, signal, random)
        other = self._contract.port(str(fault.values["port"])) if fault.what == "masquerade" else None
        return FrameChange(activity, random, other)

    def passes(self, frames: Telegram, follower: Follower) -> list[Telegram]:
        """The telegrams that leave in place of the next one of the port."""
        activities = self._activities
        now_ns = activities.now_ns
        self._count += 1
        for one in self._watched:
            if one.fault.trigger.kind == "telegram":
                one.telegram(self._count, now_ns)
                one.look(now_ns, follower.position_m, follower.speed_mps)
        for activity, change in self._changes:
            changed = change(frames, now_ns)
            if changed is not frames and changed != frames:
                self._note(activity, shown(frames), shown(changed))
                frames = changed
        return self._kept([frames], 0)

    def due(self) -> list[Telegram]:
        """Telegrams held back that leave now by themselves; an answer waits for its poll."""
        found: list[Telegram] = []
        if self._polled:
            return found
        for index, (_, keep) in enumerate(self._keeps):
            if keep.waits:
                found += self._kept(keep.due(self._activities.now_ns), index + 1)
        return found

    def end_process(self) -> None:
        """The node is made anew: answers that it has made and not sent are gone."""
        for _, keep in self._keeps:
            keep.end_process()

    def _kept(self, telegrams: list[Telegram], first: int) -> list[Telegram]:
        for activity, keep in self._keeps[first:]:
            passed: list[Telegram] = []
            for frames in telegrams:
                leaving, said = keep.take(frames, self._activities.now_ns)
                if said:
                    self._note(activity, shown(frames), said)
                passed += leaving
            telegrams = passed
        return telegrams

    def _note(self, activity: Activity, before: str, after: str) -> None:
        if activity.active:
            self._activities.note(activity, before, after)
        else:
            # Effects of a fault after its end do not count towards its number.
            hit = Hit(activity.number, self._activities.now_ns, activity.fault.what, before, after)
            self._activities.log.hits.append(hit)


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
        self.node = node
        self._folder = folder
        self._contract = contract
        #: Number of a fault -> its random numbers.
        self.samples = injection.samples
        self.follower = Follower(injection, contract, schedule, at_plant=node == "plant")
        self.activities = Activities(self._own(injection))
        self.ports: dict[str, PortFaults] = {}
        self._by_id: dict[int, PortFaults] = {}
        self._takers: list[Callable[[], None]] = []
        self._take_ports(injection)

    def _own(self, injection: Injection) -> list[tuple[int, Fault]]:
        """The faults of this node, with their numbers."""
        return [
            (number, fault)
            for number, fault in enumerate(injection.faults, start=1)
            if self.node in nodes_of(fault, injection, self._contract)
        ]

    def _take_ports(self, injection: Injection) -> None:
        before, self.ports, self._by_id = self.ports, {}, {}
        found: dict[str, list[Activity]] = {}
        for activity in self.activities.all:
            for port in ports_of(activity.fault, injection, self._contract):
                if port.source == self.node:
                    found.setdefault(port.name, []).append(activity)
        for name, activities in found.items():
            port = self._contract.port(name)
            polled = port.mode == "poll"
            known = before.get(name) or PortFaults(port, polled, self.activities, injection, self._contract)
            known.take(activities, injection)
            self.ports[name] = known
            self._by_id |= dict.fromkeys((*port.can_ids, port.fd_id), known)

    def attach(self, take: Callable[[], None]) -> None:
        """Have a part of the node take its faults from the list, now and whenever the list changes."""
        self._takers.append(take)
        take()

    def adopt(self, injection: Injection, folder: Path | None) -> None:
        """Have other faults from the next instant on (:meth:`Activities.adopt`).

        :param folder: the run folder of the run that has them.
        :raises InputError: a fault has begun that is not in both lists.
        """
        self.activities.adopt(self._own(injection))
        self.samples, self._folder = injection.samples, folder
        self._take_ports(injection)
        for take in self._takers:
            take()

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

    def end_process(self) -> None:
        """The node is made anew: a slow one has not sent all of its answers, and they are gone."""
        for port in self.ports.values():
            port.end_process()

    def write(self) -> None:
        """Write the log."""
        self.activities.write(self._folder, self.node)
