"""A clock of the bus for tests, and what it hears."""

from __future__ import annotations

from railhil.bus.clock import BusClock
from railhil.wire.ato import TrnSpeed

TICK_NS = 10_000_000
POLL_TICKS = 2
#: Process data of the clock port, by life sign.
TELEGRAMS = [TrnSpeed(123, life=life).encode() for life in range(16)]


def started(tick: int = 0, base_tick_ns: int = TICK_NS) -> BusClock:
    """A clock that has heard the clock frames of the ticks 0 to ``tick``."""
    clock = BusClock(base_tick_ns, 1)
    assert not clock.running
    for item in range(tick + 1):
        assert clock.feed(TELEGRAMS[item % 16])
    assert (clock.running, clock.tick, clock.now_ns) == (True, tick, tick * base_tick_ns)
    return clock
