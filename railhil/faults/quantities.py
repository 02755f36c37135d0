"""Values of the fault language as text: numbers with a unit, and distributions."""

from __future__ import annotations

import math
import re
from decimal import Decimal, InvalidOperation

from railhil.faults.model import Draw, Value
from railhil.faults.words import COUNT, LENGTH, NAME, NUMBER, PPM, SHARE, SPEED, TIME

_KMH = "km/h"
#: Unit of a parameter -> its units in a text, each as a power of ten of the base unit; the first is usual.
UNITS: dict[str, dict[str, int]] = {
    SHARE: {"%": -2, "": 0},
    TIME: {"s": 0, "ms": -3, "us": -6, "": 0},
    LENGTH: {"m": 0, "km": 3, "mm": -3, "": 0},
    SPEED: {"m/s": 0, "": 0},
    NUMBER: {"": 0, "%": -2, "m/s": 0, "m": 0},
    COUNT: {"": 0},
    PPM: {"ppm": 0, "": 0},
}
_EXAMPLE = {
    SHARE: "30%",
    TIME: "500ms",
    LENGTH: "1200m",
    SPEED: "60km/h",
    NUMBER: "1.05",
    COUNT: "3",
    PPM: "100ppm",
    NAME: "a name",
}
_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(.*)")
_DRAW = re.compile(r"(uniform|normal)\(([^,()]*),([^,()]*)\)")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
#: Largest number of a text.
LARGEST = 1e15


def allowed_text(unit: str) -> str:
    """An example of a value of this unit, for messages."""
    return _EXAMPLE[unit]


def number_of(text: str, unit: str) -> float | None:
    """The number of a text with a unit, in the base unit; None: it is none."""
    match = _NUMBER.fullmatch(text.strip())
    if match is None:
        return None
    digits, ending = match.group(1), match.group(2).strip()
    try:
        if unit in (SPEED, NUMBER) and ending == _KMH:
            value = float(digits) / 3.6
        elif ending in UNITS[unit]:
            value = float(Decimal(digits).scaleb(UNITS[unit][ending]))
        else:
            return None
    except (InvalidOperation, OverflowError):
        return None
    if not math.isfinite(value) or abs(value) > LARGEST or (unit == COUNT and value != int(value)):
        return None
    # Minus zero is a zero.
    return value + 0.0


def number_text(value: float, unit: str) -> str:
    """The shortest usual text of a number: :func:`number_of` reads it back to the last bit."""
    if unit == SPEED:
        kmh = f"{value * 3.6:.12g}"
        return f"{kmh}km/h" if float(kmh) / 3.6 == value else f"{_plain(Decimal(repr(value)))}m/s"
    exact = Decimal(repr(float(value)))
    if unit == SHARE:
        return f"{_plain(exact.scaleb(2))}%"
    if unit == TIME and 0 < abs(value) < 1:
        return f"{_plain(exact.scaleb(3))}ms"
    base = next(iter(UNITS[unit]))
    return f"{_plain(exact)}{base}"


def _plain(value: Decimal) -> str:
    text = f"{value:f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def value_of(text: str, unit: str) -> Value | None:
    """Number, name or distribution of a text; None: it is none."""
    if unit == NAME:
        return text if _NAME.fullmatch(text) else None
    match = _DRAW.fullmatch(text.replace(" ", ""))
    if match is None:
        return number_of(text, unit)
    bounds = [number_of(bound, unit) for bound in match.groups()[1:]]
    if None in bounds:
        return None
    first, second = (float(bound) for bound in bounds if bound is not None)
    kind = "uniform" if match.group(1) == "uniform" else "normal"
    if (kind == "uniform" and first > second) or (kind == "normal" and second < 0):
        return None
    return Draw("uniform" if kind == "uniform" else "normal", first, second)


def value_text(value: Value, unit: str) -> str:
    """The text of a value, read back by :func:`value_of`."""
    if isinstance(value, Draw):
        return f"{value.kind}({number_text(value.a, unit)},{number_text(value.b, unit)})"
    return value if isinstance(value, str) else number_text(value, unit)
