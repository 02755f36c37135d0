"""Places, triggers and values of the fault language as text, each read and written here.

Places: ``speed``, ``sensor.speed``, ``NOTCH_CMD``, ``NOTCH_CMD.counter``, ``bus``. Triggers: ``60s``, ``1200m``,
``v>60km/h``, ``braking+2s``, ``#4711``, ``manual``. Values: numbers with a unit, and distributions.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from decimal import Decimal, InvalidOperation

from railhil.common.errors import did_you_mean
from railhil.faults.model import COUNT, LENGTH, NAME, NUMBER, PPM, SHARE, SPEED, TIME, Draw, Place, Trigger, Value
from railhil.faults.words import LINES, PLACES

_KMH = "km/h"
#: Unit of a parameter -> its units in a text, each as a power of ten of the base unit; the first is usual.
UNITS: dict[str, dict[str, int]] = {
    SHARE: {"%": -2, "": 0},
    TIME: {"s": 0, "ms": -3, "us": -6, "": 0},
    LENGTH: {"m": 0, "km": 3, "mm": -3, "": 0},
    SPEED: {"m/s": 0, "": 0},
    NUMBER: {"": 0, "%": -2, "m/s": 0, "m": 0, "x": 0},
    COUNT: {"": 0, "x": 0},
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


ALLOWED = "60s, 1200m, v>60km/h, v<5km/h, #4711, manual, or an event such as braking, +2s behind it for later"
_EVENT = re.compile(r"[a-z][a-z0-9_]*")
#: A planned instant by its name and number, and a time after it.
_MARK = re.compile(r"([A-Za-z][A-Za-z_]*)\s+(\d{1,3})(?:\s*\+\s*|\s+|$)(.*)")


def trigger_of(text: str) -> Trigger | None:
    """The trigger of a text without ``@``; None: it is none."""
    mark = _MARK.fullmatch(text)
    if mark is not None:
        name, number, after = mark.groups()
        delay_s = number_of(after, TIME) if after else 0.0
        if delay_s is None or delay_s < 0:
            return None
        return Trigger("mark", f"{name.lower()} {int(number)}", delay_s=delay_s)
    text = "".join(text.split())
    # A plus may also belong to the number itself (1e+3s).
    head, plus, tail = text.rpartition("+")
    if plus and head and not head.endswith(("e", "E")):
        delay_s = number_of(tail, TIME)
        found = trigger_of(head)
        if found is None or found.delay_s or delay_s is None or delay_s < 0 or found.kind == "manual":
            return None
        return Trigger(found.kind, found.value, found.edge, delay_s)
    if text == "manual":
        return Trigger("manual")
    if text.startswith("#"):
        return (
            Trigger("telegram", float(text[1:]))
            if text[1:].isascii() and text[1:].isdigit() and int(text[1:])
            else None
        )
    if text[:1] == "v":
        edge, speed_mps = text[1:2], number_of(text[2:], SPEED) if len(text) > 2 else None
        if edge in "<>" and edge and speed_mps is not None:
            return Trigger("speed", speed_mps, "rising" if edge == ">" else "falling")
    if text[:1].isdigit() or text[:1] in "+-.":
        time_s = None if text[-1:].isdigit() else number_of(text, TIME)
        if time_s is not None:
            return Trigger("time", time_s) if time_s >= 0 else None
        position_m = None if text[-1:].isdigit() else number_of(text, LENGTH)
        return None if position_m is None else Trigger("position", position_m)
    return Trigger("event", text) if _EVENT.fullmatch(text) else None


def trigger_text(trigger: Trigger) -> str:
    """The text of a trigger without ``@``, read back by :func:`trigger_of`."""
    value = trigger.value
    if isinstance(value, str) or trigger.kind == "manual":
        text = "manual" if trigger.kind == "manual" else str(value)
    elif trigger.kind == "telegram":
        text = f"#{int(value)}"
    elif trigger.kind == "speed":
        text = f"v{'>' if trigger.edge == 'rising' else '<'}{number_text(value, SPEED)}"
    else:
        text = number_text(value, TIME if trigger.kind == "time" else LENGTH)
    return f"{text}+{number_text(trigger.delay_s, TIME)}" if trigger.delay_s else text


_PORT = re.compile(r"[A-Z][A-Z0-9_]*")
_ANY_PORT = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
#: Short name -> its level, for names that only one level has.
_COUNT = Counter(name for names in PLACES.values() for name in names if name)
_SHORT = {name: level for level, names in PLACES.items() for name in names if name and _COUNT[name] == 1}
#: Levels whose places a system may add to.
_OPEN = ("train", "sensor", "actuator", "command")
#: Words that may stand before the name of a port.
_TELEGRAM = ("port", "telegram")


def allowed_places() -> str:
    """All places, for messages."""
    return f"a port (TRN_SPEED, NOTCH_CMD.counter), bus, {', '.join(sorted(_SHORT))}"


def place_of(text: str) -> Place | None:
    """The place of a text; None: it is none."""
    first, _, rest = text.partition(".")
    short = text.replace(".", "_")
    if first in _TELEGRAM:
        name, _, part = rest.partition(".")
        return _telegram(name, part, text)
    if first == "bus":
        return Place("bus", "", rest) if (not rest and "." not in text) or rest in LINES else None
    if first in PLACES and rest:
        if not _ANY_PORT.fullmatch(rest):
            return None
        return Place(first, rest) if rest in PLACES[first] or first in _OPEN else None
    if is_short(short):
        return Place(_SHORT[short], short)
    return _telegram(first, rest, text) if _PORT.fullmatch(first) else None


def is_short(text: str) -> bool:
    """Whether a text is the name of a place that needs no level before it."""
    return text in _SHORT


def _telegram(name: str, part: str, text: str) -> Place | None:
    if not _ANY_PORT.fullmatch(name) or text.endswith(".") or (part and not _ANY_PORT.fullmatch(part)):
        return None
    return Place("telegram", name, part)


def place_text(place: Place) -> str:
    """The shortest text of a place, read back by :func:`place_of`."""
    if place.level == "telegram":
        name = place.name if _PORT.fullmatch(place.name) else f"port.{place.name}"
        return f"{name}.{place.part}" if place.part else name
    if place.level == "bus":
        return f"bus.{place.part}" if place.part else "bus"
    return place.name if _SHORT.get(place.name) == place.level else f"{place.level}.{place.name}"


def place_hint(text: str) -> str | None:
    """The place that was probably meant."""
    known = {*_SHORT, *(f"{level}.{name}" for level, names in PLACES.items() for name in names if name), "bus"}
    return did_you_mean(text, known)
