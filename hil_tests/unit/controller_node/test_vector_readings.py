"""Which telegrams update the readings of a law for several units, and the age of the readings."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import pytest

from railhil.bus.clock import to_time_sync
from railhil.bus.layout import CHECK_CORRECT, Telegram, signal
from railhil.bus.mvb import TelegramSource
from railhil.bus.responder import Responder
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.common.errors import InputError
from railhil.controller_node.vector.law import Interface, Reading
from railhil.controller_node.vector.node import Readings
from railhil.dbc import wire_contract
from railhil.wire.ato import TrnPos, TrnSpeed

TICK_NS = 10_000_000
AGE_MAX_MS = 50
WRONG = [value for value in range(4) if value != CHECK_CORRECT]


class Node:
    """A node with readings of the given fields; TRN_SPEED counts the ticks."""

    def __init__(self, *fields: tuple[type[Telegram], str]) -> None:
        sinks = [TrnSpeed.port(), TrnPos.port(), TimeSync.port(), RunEvent.port()]
        self.responder = Responder(
            1, Schedule.from_contract(TICK_NS, {}, wire_contract()), sinks, {}, contract=wire_contract()
        )
        interface = Interface(tuple(Reading(name, kind, name) for kind, name in fields), (), age_max_ms=AGE_MAX_MS)
        self.readings = Readings(interface, self.responder)
        self._life = 0

    def feed(self, telegram: Telegram) -> None:
        for frame in TelegramSource(type(telegram).port()).frames(telegram.encode()):
            self.responder.handle(frame)

    def ticks(self, count: int = 1) -> None:
        """Send speed telegrams with increasing life signs."""
        for _ in range(count):
            self._life = (self._life + 1) % 16
            self.feed(TrnSpeed(0, life=self._life))

    @property
    def seen(self) -> Any:
        """The readings (None if they are not fresh) and the counters."""
        readings = self.readings
        return readings.read_raws() if readings.are_fresh() else None, dict(readings.counters)


def test_a_new_life_sign_counts_and_the_first_ever() -> None:
    node = Node((TrnPos, "odometer_mm"), (TrnPos, "notch_16th"))
    assert node.seen == (None, {})
    node.feed(TrnPos(7, notch_16th=-3, life=12))
    assert node.seen == ([7, -3], {})
    node.feed(TrnPos(8, notch_16th=-2, life=13))
    assert node.seen == ([8, -2], {})
    node.feed(TrnPos(9, life=4))
    assert node.seen == ([9, 0], {"gap": 1})
    node.feed(TrnPos(10, life=4))
    node.feed(TrnPos(11, life=3))
    assert node.seen == ([9, 0], {"gap": 1, "duplicate": 1, "out_of_order": 1})


@pytest.mark.parametrize("field", ["check", "effort_check"])
@pytest.mark.parametrize("value", WRONG)
def test_every_check_variable_of_the_telegram_must_be_correct(field: str, value: int) -> None:
    node = Node((TrnPos, "odometer_mm"))
    node.feed(replace(TrnPos(1, life=1), **{field: value}))
    assert node.seen == (None, {"check_variable": 1})
    node.feed(TrnPos(2, life=2))
    node.feed(replace(TrnPos(3, life=3), **{field: value}))
    assert node.seen == ([2], {"check_variable": 2})
    # An invalid telegram also advances the life sign, as in the guard of ato.
    node.feed(TrnPos(4, life=3))
    assert node.seen == ([2], {"check_variable": 2, "duplicate": 1})


@pytest.mark.parametrize("refused", [TrnPos(5, life=1), TrnPos(5, life=0), replace(TrnPos(5, life=2), check=0), None])
def test_only_a_telegram_that_counts_makes_the_readings_new(refused: TrnPos | None) -> None:
    """The last accepted telegram is that of tick 0."""
    node = Node((TrnSpeed, "speed_01mmps"), (TrnPos, "odometer_mm"))
    node.ticks()
    node.feed(TrnPos(5, life=1))
    for _ in range(AGE_MAX_MS // 10):
        node.ticks()
        if refused is not None:
            node.feed(refused)
        assert node.readings.are_fresh()
    node.ticks()
    assert not node.readings.are_fresh()
    node.feed(TrnPos(6, life=3))
    assert node.seen[0] == [0, 6]


def test_a_telegram_without_life_sign_and_check_variable_counts_whenever_it_comes() -> None:
    node = Node((RunEvent, "event"))
    for _ in range(3):
        node.feed(RunEvent(event=1))
        node.ticks(3)
        assert node.seen == ([1], {})


def test_time_sync_is_a_reading_and_still_sets_the_clock() -> None:
    node = Node((TimeSync, "seconds_s"))
    for life in range(2):
        node.feed(to_time_sync(700, TICK_NS, life=life))
    assert node.responder.clock.tick == 700
    assert node.seen == ([7], {})
    node.ticks(AGE_MAX_MS // 10)
    assert node.readings.are_fresh()
    node.ticks()
    assert not node.readings.are_fresh()


def test_two_classes_of_one_port_are_one_source() -> None:
    again = TrnPos.bound(TrnPos.port())
    node = Node((TrnPos, "odometer_mm"), (again, "notch_16th"))
    node.feed(TrnPos(7, notch_16th=2, life=1))
    node.feed(TrnPos(8, notch_16th=3, life=1))
    assert node.seen == ([7, 2], {"duplicate": 1})


@dataclass(slots=True)
class _Wide(Telegram):
    """TRN_SPEED with its speed in a field named ``life``."""

    life: int = signal("TrainSpeed")
    speed_check: int = signal("SpeedChk")
    spare: int = signal("SpeedSpare")
    speed_life: int = signal("SpeedLife")


def test_a_life_sign_of_another_width_is_refused() -> None:
    with pytest.raises(InputError, match=r"TRN_SPEED.life: -8388608 to 8388607, expected a life sign of 4 bits"):
        Node((_Wide.bound(TrnSpeed.port()), "speed_life"))
