"""Ports as ROS 2 messages: schema and CDR, read by rules of their own."""

import struct

import numpy as np
import pytest

from railhil.bus.layout import Telegram
from railhil.bus.ros2 import HEADER, Field, Message, PortMessage, ros_name
from railhil.dbc import Port, wire_contract
from railhil.scenarios.system import names, system_named
from railhil.wire.ato import SimTruth, TrnPos, TrnSpeed

_SIZES = {"8": 1, "16": 2, "32": 4, "64": 8}


def _read(schema: str, payload: bytes) -> dict[str, float]:
    """An independent reader: alignment by the size of each field, from after the header."""
    assert payload[:4] == b"\0\1\0\0"
    body, place, found = payload[4:], 0, {}
    for line in schema.splitlines():
        kind, name = line.partition("#")[0].split()
        size = _SIZES[kind.strip("abcdefghijklmnopqrstuvwxyz")]
        place = -(-place // size) * size
        part = body[place : place + size]
        if kind.startswith("float"):
            (found[name],) = struct.unpack({4: "<f", 8: "<d"}[size], part)
        else:
            found[name] = int.from_bytes(part, "little", signed=not kind.startswith("u"))
        place += size
    assert place == len(body)
    return found


def test_payload_is_aligned_little_endian_cdr() -> None:
    kind = Message("Pair", [Field("a", "int8"), Field("b", "float64", "[m]"), Field("c", "uint16")])
    assert kind.packed([-1, 0.5, 7]) == bytes.fromhex("00010000 ff00000000000000 000000000000e03f 0700")
    assert kind.schema == "int8 a\nfloat64 b  # [m]\nuint16 c\n"
    assert kind.name == "railhil/msg/Pair"
    assert kind.size == 22


@pytest.mark.parametrize(
    "telegram",
    [
        TrnSpeed(-123_456, life=9),
        TrnPos(odometer_mm=-5, effort_bipolar2=3, notch_16th=-17),
        SimTruth(position_01mm=-1, speed_01mmps=5, accel_01mmps2=-2),
    ],
    ids=lambda telegram: telegram.PORT,
)
def test_telegram_has_the_physical_values_of_its_signals(telegram: Telegram) -> None:
    kind = PortMessage(telegram.port())
    found = _read(kind.schema, kind.of_telegram(telegram))
    wanted = {
        ros_name(entry.name): getattr(telegram, name) * (1 if entry.scale == 1 else entry.scale)
        for name, entry in telegram.signals()
    }
    assert found == wanted


@pytest.mark.parametrize("system", names())
def test_every_port_of_every_system_has_a_message(system: str) -> None:
    for port in system_named(system).contract.ports:
        kind = PortMessage(port)
        for data in (bytes(port.data_bytes), b"\xff" * port.data_bytes):
            assert list(_read(kind.schema, kind.of_data(data))) == [field.name for field in kind.fields]


def test_array_of_the_columns_is_the_payloads() -> None:
    kind = PortMessage(wire_contract().port("TRN_POS"))
    rows = np.zeros(2, np.dtype(kind.columns).newbyteorder("<"))
    rows[HEADER] = kind.packed([0] * len(kind.fields))[:4]
    values = [1.5, -2.5, 0.25, 1, 2, 3]
    for field, value in zip(kind.fields, values, strict=True):
        rows[field.name][1] = value
    assert rows[0].tobytes() == kind.packed([0] * 6)
    assert rows[1].tobytes() == kind.packed(values)


@pytest.mark.parametrize(
    ("name", "ros"),
    [("TrainSpeed", "train_speed"), ("UNIT1_FB", "unit1_fb"), ("Unit1Force", "unit1_force"), ("ATOState", "ato_state"),
     ("_x", "x"), ("2nd", "s_2nd"), ("a__b", "a_b")],
)  # fmt: skip
def test_names_are_those_that_ros_allows(name: str, ros: str) -> None:
    assert ros_name(name) == ros


def test_equal_names_get_numbers() -> None:
    signals = wire_contract().port("TRN_SPEED").signals
    port = Port("P", 8, 1, 0, "plant", "event", "", (signals[0], signals[0]))
    assert [field.name for field in PortMessage(port).fields] == ["train_speed", "train_speed_2"]


@pytest.mark.parametrize("field", [Field("Speed", "int8"), Field("a__b", "int8"), Field("a", "int24")])
def test_names_and_types_that_ros_does_not_have_are_refused(field: Field) -> None:
    with pytest.raises(ValueError, match=f"found field {field.kind} {field.name}"):
        Message("M", [field])
