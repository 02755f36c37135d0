"""What a run shows besides the levels of its watches: milestones, interlocks, and states on the wire.

Written in a catalogue as ``milestone:NAME``, ``interlock:NAME`` and ``PORT.Signal=VALUE``, where a value is one of the
words of the wire contract, ``true`` or ``false`` of an antivalent signal, or a number.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from railhil.bus.layout import FLAG_FALSE, FLAG_TRUE
from railhil.judge.events.event import INTERLOCK, MILESTONE, RecordedEvent
from railhil.record.trace import Trace

STATE = re.compile(r"([A-Z][A-Z0-9_]*)\.([A-Za-z][A-Za-z0-9]*)=([a-z0-9_]+)")
EVENT = re.compile(r"(milestone|interlock):([A-Za-z0-9_]+)")
_KINDS = {"milestone": MILESTONE, "interlock": INTERLOCK}
_FLAGS = {"true": FLAG_TRUE, "false": FLAG_FALSE}


def is_sign(text: str) -> bool:
    """Whether a text names a milestone, an interlock or a state."""
    return bool(STATE.fullmatch(text) or EVENT.fullmatch(text))


def find_states(trace: Trace, signs: Iterable[str]) -> dict[str, Sequence[float]]:
    """The instants of the telegrams with each of these states, s; of a port or signal that is not on the bus, none."""
    found: dict[str, Sequence[float]] = {}
    for sign in signs:
        match = STATE.fullmatch(sign)
        if match is None:
            continue
        port, signal, value = match.groups()
        found[sign] = ()
        if trace.has(port, signal):
            rows = trace.raw(port, signal) == _raw(trace, port, signal, value)
            found[sign] = trace.times_s(port)[np.flatnonzero(rows)].tolist()
    return found


def _raw(trace: Trace, port: str, signal: str, value: str) -> int:
    """The raw number of a value; -1: the signal has none of this name."""
    if value.isdigit():
        return int(value)
    if value in _FLAGS:
        return _FLAGS[value]
    entry = next(one for one in trace.contract.port(port).signals if one.name == signal)
    return next((raw for raw, word in entry.values.items() if word == value), -1)


def first_s(
    sign: str, events: Sequence[RecordedEvent], states: Mapping[str, Sequence[float]], from_s: float
) -> float | None:
    """When a run first shows a sign, from an instant on, s; None: it does not."""
    match = EVENT.fullmatch(sign)
    if match is None:
        return next((time_s for time_s in states.get(sign, ()) if time_s >= from_s), None)
    kind, name = _KINDS[match.group(1)], match.group(2)
    times_s = (
        max(event.time_s, from_s)
        for event in events
        if event.kind == kind and event.cause == name and (event.until_s or event.time_s) >= from_s
    )
    return min(times_s, default=None)
