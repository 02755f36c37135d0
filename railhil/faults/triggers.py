"""Triggers of the fault language as text: ``60s``, ``1200m``, ``v>60km/h``, ``braking+2s``, ``#4711``, ``manual``."""

from __future__ import annotations

import re

from railhil.faults.model import Trigger
from railhil.faults.quantities import number_of, number_text
from railhil.faults.words import LENGTH, SPEED, TIME

ALLOWED = "60s, 1200m, v>60km/h, v<5km/h, #4711, manual, or an event such as braking, +2s behind it for later"
_EVENT = re.compile(r"[a-z][a-z0-9_]*")


def trigger_of(text: str) -> Trigger | None:
    """The trigger of a text without ``@``; None: it is none."""
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
