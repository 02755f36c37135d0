"""Safe data transmission, SDTv2, on MVB: the trailer of a safe telegram, its source, and its sink.

IEC 61375-2-3, annex B. The last six octets of the process data are the version of the user data, a sequence counter of
8 bits (SSC) and a CRC-32 that is seeded with the identity of the source (SID): a telegram of another source, or of
another port, fails the CRC.

A sink judges once per cycle, whether a telegram has arrived or not. *Fresh*: use the data. *Invalid*: nothing new, but
for fewer than ``n_rxsafe`` cycles. *Error*: there are no safe data. Causes for which a telegram does not count:

=================== ===================================================================================================
crc                 damaged, or of another source or port
version             user data of another layout
duplicate           SSC unchanged: a stuck sender, which does not initialise a channel either
out_of_sequence     SSC further ahead than ``n_ssc``, or behind
channel             a second, different CRC error within ``cmthr`` telegrams: Error until that many good ones
redundancy          the other source within ``n_guard`` cycles after a switch-over: Error until these are over
=================== ===================================================================================================

After an error the first good telegram initialises the channel, the second one is fresh. The counter repeats itself
after 256 telegrams, so the user data must distinguish an old telegram with the expected counter from a new one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

#: Octets of the trailer: version, sequence counter, CRC.
TRAILER_BYTES = 6
CRC_BYTES = 4
#: Version of the protocol, part of the identity of a source.
PROTOCOL_VERSION = 2
#: Major version of the user data of the bench's safe telegrams.
SAFE_DATA_VERSION = 1
#: Generator polynomial of the safety code (IEC 61784-3-3), without its highest term.
POLYNOMIAL = 0xF4ACFB13
_MASK = 0xFFFF_FFFF
_SSC_MODULUS = 256


def _row(octet: int) -> int:
    value = octet << 24
    for _ in range(8):
        value = (value << 1 ^ (POLYNOMIAL if value & 0x8000_0000 else 0)) & _MASK
    return value


_TABLE = tuple(map(_row, range(256)))


def crc32(data: bytes, seed: int) -> int:
    """CRC-32 of the safety code: most significant bit first, ``seed`` in the register at the start, not inverted.

    The CRC of data followed by their own CRC is 0.
    """
    value = seed
    for octet in data:
        value = (value << 8 & _MASK) ^ _TABLE[value >> 24 ^ octet]
    return value


def source_identity(message: int) -> int:
    """SID of the source of a safe message; ``message``: its identifier (SMI), here the address of its port."""
    block = message.to_bytes(4) + bytes(2) + PROTOCOL_VERSION.to_bytes(2) + bytes(24)
    return crc32(block, _MASK)


class Validity(Enum):
    """The verdict of a sink on one cycle."""

    FRESH = "fresh"
    INVALID = "invalid"
    ERROR = "error"


@dataclass(frozen=True, slots=True)
class SinkLimits:
    """``n_rxsafe``: cycles without a fresh telegram before Error; ``n_ssc``: largest step of the counter; ``n_guard``:
    cycles after a switch-over of the source in which no other may follow; ``cmthr``: telegrams within which a second
    CRC error fails the channel."""

    n_rxsafe: int = 3
    n_ssc: int = 4
    n_guard: int = 50
    cmthr: int = 1000


class SafeSource:
    """Makes the trailers of one safe port.

    :param sid: identity of the source, :func:`source_identity`.
    :param version: major version of the user data, 0 to 15.
    """

    def __init__(self, sid: int, version: int) -> None:
        self._sid = sid
        self._version = version << 4
        self._ssc = 0

    def secured(self, data: bytes) -> bytes:
        """Process data with the next trailer in their last :data:`TRAILER_BYTES` octets."""
        body = data[:-TRAILER_BYTES] + bytes((self._version, self._ssc))
        self._ssc = (self._ssc + 1) % _SSC_MODULUS
        return body + crc32(body, self._sid).to_bytes(CRC_BYTES)


class SafeSink:
    """Judges the telegrams of one safe port.

    :param sids: identities of the source and, if there is one, of the redundant source.
    :param version: as in :class:`SafeSource`.
    :param counters: telegrams that were not used, by cause as in this module's table; ``source``: switch-overs.
    """

    def __init__(
        self, sids: Sequence[int], version: int, limits: SinkLimits, counters: Counter[str] | None = None
    ) -> None:
        self.counters: Counter[str] = Counter() if counters is None else counters
        self._sids = list(sids)
        self._version = version
        self._limits = limits
        self._initial = True
        self._ssc = -1
        self._verdict = Validity.ERROR
        # Cycles since the last fresh telegram, and cycles left of the guard time.
        self._cycles = limits.n_rxsafe
        self._guard = 0
        self._guard_violated = False
        # The last duplicate telegram: it does not initialise the channel.
        self._stuck = b""
        # Telegrams left of the interval that began with a CRC error, the damaged telegram, and whether another one
        # followed.
        self._monitored = 0
        self._damaged = b""
        self._channel_failed = False

    def judge(self, data: bytes | None) -> Validity:
        """Take the process data of this cycle's telegram; None: none has arrived."""
        self._guard = max(self._guard - 1, 0)
        self._cycles = min(self._cycles + 1, self._limits.n_rxsafe)
        cause = "" if data is None else self._refused(data)
        if data is not None and not cause:
            self._verdict = self._used()
        else:
            if cause:
                self.counters[cause] += 1
            self._verdict = self._unused()
        return self._verdict

    def _refused(self, data: bytes) -> str:
        """Cause for which a telegram is not used; empty if it is used."""
        cause = self._source_of(data)
        if cause:
            return cause
        if data[-TRAILER_BYTES] >> 4 != self._version:
            return "version"
        ssc = data[-TRAILER_BYTES + 1]
        if self._initial:
            if data == self._stuck:
                return "duplicate"
        elif ssc == self._ssc:
            self._stuck = data
            return "duplicate"
        elif (ssc - self._ssc) % _SSC_MODULUS > self._limits.n_ssc:
            return "out_of_sequence"
        self._ssc = ssc
        return ""

    def _source_of(self, data: bytes) -> str:
        """Check the CRC with the identity of the present source, then with that of the redundant one."""
        body, code = data[:-CRC_BYTES], int.from_bytes(data[-CRC_BYTES:])
        for place, sid in enumerate(self._sids):
            if crc32(body, sid) != code:
                continue
            if place == 0:
                return ""
            self._sids[0], self._sids[place] = sid, self._sids[0]
            self.counters["source"] += 1
            violated = self._guard > 0
            self._guard, self._initial, self._monitored = self._limits.n_guard, True, 0
            self._guard_violated |= violated
            return "redundancy" if violated else ""
        self._monitor(data)
        return "crc"

    def _monitor(self, damaged: bytes) -> None:
        """Channel monitoring: two different damaged telegrams within the interval fail the channel."""
        if self._monitored and damaged != self._damaged:
            self._channel_failed = True
            self.counters["channel"] += 1
        elif self._monitored or self._initial:
            return
        self._monitored, self._damaged = self._limits.cmthr, damaged

    def _unused(self) -> Validity:
        if self._cycles >= self._limits.n_rxsafe:
            self._initial = True
        if self._initial or self._channel_failed or self._guard_violated:
            return Validity.ERROR
        return Validity.INVALID if self._verdict is not Validity.ERROR else Validity.ERROR

    def _used(self) -> Validity:
        if self._initial:
            # After a switch-over of the source the channel may have been in order until now.
            self._initial, self._cycles = False, 1
            return Validity.INVALID if self._verdict is not Validity.ERROR else Validity.ERROR
        self._cycles = 0
        self._stuck = b""
        if self._guard_violated:
            # The guard time must pass as a whole; then the channel begins anew.
            if not self._guard:
                self._guard_violated, self._initial = False, True
            return Validity.ERROR
        if self._monitored:
            self._monitored -= 1
        else:
            self._channel_failed = False
        return Validity.ERROR if self._channel_failed else Validity.FRESH


class SafeTelegram(Protocol):
    """A safe telegram of the bench: the simulation time of its source in base ticks, modulo 2^24, in two fields."""

    tick_high: int
    tick_low: int


def safe_tick(telegram: SafeTelegram) -> int:
    """Simulation time of the source in base ticks, modulo 2^24."""
    return telegram.tick_high << 16 | telegram.tick_low


def safe_tick_fields(tick: int) -> dict[str, int]:
    """The fields that hold the time of a safe telegram."""
    return {"tick_high": tick >> 16 & 0xFF, "tick_low": tick & 0xFFFF}
