"""Buses that lose, damage, double, delay and swap frames."""

from __future__ import annotations

import random
from collections.abc import Container, Mapping

from railhil.bus.frame import EXTENDED, REMOTE, Frame
from railhil.bus.mvb import TelegramSource, check_sequence
from railhil.dbc import wire_contract
from railhil.wire.ato import SpeedSdt, TrnSpeed

_POLL = wire_contract().poll_id


class Faulty:
    """A bus that loses, damages, doubles, delays and swaps frames, each with a probability, from a seed.

    Polls are never lost: the bus administrator would wait for each.
    """

    def __init__(self, seed: int, often: float, silent: Mapping[int, Container[int]] | None = None) -> None:
        self._random = random.Random(seed)
        self._often = often
        self._silent = silent or {}
        self._late: list[tuple[int, Frame]] = []
        self._count = 0
        self.polls = 0
        #: So often each fault happened.
        self.happened: dict[str, int] = {}

    def __call__(self, frame: Frame) -> list[Frame]:
        self._count += 1
        self.polls += frame.can_id == _POLL
        due = [late for at, late in self._late if at <= self._count]
        self._late = [item for item in self._late if item[0] > self._count]
        if self.polls in self._silent.get(frame.can_id, ()):
            return due
        if self._random.random() >= self._often:
            return [*due, frame]
        kinds = ("damaged", "checked", "doubled", "masqueraded", "remote", "extended", "cut", "lost", "kept")
        kind = self._random.choice(kinds)
        self.happened[kind] = self.happened.get(kind, 0) + 1
        return [*due, *(self._poll(frame) if frame.can_id == _POLL else getattr(self, f"_{kind}")(frame))]

    def _poll(self, frame: Frame) -> list[Frame]:
        """A poll comes in any case; before it something like it."""
        return [*self._damaged(frame), *self._cut(frame), frame]

    def _damaged(self, frame: Frame) -> list[Frame]:
        bits = int.from_bytes(frame.data)
        for _ in range(self._random.randint(1, 3)):
            bits ^= 1 << self._random.randrange(8 * len(frame.data))
        return [frame._replace(data=bits.to_bytes(len(frame.data)))]

    def _checked(self, frame: Frame) -> list[Frame]:
        """Any content, with the right check sequence: stands for a source that is wrong itself."""
        if frame.can_id != TrnSpeed.port().address:
            return self._damaged(frame)
        data = self._random.choice([b"\x7f\xff\xff\x40", b"\x00\x00\x00\x80", b"\xff\xff\xff\x45", b"\x01\x00\x00\x07"])
        data = data[:3] + bytes([data[3] & 0xF0 | frame.data[3] & 0xF])
        return [frame._replace(data=data + bytes([check_sequence(data)]) + frame.data[5:])]

    def _doubled(self, frame: Frame) -> list[Frame]:
        return [frame, frame]

    def _masqueraded(self, frame: Frame) -> list[Frame]:
        other = self._random.choice([port for port in wire_contract().ports if port.source == "plant"])
        return [frame._replace(can_id=self._random.choice(other.can_ids))]

    def _remote(self, frame: Frame) -> list[Frame]:
        return [frame._replace(flags=REMOTE), frame]

    def _extended(self, frame: Frame) -> list[Frame]:
        return [frame._replace(flags=EXTENDED)]

    def _cut(self, frame: Frame) -> list[Frame]:
        return [frame._replace(data=frame.data[: self._random.randrange(len(frame.data))])]

    def _lost(self, frame: Frame) -> list[Frame]:
        return []

    def _kept(self, frame: Frame) -> list[Frame]:
        self._late.append((self._count + self._random.randint(1, 60), frame))
        return []


class SafeFaulty:
    """Damages, loses, repeats and delays frames of SPEED_SDT, and now and then TRN_SPEED.

    :param often: probability per frame.
    """

    def __init__(self, seed: int, often: float) -> None:
        self._random = random.Random(seed)
        self._often = often
        self._ids = {can_id for cls in (SpeedSdt, TrnSpeed) for can_id in cls.port().can_ids}
        self._old: list[list[Frame]] = []
        self._source = TelegramSource(SpeedSdt.port())

    def __call__(self, frame: Frame) -> list[Frame]:
        if frame.can_id not in self._ids:
            return [frame]
        kind = self._random.random() / self._often
        if frame.can_id == TrnSpeed.port().address:
            return [] if kind < 0.2 else [frame]
        if frame.can_id != SpeedSdt.port().can_ids[-1]:
            self._old.append([*self._old.pop(), frame] if self._old and len(self._old[-1]) == 1 else [frame])
            return []
        data = bytearray(b"".join(item.data for item in self._old[-1]))
        if kind < 0.3:
            data[self._random.randrange(16)] ^= 1 << self._random.randrange(8)
        elif kind < 0.5:
            return []
        elif kind < 0.8:
            # Up to two turns of the sequence counter old.
            data = bytearray(b"".join(item.data for item in self._random.choice(self._old[-512:])))
        elif kind < 0.9:
            return self._source.frames(bytes(data)) * 2
        return self._source.frames(bytes(data))
