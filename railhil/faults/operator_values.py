"""Values of a fault that an operator changes during a run, as octets in SUP_CMD.

SUP_CMD has room for one octet: the orders :attr:`railhil.bus.codes.FaultOrder.VALUE` carry them one after the other,
and the next ``INJECT`` names the prepared fault that they belong to::

    which parameters (bit n: the n-th of the word) | 4 octets of each, float32, high octet first | check octet

The check octet is the low octet of the CRC-32 of the fault's number and the octets before it, so a part lost on the bus
cannot make another fault. Without octets the fault has the values with which it was prepared.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

from railhil.faults.model import NAME, Fault, Parameter, Value
from railhil.faults.notation import LARGEST
from railhil.faults.words import word_of

#: Largest number of decimal digits of a float32.
_DIGITS_MAX = 9


def parameters_of(fault: Fault) -> Sequence[Parameter]:
    """The parameters of a fault's word, in its order."""
    place = fault.place
    word = word_of(place.level, place.name, place.part, fault.what)
    assert word is not None
    return word.parameters


def is_kind(prepared: Fault, wanted: Fault) -> bool:
    """Whether a prepared fault differs from the wanted one only in numbers."""
    kinds = [(one.place, one.what, one.count, one.after, one.units) for one in (prepared, wanted)]
    names = (one.name for one in parameters_of(prepared) if one.unit == NAME)
    return kinds[0] == kinds[1] and all(prepared.values[name] == wanted.values[name] for name in names)


def octets_of(number: int, prepared: Fault, wanted: Fault) -> bytes:
    """An operator's values as octets for the bus; empty if they equal the prepared ones.

    :param number: of the fault in the run's list.
    :param wanted: a fault of the same kind (:func:`is_kind`) whose values are numbers.
    """
    which, body = 0, b""
    for place, one in enumerate(parameters_of(prepared)):
        value = wanted.values[one.name]
        if value != prepared.values[one.name] and isinstance(value, int | float):
            which |= 1 << place
            body += struct.pack(">f", value)
    message = bytes((which,)) + body
    return message + _check(number, message) if which else b""


def with_octets(number: int, prepared: Fault, octets: bytes) -> Fault | None:
    """The prepared fault with the values of these octets; None: they are not whole, or for another fault."""
    message, check = octets[:-1], octets[-1:]
    parameters = parameters_of(prepared)
    if not message or message[0] >> len(parameters) or check != _check(number, message):
        return None
    places = [place for place in range(len(parameters)) if message[0] >> place & 1]
    if len(message) != 1 + 4 * len(places):
        return None
    values: dict[str, Value] = dict(prepared.values)
    for place, value in zip(places, struct.unpack(f">{len(places)}f", message[1:]), strict=True):
        if not abs(value) <= LARGEST:
            return None
        values[parameters[place].name] = _shortest(value)
    return replace(prepared, values=MappingProxyType(values))


def _check(number: int, message: bytes) -> bytes:
    return bytes((zlib.crc32(bytes((number,)) + message) & 0xFF,))


def _shortest(value: float) -> float:
    """The shortest decimal number with the same float32: 12 % is 0.12, not 0.119999997."""
    octets = struct.pack(">f", value)
    return next(
        one
        for one in (float(f"{value:.{digits}g}") for digits in range(1, _DIGITS_MAX + 1))
        if struct.pack(">f", one) == octets
    )
