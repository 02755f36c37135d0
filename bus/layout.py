"""Packing of telegram classes: a telegram is one dataclass whose fields are the raw integers of its signals.

A class packs by straight-line code, written for the signals of its port: every node packs or unpacks telegrams several
times per tick, and a loop over the signals takes several times as long.

The classes are usually made from the port table (:mod:`railhil.bus.made`); one written by hand is bound to its port by
:meth:`Telegram.bound`.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any, ClassVar, Self

from railhil.common.generated_source import compile_source
from railhil.dbc import Port, Signal


def codec_text(fields: Sequence[tuple[str, Signal]], data_bytes: int) -> str:
    """Functions ``encode`` and ``decode``, see :class:`railhil.bus.layout.Telegram`.

    :param fields: fields of the class with their signals, in order.
    :param data_bytes: length of the port's process data.
    """
    bits = data_bytes * 8
    return _encode_text(fields, bits) + "\n\n" + _decode_text(fields, bits)


def _encode_text(fields: Sequence[tuple[str, Signal]], bits: int) -> str:
    """A value fits if, after shifting into the unsigned range, no bits remain above its signal's length."""
    too_large, shifted = [], []
    for name, entry in fields:
        shift = bits - entry.first_bit - entry.length
        moved = f"raw_{name} + 0x{1 << entry.length - 1:X}" if entry.signed else f"raw_{name}"
        too_large.append(f"{moved} >> {entry.length}")
        value = f"(raw_{name} & 0x{(1 << entry.length) - 1:X})" if entry.signed else f"raw_{name}"
        shifted.append(f"{value} << {shift}" if shift else value)
    lines = [
        "def encode(telegram):",
        *(f"    raw_{name} = telegram.{name}" for name, _ in fields),
        "    if (",
        *_joined("or", too_large),
        "    ):",
        "        raise telegram.misfit()",
        "    word = (",
        *_joined("|", shifted),
        "    )",
        f"    return word.to_bytes({bits // 8})",
    ]
    return "\n".join(lines) + "\n"


def _joined(operator: str, words: Sequence[str]) -> list[str]:
    """An expression, a line for each operand; 0 without one."""
    return [f"        {f'{operator} ' if index else ''}{word}" for index, word in enumerate(words or ["0"])]


def _decode_text(fields: Sequence[tuple[str, Signal]], bits: int) -> str:
    """Two's complement: flip the sign bit, then subtract its weight."""
    lines = ["def decode(kind, data):", "    word = int.from_bytes(data)", "    return kind("]
    for name, entry in fields:
        shift = bits - entry.first_bit - entry.length
        value = f"word{f' >> {shift}' if shift else ''} & 0x{(1 << entry.length) - 1:X}"
        if entry.signed:
            sign = f"0x{1 << entry.length - 1:X}"
            value = f"({value} ^ {sign}) - {sign}"
        lines.append(f"        {value},  # {name}")
    lines.append("    )")
    return "\n".join(lines) + "\n"


#: Code points of a 2-bit check variable.
CHECK_ERRONEOUS, CHECK_CORRECT, CHECK_FORCED, CHECK_UNDEFINED = range(4)
#: Code points of an ANTIVALENT2 flag.
FLAG_ERROR, FLAG_FALSE, FLAG_TRUE, FLAG_UNDEFINED = range(4)


def flag(value: bool) -> int:
    """ANTIVALENT2 code of a truth value."""
    return FLAG_TRUE if value else FLAG_FALSE


def signal(name: str, default: int = 0) -> Any:
    """Declare a telegram field for a signal whose port table names another field, or none.

    :param name: of the signal, with ``{p}`` for the first word of the port's name.
    """
    return dataclasses.field(default=default, metadata={"signal": name})


