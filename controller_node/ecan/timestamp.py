"""Time stamps of messages in bit times, and the age of a message derived from them.

Source: TI SPRU074F and SPRUI07, chapter eCAN (time stamp counter, message object time stamps).
"""

from __future__ import annotations

from math import gcd
from typing import Final

_COUNTER_MASK: Final = 0xFFFF_FFFF
_HALF_TURN: Final = 1 << 31
#: A time stamp may lie this far in the future: TIME_SYNC can set the clock back after repeated polls had advanced it
#: too far.
_AHEAD_BITS = 1 << 20
_OLDEST_BITS: Final = _COUNTER_MASK - _AHEAD_BITS
_NS_PER_S: Final = 1_000_000_000


class BitCounter:
    """The time stamp counter: 32 bits, one count per bit time, wraps (after 8590 s at 500 kbit/s).

    It runs on simulation time, so a stamp has the resolution of the base tick.

    :param bit_rate: bit/s, above 0.
    """

    def __init__(self, bit_rate: int) -> None:
        common = gcd(bit_rate, _NS_PER_S)
        self._bits, self._ns = bit_rate // common, _NS_PER_S // common
        self.half_turn_ns = _HALF_TURN * self._ns // self._bits

    def at(self, now_ns: int) -> int:
        """Counter at a simulation time."""
        return now_ns * self._bits // self._ns & _COUNTER_MASK

    def age_ns(self, stamp: int, now_ns: int) -> int:
        """Age of a time stamp in ns, exact to one bit time, modulo the counter's range; 0 for a stamp slightly in the
        future."""
        bits = now_ns * self._bits // self._ns - stamp & _COUNTER_MASK
        return bits * self._ns // self._bits if bits <= _OLDEST_BITS else 0


class MessageAge:
    """Age of the newest message that was accepted, from its time stamp.

    A time stamp older than half the counter's range would look fresh again after the wrap; therefore an age that has
    once reached that value stays there until a message is accepted. For this, :meth:`ns` must be called more often than
    every half range.
    """

    def __init__(self, counter: BitCounter) -> None:
        self._counter = counter
        self._stamp = 0
        self._expired = False

    def accept(self, stamp: int) -> None:
        """Take the time stamp of an accepted message; before the first, the age counts from time 0."""
        self._stamp = stamp
        self._expired = False

    def ns(self, now_ns: int) -> int:
        """Age in ns; half the counter's range if it is, or has been, that or more."""
        counter = self._counter
        age_ns = counter.age_ns(self._stamp, now_ns)
        if age_ns >= counter.half_turn_ns:
            self._expired = True
        return counter.half_turn_ns if self._expired else age_ns
