"""Ports as ROS 2 messages: schema text (``ros2msg``) and payload (CDR), for MCAP files and Foxglove bridges.

One flat message per port, one field per signal. A payload is CDR version 1, little-endian (OMG DDSI-RTPS 2.3, section
10): the four bytes ``00 01 00 00``, then the fields in order, each aligned to its own size counted from after these
four bytes. That is one ``struct.pack``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from struct import Struct
from typing import Any

from railhil.bus.layout import Telegram
from railhil.dbc import Port, Signal

#: Names of the encodings in MCAP and in the Foxglove WebSocket protocol.
SCHEMA_ENCODING, MESSAGE_ENCODING = "ros2msg", "cdr"
#: Topic of the table of signals.
SIGNALS_TOPIC = "/railhil/signals"
#: Package in the names of the message types, ``railhil/msg/TrnSpeed``.
PACKAGE = "railhil"
#: First field of :attr:`Message.columns`.
HEADER = "cdr_header"
_CDR_HEADER = b"\0\1\0\0"
#: Character of :mod:`struct` for each type of a field.
_CODES = {
    "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "int64": "q", "uint64": "Q",
    "float32": "f", "float64": "d",
}  # fmt: skip
#: ROS names: lower case, digits, single underscores, first a letter, the last no underscore.
_NAME = re.compile(r"[a-z](_?[a-z0-9])*")


@dataclass(frozen=True, slots=True)
class Field:
    """One field of a message; ``kind``: a ROS type (``float64``, ``int16``); ``remark``: its comment in the schema."""

    name: str
    kind: str
    remark: str = ""


class Message:
    """A flat message type: its schema, and its packer.

    :param name: last word of the type's name, CamelCase.
    :raises ValueError: the name of a field is not allowed in ROS, or is there twice; unknown type.
    """

    def __init__(self, name: str, fields: Sequence[Field]) -> None:
        self.name = f"{PACKAGE}/msg/{name}"
        self.fields = tuple(fields)
        names = [field.name for field in fields]
        for field in fields:
            if field.kind not in _CODES or not _NAME.fullmatch(field.name) or names.count(field.name) > 1:
                raise ValueError(f"message {name}: found field {field.kind} {field.name}, allowed ROS types and names")
        layout, offsets, place = "<4s", [], 0
        for field in fields:
            size = Struct(f"<{_CODES[field.kind]}").size
            padding = -place % size
            layout += "x" * padding + _CODES[field.kind]
            offsets.append(len(_CDR_HEADER) + place + padding)
            place += padding + size
        #: Bytes between the start of the payload and each field.
        self.offsets = tuple(offsets)
        #: Length of a payload in bytes.
        self.size = len(_CDR_HEADER) + place
        self._pack = Struct(layout).pack
        #: Payload of a message of zeros.
        self.blank = _CDR_HEADER + bytes(place)

    @property
    def schema(self) -> str:
        """Text of the ``ros2msg`` schema, a line per field, with its comment."""
        return "".join(
            f"{field.kind} {field.name}{f'  # {field.remark}' if field.remark else ''}\n" for field in self.fields
        )

    def packed(self, values: Sequence[float]) -> bytes:
        """The payload of one message.

        :param values: one per field, in their order; int for the integer types.
        :raises struct.error: another number of values, or one that does not fit its type.
        """
        return self._pack(_CDR_HEADER, *values)

    @property
    def columns(self) -> dict[str, Any]:
        """The fields, preceded by the four bytes of the header, as the argument of ``numpy.dtype``: an array of that
        type, in little-endian order, is its messages' payloads one after another.

        Bytes of padding are not set by numpy; begin with zeros.
        """
        return {
            "names": [HEADER, *(field.name for field in self.fields)],
            "formats": [f"V{len(_CDR_HEADER)}", *(field.kind for field in self.fields)],
            "offsets": [0, *self.offsets],
            "itemsize": self.size,
        }


class PortMessage(Message):
    """The message of a port: float64 for signals with a scale, the smallest fitting integer for the others.

    Fields have the names of the signals in ROS's manner (``TrainSpeed``: ``train_speed``), the order of the port table,
    and unit, value table and comment as their remark.
    """

    def __init__(self, port: Port) -> None:
        self.port = port
        names = _different([ros_name(signal.name) for signal in port.signals])
        fields = [Field(name, _kind(signal), _remark(signal)) for name, signal in zip(names, port.signals, strict=True)]
        super().__init__("".join(word.capitalize() for word in ros_name(port.name).split("_")), fields)
        self._places = [
            (port.data_bytes * 8 - signal.first_bit - signal.length, (1 << signal.length) - 1, signal)
            for signal in port.signals
        ]

    def of_data(self, data: bytes) -> bytes:
        """The payload of a telegram given as process data (``port.data_bytes`` bytes)."""
        word, values = int.from_bytes(data), []
        for shift, mask, signal in self._places:
            raw = word >> shift & mask
            # Two's complement.
            raw -= (mask + 1) if raw > signal.raw_range[1] else 0
            values.append(raw if signal.scale == 1 else raw * signal.scale)
        return self.packed(values)

    def of_telegram(self, telegram: Telegram) -> bytes:
        """The payload of a telegram of this port."""
        return self.of_data(telegram.encode())


def ros_name(name: str) -> str:
    """A name of the port table as ROS writes it: ``TrainSpeed`` and ``TRAIN_SPEED`` are ``train_speed``."""
    split = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name)
    words = re.sub(r"[^a-z0-9]+", "_", split.lower()).strip("_")
    return words if words[:1].isalpha() else f"s_{words}".rstrip("_")


def _different(names: list[str]) -> list[str]:
    """The names, with numbers added where two are equal."""
    found: list[str] = []
    for name in names:
        serial, free = 1, name
        while free in found:
            serial += 1
            free = f"{name}_{serial}"
        found.append(free)
    return found


def _kind(signal: Signal) -> str:
    """ROS type that holds all values of a signal."""
    if signal.scale != 1:
        return "float64"
    bits = next(size for size in (8, 16, 32, 64) if signal.length <= size)
    return f"{'' if signal.signed else 'u'}int{bits}"


def _remark(signal: Signal) -> str:
    unit = f"[{signal.unit}]" if signal.unit else ""
    values = ", ".join(f"{value} {word}" for value, word in signal.values.items())
    return " ".join(f"{unit} {'; '.join(filter(None, (signal.comment, values)))}".split())
