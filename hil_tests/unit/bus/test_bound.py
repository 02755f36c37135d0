"""One telegram class at several ports: a layout bound to each unit of a train."""

from __future__ import annotations

from dataclasses import dataclass, replace

import pytest

from hil_tests.unit.dbc.test_system_contract import TOY
from railhil.bus.layout import CHECK_CORRECT, Telegram, signal
from railhil.bus.mvb import TelegramSource
from railhil.bus.store import TrafficStore
from railhil.dbc import system_contract
from railhil.wire.ato import TrnSpeed

CONTRACT = system_contract(TOY)


@dataclass(slots=True)
class UnitStat(Telegram):
    """Any unit's position."""

    position_01mm: int = signal("{p}Pos")
    check: int = signal("{p}Chk", CHECK_CORRECT)
    life: int = signal("{p}Life")


def test_two_units_share_a_layout_and_keep_apart() -> None:
    first, second = (UnitStat.bound(CONTRACT.port(f"UNIT{unit}_STAT")) for unit in (1, 2))
    store = TrafficStore([first.port(), second.port()])
    for kind, position in ((first, -5), (second, 70_000)):
        for frame in TelegramSource(kind.port(), False).frames(kind(position, life=3).encode()):
            assert store.feed(frame, 0) == kind.PORT
    assert store.read(first, 0)[0] == first(-5, life=3)
    found, _ = store.read(second, 0)
    assert found is not None
    assert (found.position_01mm, found.life, type(found)) == (70_000, 3, second)


def test_a_bound_class_says_its_port_when_a_value_does_not_fit() -> None:
    bound = UnitStat.bound(CONTRACT.port("UNIT2_STAT"))
    with pytest.raises(OverflowError, match=r"^UNIT2_STAT.position_01mm: found 8388608"):
        bound(1 << 23).encode()


def test_a_layout_is_refused_at_a_port_with_other_signals() -> None:
    with pytest.raises(TypeError, match="port UNIT1_CMD lacks signals of UnitStat_UNIT1_CMD"):
        UnitStat.bound(CONTRACT.port("UNIT1_CMD"))


def test_a_class_at_another_port_is_packed_by_the_signals_of_that_port() -> None:
    """TRN_SPEED has been packed before; at another port its signals lie elsewhere."""
    assert TrnSpeed(-3, life=9).encode() == b"\xff\xff\xfd\x49"
    port = TrnSpeed.port()
    place = {"TrainSpeed": 1, "SpeedChk": 0, "SpeedSpare": 0, "SpeedLife": 0}
    signals = tuple(replace(item, byte=place[item.name]) for item in port.signals)
    moved = TrnSpeed.bound(replace(port, name="MOVED", signals=signals))
    data = moved(-3, life=9).encode()
    assert data == b"\x49\xff\xff\xfd"
    assert moved.decode(data) == moved(-3, life=9)
    assert TrnSpeed.decode(b"\xff\xff\xfd\x49") == TrnSpeed(-3, life=9)


def test_a_port_without_signals_is_packed_as_zeros() -> None:
    @dataclass(slots=True)
    class Empty(Telegram):
        PORT = "EMPTY"

    bound = Empty.bound(replace(TrnSpeed.port(), name="EMPTY", signals=()))
    assert bound().encode() == bytes(4)
    assert bound.decode(bytes(4)) == bound()
