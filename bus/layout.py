"""Packing of telegram classes: a telegram is one dataclass whose fields are the raw integers of its signals."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator
from operator import attrgetter
from typing import Any, ClassVar, Self

from dbc import Port, wire_contract

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
    """

    PORT: ClassVar[str]
    #: ``(shift, mask, sign bit, lowest, highest)`` of every field, made at first use.
    _plan: ClassVar[tuple[tuple[int, int, int, int, int], ...] | None] = None
    _names: ClassVar[tuple[str, ...]] = ()
    _values: ClassVar[Callable[[Any], tuple[int, ...]]]
    _size: ClassVar[int] = 0

    @classmethod
    def port(cls) -> Port:
        """The port table entry of this telegram."""
        return wire_contract().port(cls.PORT)

    @classmethod
    def _compile(cls) -> tuple[tuple[int, int, int, int, int], ...]:
        """Make the packing plan; checks the class against the port table."""
        port = cls.port()
        by_name = {item.name: item for item in port.signals}
        prefix = port.name.split("_")[0].capitalize()
        plan = []
        for item in dataclasses.fields(cls):  # type: ignore[arg-type]
            entry = by_name.pop(item.metadata["signal"].replace("{p}", prefix))
            shift = port.data_bytes * 8 - entry.first_bit - entry.length
            sign = 1 << (entry.length - 1) if entry.signed else 0
            plan.append((shift, (1 << entry.length) - 1, sign, *entry.raw_range))
        if by_name:
            raise TypeError(f"{cls.__name__} lacks signals of port {port.name}: {', '.join(by_name)}")
        cls._names = tuple(item.name for item in dataclasses.fields(cls))  # type: ignore[arg-type]
        cls._values = attrgetter(*cls._names)
        cls._plan = tuple(plan)
        cls._size = port.data_bytes
        return cls._plan

    def encode(self) -> bytes:
        """Process data of the telegram, ``port.data_bytes`` bytes.

        :raises OverflowError: when a value does not fit its signal.
        """
        plan = self._plan or self._compile()
        word = 0
        for value, (shift, mask, _, lowest, highest) in zip(type(self)._values(self), plan, strict=True):
            if not lowest <= value <= highest:
                raise OverflowError(self._misfit())
            word |= (value & mask) << shift
        return word.to_bytes(self._size)

    def _misfit(self) -> str:
        """Names the first value that does not fit."""
        for (name, value), (_, _, _, lowest, highest) in zip(self.items(), self._plan or (), strict=True):
            if not lowest <= value <= highest:
                return f"{self.PORT}.{name}: found {value}, allowed {lowest}..{highest}"
        raise AssertionError(self.PORT)

    @classmethod
    def decode(cls, data: bytes) -> Self:
        """Telegram of process data of the right length (the traffic store has checked it)."""
        plan = cls._plan or cls._compile()
        word = int.from_bytes(data)
        return cls(*[((word >> shift & mask) ^ sign) - sign for shift, mask, sign, _, _ in plan])

    def items(self) -> Iterator[tuple[str, int]]:
        """``(field name, raw value)`` of every field."""
        if not self._names:
            self._compile()
        for name in self._names:
            yield name, getattr(self, name)