class Telegram:
    """Base of all telegram classes: ``encode`` to process data, ``decode`` back.

    Subclasses are dataclasses of raw integers, one for each signal of their port, whose name is ``PORT``. Values that
    do not fit a signal are a programming error: ``encode`` raises OverflowError, it never wraps silently.

    Each class gets an ``encode`` and a ``decode`` of its own (:meth:`make_codec`) when one of them is used, or when a
    node expects its telegrams.
    """

    PORT: ClassVar[str]
    #: The port, for a class that is bound to one (:meth:`bound`).
    _port: ClassVar[Port | None] = None
    #: Field names with their signals, filled at first use.
    _signals: ClassVar[tuple[tuple[str, Signal], ...]] = ()

    def __init_subclass__(cls) -> None:
        # The base's own fields do not count: its port may have other signals.
        for name in ("encode", "decode"):
            setattr(cls, name, vars(Telegram)[name])

    @classmethod
    def make_codec(cls) -> None:
        """Give the class its own ``encode`` and ``decode``, made from the signals of its port.

        :raises TypeError: its fields do not match the port table.
        """
        text = codec_text(cls.signals(), cls.port().data_bytes)
        made = compile_source(f"telegram {cls.PORT}", text)
        cls.encode = made["encode"]  # type: ignore[method-assign]
        cls.decode = classmethod(made["decode"])  # type: ignore[assignment, method-assign]

    @classmethod
    def port(cls) -> Port:
        """The port table entry of this telegram.

        :raises TypeError: the class is not bound to a port.
        """
        if cls._port is None:
            raise TypeError(f"{cls.__name__}: found no port, allowed a class bound to one ({cls.__name__}.bound)")
        return cls._port

    @classmethod
    def bound(cls, port: Port, name: str = "") -> type[Self]:
        """This layout bound to a port of one unit among several, or of another system.

        :param name: of the new class.
        :raises TypeError: the fields are not the signals of the port.
        """
        members = {"PORT": port.name, "_port": port, "__slots__": (), "__doc__": cls.__doc__}
        made: type[Self] = type(name or f"{cls.__name__}_{port.name}", (cls,), members)
        made.signals()
        return made

    @classmethod
    def signals(cls) -> tuple[tuple[str, Signal], ...]:
        """Field names with their signals, in the order of the fields.

        :raises TypeError: they do not match the port table.
        """
        if "_signals" not in vars(cls):
            port = cls.port()
            by_name = {item.name: item for item in port.signals}
            by_field = {item.field_name: item.name for item in port.signals}
            prefix = port.name.split("_")[0].capitalize()
            found = []
            for item in dataclasses.fields(cls):  # type: ignore[arg-type]
                declared = item.metadata.get("signal", "").replace("{p}", prefix)
                entry = by_name.pop(declared or by_field.get(item.name, item.name), None)
                if entry is None:
                    strange = declared or item.name
                    raise TypeError(f"port {port.name} lacks signals of {cls.__name__}: {strange}")
                found.append((item.name, entry))
            if by_name:
                raise TypeError(f"{cls.__name__} lacks signals of port {port.name}: {', '.join(by_name)}")
            cls._signals = tuple(found)
        return cls._signals

    def encode(self) -> bytes:
        """Process data of the telegram, ``port.data_bytes`` bytes.

        :raises OverflowError: when a value does not fit its signal.
        """
        self.make_codec()
        return self.encode()

    def misfits(self) -> Iterator[tuple[str, Signal, int]]:
        """Field, signal and raw value of each value that does not fit."""
        for name, entry in self.signals():
            lowest, highest = entry.raw_range
            if not lowest <= (value := getattr(self, name)) <= highest:
                yield name, entry, value

    def misfit(self) -> OverflowError:
        """The error that names the first value that does not fit."""
        name, entry, value = next(self.misfits())
        lowest, highest = entry.raw_range
        return OverflowError(f"{self.PORT}.{name}: found {value}, allowed {lowest}..{highest}")

    def limit(self) -> None:
        """Set each value that does not fit to the nearer end of its signal's range, and the check variables to
        erroneous."""
        for name, entry, value in self.misfits():
            setattr(self, name, min(max(value, entry.raw_range[0]), entry.raw_range[1]))
        for name, entry in self.signals():
            if entry.check == "chk":
                setattr(self, name, CHECK_ERRONEOUS)

    @classmethod
    def decode(cls, data: bytes) -> Self:
        """Telegram of process data of the right length (the traffic store has checked it)."""
        cls.make_codec()
        return cls.decode(data)

    def items(self) -> Iterator[tuple[str, int]]:
        """``(field name, raw value)`` of every field."""
        for name, _ in self.signals():
            yield name, getattr(self, name)
