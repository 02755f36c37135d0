"""Checks whether a record is complete: milestones of the run against each other and against SIM_TRUTH.

A verdict depends on a few rare telegrams. Each is numbered by the plant and repeated, so a milestone missing from the
record leaves a gap in the numbers; and a standstill of the train is also visible in SIM_TRUTH. If the two disagree the
record is INVALID, because the course of the run is unknown.
"""

from __future__ import annotations

import numpy as np

from railhil.bus.codes import STOP_LEG_MIN_M, Event
from railhil.bus.telegrams import RunEvent
from railhil.common.digits import text_beside_limit
from railhil.faults.truth import HOLE_MAX_S
from railhil.record.trace import FloatArray, Trace

#: A train that SIM_TRUTH shows at rest for this long has stopped. Speeds below half an LSB (0.05 mm/s) also appear as
#: rest, but no train creeps so slowly for so long.
STANDING_S = 0.5
#: The recorder makes the log's time stamps: on a bus that loses frames they may differ from the plant's by some ticks.
STAMP_ERROR_MAX_S = 0.1
#: Maximum acceleration of a train: limits the speed that SIM_TRUTH may show shortly after a standstill.
ACCEL_MAX_MPS2 = 10.0
#: Resolution of positions on the wire, rounded once in the milestone and once in the truth.
_LSB_M = 1e-4


def incomplete(trace: Trace, truth: str) -> str:
    """The part that a record lacks to be judged as a run, as a reason; empty if it is complete.

    :param truth: the port that shows the train.
    """
    return _hole(trace, truth) or milestone_missing(trace)


def _hole(trace: Trace, truth: str) -> str:
    """A time without the train, at the start of the record, within it or at its end."""
    shown_s = trace.times_s(truth)
    firsts_s = [trace.times_s(port.name)[:1] for port in trace.contract.ports]
    time_s = np.concatenate([[np.concatenate(firsts_s).min()], shown_s, [max(trace.end_s, shown_s[-1])]])
    gaps_s = np.diff(time_s)
    longest = int(gaps_s.argmax())
    if gaps_s[longest] <= HOLE_MAX_S:
        return ""
    gap = f"{text_beside_limit(gaps_s[longest], HOLE_MAX_S, 2)} s from {time_s[longest]:.2f} s on"
    return f"record: no {truth} for {gap}, allowed {HOLE_MAX_S:g} s"


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
    return f"record: RUN_EVENT {which} of {max(numbers)} is missing"


def standstill_unclear(trace: Trace, time_s: FloatArray, position_m: FloatArray, speed_mps: FloatArray) -> str:
    """The contradiction between STOPPED and SIM_TRUTH, as a reason; empty if they agree.

    :param time_s: of each SIM_TRUTH in s, increasing, shape (n,); ``position_m`` and ``speed_mps`` are its values.
    """
    codes = trace.raw(RunEvent.PORT, "RunEvent")
    stopped = np.flatnonzero(codes == Event.STOPPED)
    instants_s, places_m = (trace.values(RunEvent.PORT, name)[stopped] for name in ("EventTime", "EventPos"))
    for instant_s, place_m in zip(instants_s, places_m, strict=True):
        after = min(int(np.searchsorted(time_s, instant_s + STAMP_ERROR_MAX_S)), len(time_s) - 1)
        before = max(int(np.searchsorted(time_s, instant_s - STAMP_ERROR_MAX_S)) - 1, 0)
        allowed_mps = ACCEL_MAX_MPS2 * max(STAMP_ERROR_MAX_S, time_s[after] - instant_s)
        if speed_mps[after] > allowed_mps:
            return (
                f"record: STOPPED at {instant_s:.2f} s, but SIM_TRUTH shows {speed_mps[after]:.2f} m/s "
                f"at {time_s[after]:.2f} s"
            )
        if not position_m[before] - 2 * _LSB_M <= place_m <= position_m[after] + 2 * _LSB_M:
            return (
                f"record: STOPPED at {place_m:.2f} m, but SIM_TRUTH shows the train at {position_m[after]:.2f} m "
                f"at {time_s[after]:.2f} s"
            )
    stands_s = _first_stand_s(time_s, position_m, speed_mps)
    # The milestone may lie anywhere within the standstill: a creeping train reads 0 before it has stopped.
    if stands_s is not None and not np.any(instants_s <= stands_s[1] + STAMP_ERROR_MAX_S):
        return f"record: no STOPPED, but SIM_TRUTH shows that the train stands from {stands_s[0]:.2f} s on"
    return ""


def _first_stand_s(time_s: FloatArray, position_m: FloatArray, speed_mps: FloatArray) -> tuple[float, float] | None:
    """First and last SIM_TRUTH of the first standstill that counts as a stop; None if there is none."""
    rest = (speed_mps == 0.0) & (position_m >= position_m[0] + STOP_LEG_MIN_M + _LSB_M)
    edges = np.flatnonzero(np.diff(rest.astype(np.int8), prepend=0, append=0))
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        if time_s[end - 1] - time_s[first] >= STANDING_S:
            return float(time_s[first]), float(time_s[end - 1])
    return None
