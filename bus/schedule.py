"""When each port is due: the periods of the port table with a scenario's overrides, in ticks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from railhil.dbc import Contract, wire_contract


@dataclass(frozen=True, slots=True)
class Schedule:
    """Periods of the ports in ticks; a port is due at every tick that is a multiple of its period."""

    base_tick_ns: int
    periods_ns: Mapping[str, int]

    @classmethod
    def from_contract(
        cls, base_tick_ns: int, overrides: Mapping[str, int], contract: Contract | None = None
    ) -> Schedule:
        """Periods of the port table with the scenario's overrides.

        :param contract: of the run's system; None: that of railhil's own train.
        """
        periods = {port.name: port.period_ns for port in (contract or wire_contract()).ports if port.period_ns}
        return cls(base_tick_ns, {**periods, **overrides})

    def ticks(self, port: str) -> int:
        """Period of a port in ticks, at least one."""
        return max(1, self.periods_ns[port] // self.base_tick_ns)
