"""Attacks on a run from its wire: telegrams recorded earlier in the run, or forged, that come again at every poll."""

from __future__ import annotations

from collections.abc import Callable

from railhil.bus.clock import to_time_sync
from railhil.bus.frame import Frame
from railhil.bus.mvb import TelegramSource, master_frame
from railhil.bus.telegrams import TimeSync
from railhil.wire.ato import NotchCmd, TrnSpeed

#: The time to send at a poll of NOTCH_CMD: (the plant's TIME_SYNC so far, number of the poll since the attack began).
Choice = Callable[[list[TimeSync], int], TimeSync]
_NOTCH_POLL = master_frame(NotchCmd.port().f_code, NotchCmd.port().address)
_TICKS_PER_POLL = 2


class TimeAttack:
    """TRN_SPEED is lost from a tick on, and at each poll of NOTCH_CMD comes a TIME_SYNC that somebody else sends."""

    def __init__(self, first_tick: int, choice: Choice) -> None:
        self._first_tick = first_tick
        self._choice = choice
        self._heard: list[TimeSync] = []
        self._polls = 0
        self._source = TelegramSource(TimeSync.port())

    def __call__(self, frame: Frame) -> list[Frame]:
        if frame.can_id == TimeSync.port().address:
            self._heard.append(TimeSync.decode(frame.data))
        attacks = self._polls * _TICKS_PER_POLL >= self._first_tick
        if frame.can_id == TrnSpeed.port().address and attacks:
            return []
        if frame != _NOTCH_POLL:
            return [frame]
        self._polls += 1
        if not attacks:
            return [frame]
        since = self._polls - 1 - self._first_tick // _TICKS_PER_POLL
        return [*self._source.frames(self._choice(self._heard, since).encode()), frame]


def last(heard: list[TimeSync], since: int) -> TimeSync:
    """The newest one again."""
    return heard[-1]


def oldest(heard: list[TimeSync], since: int) -> TimeSync:
    """The first of the run, whose life sign is new again from time to time."""
    return heard[0]


def in_turn(heard: list[TimeSync], since: int) -> TimeSync:
    """All that were recorded, one after another."""
    return heard[since % len(heard)]


def counted_back(heard: list[TimeSync], since: int) -> TimeSync:
    """Forged: always with the next life sign, and each 10 ms earlier than the one before."""
    at = heard[-1]
    tick = max(0, at.seconds_s * 100 - since)
    return to_time_sync(tick, 10_000_000, life=(at.life + 1 + since) % 16)


def far_ahead(heard: list[TimeSync], since: int) -> TimeSync:
    """Forged: the largest time that the telegram holds."""
    return TimeSync(seconds_s=0xFFFF_FFFF, fraction_65536th_s=0xFFFF, life=(heard[-1].life + 1) % 16)


def unchecked(heard: list[TimeSync], since: int) -> TimeSync:
    """The next one, with a check variable that is not correct."""
    at = heard[-1]
    return TimeSync(seconds_s=at.seconds_s, check=0, life=(at.life + 1) % 16)


#: Each attack with the cause that must be counted for it.
TIME_ATTACKS: list[tuple[Choice, str]] = [
    (last, "time_duplicate"),
    (oldest, "time_out_of_order"),
    (in_turn, "time_backward"),
    (counted_back, "time_backward"),
    (far_ahead, "time_ahead"),
    (unchecked, "time_check"),
]
