"""Packing of telegram classes: a telegram is one dataclass whose fields are the raw integers of its signals."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any, ClassVar, Self

from railhil.dbc import Port, Signal, wire_contract

#: Code points of a 2-bit check variable.
CHECK_ERRONEOUS, CHECK_CORRECT, CHECK_FORCED, CHECK_UNDEFINED = range(4)
#: Code points of an ANTIVALENT2 flag.
FLAG_ERROR, FLAG_FALSE, FLAG_TRUE, FLAG_UNDEFINED = range(4)


def flag(value: bool) -> int:
    """ANTIVALENT2 code of a truth value."""
    return FLAG_TRUE if value else FLAG_FALSE


def signal(name: str, default: int = 0) -> Any:
    """Declare a telegram field that is the DBC signal ``name`` (``{p}``: first word of the port's name)."""
    return dataclasses.field(default=default, metadata={"signal": name})


class Telegram:
    """Base of all telegram classes: ``encode`` to process data, ``decode`` back.

    Subclasses are dataclasses of raw integers; their ``PORT`` names the port whose signals they carry. Values that do
    not fit a signal are a programming error: ``encode`` raises OverflowError, it never wraps silently.

    At its first use a class gets an ``encode`` and a ``decode`` of its own, straight-line code made from the port table
    (as ``dataclass`` makes ``__init__``): every node packs or unpacks a telegram several times a tick.
    """

    PORT: ClassVar[str]
    #: Field names with their signals, made at first use.
    _signals: ClassVar[tuple[tuple[str, Signal], ...]] = ()

    @classmethod
    def port(cls) -> Port:
        """The port table entry of this telegram."""
        return wire_contract().port(cls.PORT)

    @classmethod
    def signal_names(cls) -> list[tuple[str, str]]:
        """``(field name, name of its DBC signal)`` of every field."""
        prefix = cls.PORT.split("_")[0].capitalize()
        fields = dataclasses.fields(cls)  # type: ignore[arg-type]
        return [(item.name, item.metadata["signal"].replace("{p}", prefix)) for item in fields]

    @classmethod
    def _compile(cls) -> None:
        """Give the class its own ``encode`` and ``decode``; checks it against the port table."""
        port = cls.port()
        by_name = {item.name: item for item in port.signals}
        prefix = port.name.split("_")[0].capitalize()
        signals = []
        for item in dataclasses.fields(cls):  # type: ignore[arg-type]
            signals.append((item.name, by_name.pop(item.metadata["signal"].replace("{p}", prefix))))
        if by_name:
            raise TypeError(f"{cls.__name__} lacks signals of port {port.name}: {', '.join(by_name)}")
        cls._signals = tuple(signals)
        made: dict[str, Any] = {}
        exec(_codec_text(cls._signals, port.data_bytes), {}, made)
        cls.encode = made["encode"]  # type: ignore[method-assign]
        cls.decode = classmethod(made["decode"])  # type: ignore[assignment, method-assign]

    def encode(self) -> bytes:
        """Process data of the telegram, ``port.data_bytes`` bytes.

        :raises OverflowError: when a value does not fit its signal.
        """
        self._compile()
        return self.encode()

    def _misfit(self) -> OverflowError:
        """Names the first value that does not fit."""
        for name, entry in self._signals:
            value, (lowest, highest) = getattr(self, name), entry.raw_range
            if not lowest <= value <= highest:
                return OverflowError(f"{self.PORT}.{name}: found {value}, allowed {lowest}..{highest}")
        raise AssertionError(self.PORT)

    @classmethod
    def decode(cls, data: bytes) -> Self:
        """Telegram of process data of the right length (the traffic store has checked it)."""
        cls._compile()
        return cls.decode(data)

    def items(self) -> Iterator[tuple[str, int]]:
        """``(field name, raw value)`` of every field."""
        if not self._signals:
            self._compile()
        for name, _ in self._signals:
            yield name, getattr(self, name)


def _codec_text(signals: Sequence[tuple[str, Signal]], data_bytes: int) -> str:
    """Python text of ``encode`` and ``decode`` of a telegram with these fields.

    A value fits when nothing is left of it, moved into the unsigned range, above its signal's length.
    """
    loads, misfits, packed, unpacked = [], [], [], []
    for index, (name, entry) in enumerate(signals):
        value, mask, shift = f"v{index}", (1 << entry.length) - 1, data_bytes * 8 - entry.first_bit - entry.length
        bits = f"word >> {shift} & {mask}"
        loads.append(f"    {value} = self.{name}\n")
        if entry.signed:
            sign = 1 << entry.length - 1
            misfits.append(f"{value} + {sign} >> {entry.length}")
            packed.append(f"({value} & {mask}) << {shift}")
            # Two's complement: the sign bit turned, and its weight taken away again.
            unpacked.append(f"({bits} ^ {sign}) - {sign}")
        else:
            misfits.append(f"{value} >> {entry.length}")
            packed.append(f"{value} << {shift}")
            unpacked.append(bits)
    return (
        "def encode(self):\n"
        + "".join(loads)
        + f"    if {' | '.join(misfits)}:\n        raise self._misfit()\n"
        + f"    return ({' | '.join(packed)}).to_bytes({data_bytes})\n"
        + "def decode(cls, data):\n    word = int.from_bytes(data)\n"
        + f"    return cls({', '.join(unpacked)})\n"
    )
