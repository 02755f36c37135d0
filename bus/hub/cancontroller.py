"""A client's CAN controller as ISO 11898-1 has it: two error counters, the states that follow from them, bus-off.

====================================== ================================================================================
event                                  counters
====================================== ================================================================================
an own frame destroyed by an error     TEC + 8; the controller sends it again by itself
a frame of another one destroyed       REC + 1
an own frame sent                      TEC - 1, not below 0
a frame received                       REC - 1, not below 0; from above 127 to 119
TEC or REC 128 or more                 error-passive; both below 128 again: error-active
TEC above 255                          bus-off: neither sends nor receives, until it is restarted
held error-passive (by order)          TEC 128, or more if it is; it does not fall below that while it is held
restarted                              after 128 times 11 recessive bits: TEC = REC = 0, error-active; a controller
                                       that is held passive is at TEC 128 again
====================================== ================================================================================

Not modelled: the REC + 8 of a receiver that sees a dominant bit after its own error flag, errors that only one receiver
sees, missing acknowledgement, the longer pause of an error-passive sender.
"""

from __future__ import annotations

from railhil.bus.frame import Frame
from railhil.bus.link import errorframe

ERROR_ACTIVE, ERROR_PASSIVE, BUS_OFF = "error-active", "error-passive", "bus-off"
#: A restarted controller waits for 128 occurrences of 11 recessive bits.
RECOVERY_BITS = 128 * 11
_WARNING, _PASSIVE, _OFF = 96, 128, 256
_AFTER_PASSIVE = 119
_SEND_ERROR = 8


class CanController:
    """The error counters of one client. Methods return the error frames for its own host.

    :ivar tec: transmit error counter, 0 to 256 or a little more.
    :ivar rec: receive error counter.
    :ivar least_tec: below this value the transmit error counter does not fall.
    :ivar errors_left: number of its next attempts to send a frame that an error destroys.
    """

    def __init__(self) -> None:
        self.tec = 0
        self.rec = 0
        self.least_tec = 0
        self.errors_left = 0
        self.is_off = False
        self._states = 0

    @property
    def state(self) -> str:
        """One of :data:`ERROR_ACTIVE`, :data:`ERROR_PASSIVE`, :data:`BUS_OFF`."""
        if self.is_off:
            return BUS_OFF
        return ERROR_PASSIVE if max(self.tec, self.rec) >= _PASSIVE else ERROR_ACTIVE

    def send_failed(self) -> list[Frame]:
        """An own frame was destroyed."""
        self.tec += _SEND_ERROR
        found = [errorframe.bus_error(self.tec, self.rec, sending=True)]
        return found + (self.go_off() if self.tec >= _OFF else self._changes())

    def receive_failed(self) -> list[Frame]:
        """A frame of another client was destroyed."""
        self.rec += 1
        return [errorframe.bus_error(self.tec, self.rec, sending=False), *self._changes()]

    def sent(self, frames: int) -> list[Frame]:
        """Own frames were sent."""
        if self.tec == self.least_tec:
            return []
        self.tec = max(self.tec - frames, self.least_tec)
        return self._changes()

    def received(self, frames: int) -> list[Frame]:
        """Frames of another client were received."""
        if not self.rec:
            return []
        if self.rec >= _PASSIVE:
            self.rec, frames = _AFTER_PASSIVE, frames - 1
        self.rec = max(self.rec - frames, 0)
        return self._changes()

    def hold_passive(self, on: bool) -> list[Frame]:
        """Be error-passive and stay so, or leave it to the traffic again."""
        self.least_tec = _PASSIVE if on else 0
        self.tec = max(self.tec, self.least_tec)
        return [] if self.is_off else self._changes()

    def go_off(self) -> list[Frame]:
        """Leave the bus."""
        if self.is_off:
            return []
        self.tec, self.is_off, self.errors_left = max(self.tec, _OFF), True, 0
        return [errorframe.bus_off()]

    def restart(self) -> list[Frame]:
        """Be back on the bus, after the recessive bits."""
        if not self.is_off:
            return []
        self.tec, self.rec, self._states = self.least_tec, 0, 0
        self.is_off = False
        # The ordered state holds until the order ends.
        return [errorframe.restarted(), *(self._changes() or [errorframe.controller_state(0, 0, errorframe.ACTIVE)])]

    def _changes(self) -> list[Frame]:
        """The error frame about limits that a counter has passed, if any."""
        states = _level(self.tec, errorframe.TRANSMIT_WARNING, errorframe.TRANSMIT_PASSIVE)
        states |= _level(self.rec, errorframe.RECEIVE_WARNING, errorframe.RECEIVE_PASSIVE)
        if states == self._states:
            return []
        self._states = states
        return [errorframe.controller_state(self.tec, self.rec, states or errorframe.ACTIVE)]


def _level(count: int, warning: int, passive: int) -> int:
    if count >= _PASSIVE:
        return passive
    return warning if count >= _WARNING else 0
