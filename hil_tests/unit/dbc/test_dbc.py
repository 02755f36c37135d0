"""The wire contract: port table, DBC file and telegram classes agree."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from functools import cache

import cantools
import pytest
from hypothesis import given
from hypothesis import strategies as st

import railhil.bus.ident
import railhil.bus.telegrams
import railhil.wire.ato
from hil_tests.support.candump import candump_line
from hil_tests.support.paths import ROOT
from railhil.bus.layout import Telegram, signal
from railhil.bus.mvb import TelegramSource
from railhil.bus.schedule import bus_load, longest_frame_bits
from railhil.dbc import ContractError, load_contract, wire_contract
from railhil.dbc.text import dbc_text
from railhil.record.trace import Trace

FOLDER = ROOT / "dbc"
#: The class of each port: the last one that names it, since a layout shared by several ports is also a class.
CLASSES = list(
    {
        kind.PORT: kind
        for module in (railhil.bus.telegrams, railhil.wire.ato, railhil.bus.ident)
        for kind in vars(module).values()
        if isinstance(kind, type) and issubclass(kind, Telegram) and "PORT" in vars(kind)
    }.values()
)


@cache
def database() -> cantools.database.Database:
    return cantools.database.load_file(FOLDER / "railhil.dbc")


def telegrams() -> st.SearchStrategy[Telegram]:
    """Random telegrams of every class, over the whole raw range of each signal."""

    def of_class(cls: type[Telegram]) -> st.SearchStrategy[Telegram]:
        ranges = {item.field_name: st.integers(*item.raw_range) for item in cls.port().signals}
        return st.fixed_dictionaries(ranges).map(lambda values: cls(**values))

    return st.one_of([of_class(cls) for cls in CLASSES])


def test_every_port_has_one_telegram_class():
    assert sorted(cls.PORT for cls in CLASSES) == sorted(port.name for port in wire_contract().ports)


def test_dbc_file_is_what_the_port_table_describes():
    contract = load_contract(check_dbc=False)
    assert (FOLDER / "railhil.dbc").read_text(encoding="utf-8") == dbc_text(contract)


def test_a_telegram_class_that_lacks_signals_of_its_port_is_refused():
    @dataclasses.dataclass(slots=True)
    class Short(Telegram):
        speed_01mmps: int = 0
        check: int = signal("SpeedChk")

    with pytest.raises(TypeError, match="lacks signals of port TRN_SPEED: SpeedSpare, SpeedLife"):
        Short.bound(wire_contract().port("TRN_SPEED"))
    with pytest.raises(TypeError, match="Short: found no port"):
        Short().encode()


def test_a_telegram_of_somebody_else_is_packed_alike():
    """Its fields may have the names that the codec uses for other things."""

    @dataclasses.dataclass(slots=True)
    class Layout(Telegram):
        word: int = signal("TrainSpeed")
        kind: int = signal("SpeedChk")
        telegram: int = signal("SpeedSpare")
        data: int = signal("SpeedLife")

    Theirs = Layout.bound(wire_contract().port("TRN_SPEED"))
    telegram = Theirs(-70_000, 1, 2, 3)
    assert telegram.encode() == (-70_000).to_bytes(3, signed=True) + bytes([0b01_10_0011])
    assert Theirs.decode(telegram.encode()) == telegram
    with pytest.raises(OverflowError, match=r"TRN_SPEED\.word: found 8388608"):
        Theirs(1 << 23).encode()


@given(telegrams())
def test_telegram_round_trip(telegram):
    data = telegram.encode()
    assert len(data) == type(telegram).port().data_bytes
    assert type(telegram).decode(data) == telegram


@given(telegrams(), st.booleans())
def test_cantools_decodes_every_frame_and_agrees(telegram, fd):
    """Byte for byte: what our packing writes, cantools alone reads, in classic and in CAN FD form."""
    port = type(telegram).port()
    raw: dict[str, int] = {}
    for frame in TelegramSource(port, fd).frames(telegram.encode()):
        message = database().get_message_by_frame_id(frame.can_id)
        raw |= message.decode(frame.data, decode_choices=False, scaling=False)
    trace = Trace(wire_contract())
    trace.add(port.name, 0, telegram.encode())
    for item in port.signals:
        assert raw[item.name] == trace.raw(port.name, item.name)[0]
    assert raw["FCode"] == port.f_code
    assert raw["Address"] == port.address


def test_value_that_does_not_fit_is_refused():
    with pytest.raises(OverflowError, match=r"TRN_SPEED\.speed_01mmps: found 8388608, allowed -8388608\.\.8388607"):
        railhil.wire.ato.TrnSpeed(1 << 23).encode()


@pytest.mark.parametrize("port", wire_contract().ports, ids=lambda port: port.name)
def test_messages_carry_cycle_time_units_and_comments(port):
    for can_id in (*port.can_ids, port.fd_id):
        message = database().get_message_by_frame_id(can_id)
        assert (message.cycle_time or 0) == port.period_ns // 1_000_000
        assert message.comment
    for item in port.signals:
        names = [port.name, *(f"{port.name}_B{k}" for k in range(1, port.blocks))]
        found = [
            signal
            for name in names
            for signal in database().get_message_by_name(name).signals
            if signal.name == item.name
        ]
        assert len(found) == 1
        assert (found[0].unit or "") == item.unit
        assert found[0].scale == item.scale
        if item.values:
            assert {key: str(text) for key, text in found[0].choices.items()} == dict(item.values)


def test_frame_lengths_of_the_load_formula():
    assert (longest_frame_bits(8), longest_frame_bits(3)) == (135, 85)


def test_bus_load_stays_below_40_percent():
    assert 0.10 < sum(bus_load(wire_contract(), 500_000).values()) < 0.40


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("address = 0x118", "address = 0x119", "TRN_SPEED.address: found 0x119, allowed multiples of 8"),
        (
            'at = "3.3:4", comment = "Life sign" },\n]\n\n[[port]]\nname = "TRN_POS"',
            'at = "3.4:4", comment = "Life sign" },\n]\n\n[[port]]\nname = "TRN_POS"',
            "bits of another signal",
        ),
        ('at = "0.7:24"', 'at = "24"', "TRN_SPEED.TrainSpeed.at: found '24', allowed byte.msb:length"),
        ("f_code = 1\nperiod_ms = 20", "f_code = 7\nperiod_ms = 20", "NOTCH_CMD.f_code: found 7, allowed 0..4"),
        ('at = "4.5:24"', 'at = "6.7:24"', "allowed inside one 64-bit block"),
        ("[[port]]", "[[port", "ports.toml: "),
    ],
)
def test_bad_port_table_is_one_clear_line(tmp_path, old, new, complaint):
    text = (FOLDER / "ports.toml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "ports.toml"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ContractError) as error:
        load_contract(path)
    assert complaint in str(error.value)
    assert "\n" not in str(error.value)


def test_foreign_dbc_beside_the_table_is_refused(tmp_path):
    (tmp_path / "ports.toml").write_bytes((FOLDER / "ports.toml").read_bytes())
    (tmp_path / "railhil.dbc").write_text('VERSION ""\n', encoding="utf-8")
    with pytest.raises(ContractError, match=r"railhil\.dbc: sha256: found .*, allowed "):
        load_contract(tmp_path / "ports.toml")


@pytest.mark.slow
def test_candump_piped_into_cantools_decode():
    """A user without our code: candump text in, signals out."""
    frames = TelegramSource(wire_contract().port("TRN_SPEED")).frames(
        railhil.wire.ato.TrnSpeed(200_000, life=9).encode()
    )
    done = subprocess.run(
        [sys.executable, "-m", "cantools", "decode", str(FOLDER / "railhil.dbc")],
        input=candump_line(frames[0], "vcan0") + "\n",
        capture_output=True,
        text=True,
        check=True,
    )
    assert "TrainSpeed: 20.0 m/s" in done.stdout
    assert "SpeedChk: correct" in done.stdout
