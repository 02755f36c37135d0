"""All faults of one port at its source: signals first, then the telegram, then the bus."""

from __future__ import annotations

from typing import Protocol

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
from railhil.bus.injector.telegram_frames import Telegram, shown
from railhil.dbc import Contract, Port
from railhil.faults.activity import Activity
from railhil.faults.capability import life_signal, signal_of
from railhil.faults.model import Injection
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

    def add(self, activity: Activity) -> None:
        """Add a fault. Faults of signals come before faults of the telegram, faults of the bus come last."""
        fault = activity.fault
        self._watched.append(activity)
        if fault.what == CLEAR:
            return
        random = self._injection.samples(activity.number)
        level = fault.place.level
        if level == "bus":
            self._keeps.append((activity, Silence(activity, self._polled)))
        elif fault.what in HOLDING and not fault.place.part:
            self._keeps.append((activity, Holding(activity, random, self._polled)))
            self._keeps.sort(key=lambda one: one[0].fault.place.level == "bus")
        else:
            self._changes.append((activity, self._change(activity)))
            self._changes.sort(key=lambda one: (_LEVELS.index(one[0].fault.place.level), not one[0].fault.place.part))

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
