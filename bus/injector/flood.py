"""Foreign frames that load the bus (``bus load 60%``)."""

from __future__ import annotations

from railhil.bus.frame import Frame
from railhil.bus.injector.activities import Activities
from railhil.faults.activity import Activity

#: Identifier of the foreign frames: no port has it, and it loses every arbitration against the ports.
FOREIGN_ID = 0x7E0
#: Bits of a frame with 8 bytes and 11 bit identifier, without stuff bits, with the pause behind it.
FRAME_BITS = 111


class Flood:
    """Foreign frames of a given share of the bus, evenly over the instants.

    :param bit_rate: of the bus in bit/s.
    """

    def __init__(self, activity: Activity, bit_rate: int) -> None:
        self._activity = activity
        self._bit_rate = bit_rate
        self._sent = 0

    def frames(self, activities: Activities) -> list[Frame]:
        """The frames of the instant that begins."""
        one = self._activity
        if not one.active or one.begun_ns is None:
            return []
        per_s = one.fault.parameter("share") * self._bit_rate / FRAME_BITS
        due = int((activities.now_ns - one.begun_ns) / 1e9 * per_s) + 1
        count, self._sent = due - self._sent, due
        if count > 0:
            activities.note(one, "", f"{count} x {FOREIGN_ID:03X}")
        return [Frame(FOREIGN_ID, (self._sent - index).to_bytes(8)) for index in range(count)]
