"""Error frames: reports of a CAN controller about itself and the bus to its own host, as in ``linux/can/error.h``.

The hub's model of CAN controllers makes them; the links read them from the hub as from a real interface.
"""

from __future__ import annotations

from railhil.bus.frame import ERROR, Frame

#: Class bits in the identifier of an error frame.
BUS_OFF = 0x40
RESTARTED = 0x100
_CONTROLLER = 0x04
_PROTOCOL = 0x08
_BUS_ERROR = 0x80
#: The last two data bytes are the error counters (TEC, REC).
_COUNTERS = 0x200
_CLASSES = {
    0x01: "transmit time-out",
    0x02: "arbitration lost",
    _CONTROLLER: "controller problem",
    _PROTOCOL: "protocol violation",
    0x10: "transceiver",
    0x20: "no acknowledgement",
    BUS_OFF: "bus-off",
    _BUS_ERROR: "bus error",
    RESTARTED: "restarted",
}
#: Second data byte of a controller problem.
RECEIVE_WARNING, TRANSMIT_WARNING, RECEIVE_PASSIVE, TRANSMIT_PASSIVE, ACTIVE = 0x04, 0x08, 0x10, 0x20, 0x40
_STATES = {
    0x01: "receive overflow",
    0x02: "transmit overflow",
    RECEIVE_WARNING: "receive warning",
    TRANSMIT_WARNING: "transmit warning",
    RECEIVE_PASSIVE: "receive error-passive",
    TRANSMIT_PASSIVE: "transmit error-passive",
    ACTIVE: "error-active",
}
#: Third data byte of a protocol violation.
_WHILE_SENDING = 0x80


def describe(frame: Frame) -> str:
    """Description of an error frame, e.g. ``controller problem (transmit error-passive)``."""
    words = [text for bit, text in _CLASSES.items() if frame.can_id & bit]
    if frame.can_id & _CONTROLLER and len(frame.data) > 1:
        states = [text for bit, text in _STATES.items() if frame.data[1] & bit]
        if states:
            words.append(f"({', '.join(states)})")
    return " ".join(words) or f"class 0x{frame.can_id:X}"


def is_bus_error(frame: Frame) -> bool:
    """Whether a frame reports that a frame was destroyed on the wire."""
    return bool(frame.flags & ERROR and frame.can_id & _BUS_ERROR)


def counters_of(frame: Frame) -> tuple[int, int]:
    """TEC and REC in an error frame; values above 255 are held as 255."""
    return frame.data[6], frame.data[7]


def bus_error(tec: int, rec: int, *, sending: bool) -> Frame:
    """A frame was destroyed on the wire; ``sending``: it was this controller's own."""
    return _frame(_PROTOCOL | _BUS_ERROR | _COUNTERS, tec, rec, kind=_WHILE_SENDING if sending else 0)


def controller_state(tec: int, rec: int, states: int) -> Frame:
    """The controller's state has changed; ``states``: bits such as :data:`TRANSMIT_PASSIVE`."""
    return _frame(_CONTROLLER | _COUNTERS, tec, rec, states=states)


def bus_off() -> Frame:
    """The controller has left the bus: TEC above 255."""
    return _frame(BUS_OFF, 0, 0)


def restarted() -> Frame:
    """The controller is back on the bus."""
    return _frame(RESTARTED, 0, 0)


def _frame(classes: int, tec: int, rec: int, *, states: int = 0, kind: int = 0) -> Frame:
    return Frame(classes, bytes((0, states, kind, 0, 0, 0, min(tec, 255), min(rec, 255))), ERROR)
