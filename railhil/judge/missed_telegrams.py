"""Unknowns of a record: telegrams that its recorder may have missed, and in real time the instants at which a node has
taken them."""

from __future__ import annotations

import math

from railhil.bus.ident import PACES, PltIdent
from railhil.bus.schedule import Schedule
from railhil.judge.events.telegrams import Gap, gaps, outages
from railhil.record.trace import Trace
from railhil.systems.ato.scenario.model import Scenario

#: Beginning of the reason for which a run is INVALID: the record lacks data that a rule needs.
UNCLEAR = "record: "


class Unseen:
    """Telegrams of periodic ports that may be missing from a record; none from one that is known to have all frames."""

    def __init__(self, scenario: Scenario, trace: Trace) -> None:
        timing = scenario.timing
        watch = scenario.watch
        self._ages_ms = (0, watch.hold_ms, watch.traction_cut_ms, watch.service_brake_ms)
        ident = trace.ident(PltIdent)
        self._is_realtime = ident is not None and ident.pace == PACES.index("realtime")
        self._schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, trace.contract)
        self._trace = trace
        #: Whether the record is known to have all frames.
        self.is_whole = trace.reported is not None and trace.reported.exact
        self._gaps: dict[str, list[Gap]] = {}

    def count(self, port: str, from_s: float = 0.0, until_s: float = math.inf) -> int:
        """Number of telegrams of a port that may be missing around an interval of time."""
        if self.is_whole:
            return 0
        if port not in self._gaps:
            entry = self._trace.contract.port(port)
            self._gaps[port] = [*gaps(self._trace, entry, self._schedule), *outages(self._trace, entry, self._schedule)]
        return sum(
            gap.missing for gap in self._gaps[port] if gap.begun_ns <= until_s * 1e9 and gap.until_ns >= from_s * 1e9
        )

    def lag_s(self, level: int) -> float:
        """Largest delay with which a node takes a telegram after the recorder, for a level entered before it. In
        lockstep there is none. In real time the node's watch limits it: a stronger level would report that it has taken
        none for longer."""
        return self._ages_ms[level] / 1e3 if self._is_realtime else 0.0

    def period_s(self, port: str) -> float:
        """Period of a port."""
        return self._schedule.ticks(port) * self._schedule.base_tick_ns / 1e9
