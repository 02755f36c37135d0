"""Places of the fault language as text: ``speed``, ``sensor.speed``, ``NOTCH_CMD``, ``NOTCH_CMD.counter``, ``bus``."""

from __future__ import annotations

import re
from collections import Counter

from railhil.common.errors import did_you_mean
from railhil.faults.model import Place
from railhil.faults.words import LINES, PLACES

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
    if first in _TELEGRAM:
        name, _, part = rest.partition(".")
        return _telegram(name, part, text)
    if first == "bus":
        return Place("bus", "", rest) if (not rest and "." not in text) or rest in LINES else None
    if first in PLACES and rest:
        if not _ANY_PORT.fullmatch(rest):
            return None
        return Place(first, rest) if rest in PLACES[first] or first in _OPEN else None
    if first in _SHORT and "." not in text:
        return Place(_SHORT[first], first)
    return _telegram(first, rest, text) if _PORT.fullmatch(first) else None


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
