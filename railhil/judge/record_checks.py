"""Checks whether a record is complete: the milestones of the run, and telegrams that its recorder may have missed.

A verdict depends on a few rare telegrams. Each is numbered by the plant and repeated, so a milestone missing from the
record leaves a gap in the numbers. If a rule needs data that the record lacks, the run is INVALID, because its course
is unknown.
"""

from __future__ import annotations

import math

import numpy as np

from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent
from railhil.common.digits import text_beside_limit
from railhil.faults.truth import HOLE_MAX_S
from railhil.judge.events.telegrams import Gap, gaps, outages
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario

#: Beginning of the reason for which a run is INVALID: the record lacks data that a rule needs.
UNCLEAR = "record: "
#: The recorder makes the log's time stamps: on a bus that loses frames they may differ from the plant's by some ticks.
STAMP_ERROR_MAX_S = 0.1


def incomplete(trace: Trace, truth: str) -> str:
    """The part that a record lacks to be judged as a run, as a reason; empty if it is complete.

    :param truth: the port that shows the train.
    """
    return hole(trace, truth) or milestone_missing(trace)


def hole(trace: Trace, *shown: str) -> str:
    """A time without any telegram of some ports, at the start of the record, within it or at its end, as a reason;
    empty if none is longer than :data:`~railhil.faults.truth.HOLE_MAX_S`.

    :param shown: ports of which each shows what a verdict needs.
    """
    shown_s = np.sort(np.concatenate([trace.times_s(port) for port in shown]))
    begun_s = min(times_s[0] for port in trace.contract.ports if len(times_s := trace.times_s(port.name)))
    time_s = np.concatenate([[begun_s], shown_s, [trace.end_s]])
    gaps_s = np.diff(time_s)
    longest = int(gaps_s.argmax())
    if gaps_s[longest] <= HOLE_MAX_S:
        return ""
    gap = f"{text_beside_limit(gaps_s[longest], HOLE_MAX_S, 2)} s from {time_s[longest]:.2f} s on"
    return f"{UNCLEAR}no {' or '.join(shown)} for {gap}, allowed {HOLE_MAX_S:g} s"


def milestone_missing(trace: Trace) -> str:
    """The milestones of the run that are missing from the record, as a reason; empty if there are none.

    They are numbered from 1, and the last one ends the run. Version 0.1.0 did not number them.
    """
    if not trace.has(RunEvent.PORT, "EventNumber"):
        return ""
    numbers = {int(number) for number in trace.raw(RunEvent.PORT, "EventNumber")}
    missing = sorted(set(range(1, max(numbers, default=0) + 1)) - numbers)
    if not missing:
        return ""
    which = ", ".join(str(number) for number in missing[:5]) + (", ..." if len(missing) > 5 else "")
    return f"{UNCLEAR}RUN_EVENT {which} of {max(numbers)} is missing"


class Unseen:
    """Telegrams of periodic ports that may be missing from a record; none from one that is known to have all frames."""

    def __init__(self, scenario: AnyScenario, trace: Trace) -> None:
        timing = scenario.timing
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

    def period_s(self, port: str) -> float:
        """Period of a port."""
        return self._schedule.ticks(port) * self._schedule.base_tick_ns / 1e9
