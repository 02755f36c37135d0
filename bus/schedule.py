"""When each port is due, and how much of a classic CAN bus the ports take.

Periods are those of the port table with a scenario's overrides, in ticks.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from railhil.dbc import Contract, Port


@dataclass(frozen=True, slots=True)
class Schedule:
    """Periods of the ports in ticks; a port is due at every tick that is a multiple of its period."""

    base_tick_ns: int
    periods_ns: Mapping[str, int]

    @classmethod
    def from_contract(cls, base_tick_ns: int, overrides: Mapping[str, int], contract: Contract) -> Schedule:
        """Periods of the port table with the scenario's overrides.

        :param contract: of the run's system.
        """
        periods = {port.name: port.period_ns for port in contract.ports if port.period_ns}
        return cls(base_tick_ns, {**periods, **overrides})

    def ticks(self, port: str) -> int:
        """Period of a port in ticks, at least one."""
        return max(1, self.periods_ns[port] // self.base_tick_ns)


#: Bits of a standard data frame with n data bytes on the wire, without stuff bits: 47 + 8 n (with interframe space).
_FRAME_BITS = 47
#: Bits subject to stuffing: 34 + 8 n; worst-case stuffing adds one bit after the first five, then one per four.
_STUFFED_BITS = 34
POLL_BYTES = 3


def longest_frame_bits(data_bytes: int) -> int:
    """Bits of a standard CAN frame with worst-case stuffing (8 bytes: 135, 3 bytes: 85)."""
    return _FRAME_BITS + 8 * data_bytes + (_STUFFED_BITS + 8 * data_bytes - 1) // 4


def telegram_bits(port: Port) -> int:
    """Maximum bits on the wire of one telegram, including the administrator's poll if the port is polled."""
    frames = longest_frame_bits(8) * len(port.can_ids)
    return frames + (longest_frame_bits(POLL_BYTES) if port.mode == "poll" else 0)


def bus_load(contract: Contract, bit_rate: int) -> dict[str, float]:
    """Bus load of each port at ``bit_rate`` bit/s, as a share (0 for ports without a period)."""
    return {
        port.name: telegram_bits(port) * 1e9 / port.period_ns / bit_rate if port.period_ns else 0.0
        for port in contract.ports
    }
