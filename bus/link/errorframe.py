"""Error frames of a real CAN interface: what the CAN controller reports about the bus, as in ``linux/can/error.h``."""

from __future__ import annotations

from railhil.bus.frame import Frame

#: Class bits in the identifier of an error frame.
BUS_OFF = 0x40
RESTARTED = 0x100
_CONTROLLER = 0x04
_CLASSES = {
    0x01: "transmit time-out",
    0x02: "arbitration lost",
    _CONTROLLER: "controller problem",
    0x08: "protocol violation",
    0x10: "transceiver",
    0x20: "no acknowledgement",
    BUS_OFF: "bus-off",
    0x80: "bus error",
    RESTARTED: "restarted",
}
#: Second data byte of a controller problem.
_STATES = {
    0x01: "receive overflow",
    0x02: "transmit overflow",
    0x04: "receive warning",
    0x08: "transmit warning",
    0x10: "receive error-passive",
    0x20: "transmit error-passive",
    0x40: "error-active",
}


def describe(frame: Frame) -> str:
    """Description of an error frame, e.g. ``controller problem (transmit error-passive)``."""
    words = [text for bit, text in _CLASSES.items() if frame.can_id & bit]
    if frame.can_id & _CONTROLLER and len(frame.data) > 1:
        states = [text for bit, text in _STATES.items() if frame.data[1] & bit]
        if states:
            words.append(f"({', '.join(states)})")
    return " ".join(words) or f"class 0x{frame.can_id:X}"
