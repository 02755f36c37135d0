"""What the record says twice: milestones of the run against each other and against SIM_TRUTH.

A verdict stands on a few rare telegrams. Each is numbered by the plant and repeated, so a milestone that is not in the
record leaves a number out; and that the train came to a stand is also what SIM_TRUTH shows. Where the two do not agree
the record is INVALID: it is not known what happened.
"""

from __future__ import annotations

import numpy as np

from railhil.bus.telegrams import STOP_LEG_MIN_M, Event, RunEvent
from railhil.supervisor.trace import FloatArray, Trace

#: A train that SIM_TRUTH shows at rest for this long stands. Speeds below half a bit (0.05 mm/s) look like rest too,
#: but no train creeps so slowly for so long.
STANDING_S = 0.5
#: The log's stamps are the recorder's: on a bus that loses frames they may be some ticks off the plant's instants.
STAMP_ERROR_MAX_S = 0.1
#: No train here gains more speed than this per second: what SIM_TRUTH may show of a train that stood just before.
ACCEL_MAX_MPS2 = 10.0
#: Resolution of positions on the wire, rounded once in the milestone and once in the truth.
_LSB_M = 1e-4


def milestone_missing(trace: Trace) -> str:
    """Which milestones of the run are not in the record, as a reason; empty when all are.

    They are numbered from 1 on, and the last of them ends the run. Version 0.1.0 did not number them.
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
    """What STOPPED and SIM_TRUTH contradict each other in, as a reason; empty when they agree.

    :param time_s: of each SIM_TRUTH in s, increasing, shape (n,); ``position_m`` and ``speed_mps`` are what it says.
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
    # Anywhere in it: a train that creeps to its stand reads 0 before it has stopped.
    if stands_s is not None and not np.any(instants_s <= stands_s[1] + STAMP_ERROR_MAX_S):
        return f"record: no STOPPED, but SIM_TRUTH shows that the train stands from {stands_s[0]:.2f} s on"
    return ""


def _first_stand_s(time_s: FloatArray, position_m: FloatArray, speed_mps: FloatArray) -> tuple[float, float] | None:
    """First and last SIM_TRUTH of the first standstill that is a stop; None when there is none."""
    rest = (speed_mps == 0.0) & (position_m >= position_m[0] + STOP_LEG_MIN_M + _LSB_M)
    edges = np.flatnonzero(np.diff(rest.astype(np.int8), prepend=0, append=0))
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        if time_s[end - 1] - time_s[first] >= STANDING_S:
            return float(time_s[first]), float(time_s[end - 1])
    return None
