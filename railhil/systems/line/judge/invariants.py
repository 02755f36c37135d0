"""Rules that hold in every run over a line, faulty or not, checked on the record in addition to those of ``ato``.

7. No traction with an open door: neither a door of the train nor one of the platform that the train stands at.
8. No door is open in motion, outside of the door window, or on a side without platform.
9. The front never passes the supervised location, by truth, neither that of a stop nor that behind a signal that is
   red by timetable or shown red, nor that of a platform on the way whose doors are shown unlocked. The end of
   authority may be passed by less than the interval of the position.
10. The train protection never takes an emergency brake back.
11. A train that stands at a stop leaves it only after a departure that was permitted: not towards a red signal, nor
    from a red exit. Until then it creeps at most up to the stopping point, and does not move with doors that have
    opened.

Without train protection rules 9 and 10 do not apply.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from railhil.bus.layout import FLAG_TRUE
from railhil.common.digits import text_beside_limit
from railhil.judge.record_checks import UNCLEAR
from railhil.record.trace import FloatArray, Trace
from railhil.systems.ato.judge import invariants as of_train
from railhil.systems.ato.judge.invariants import NOTICE_S
from railhil.systems.ato.judge.measures import limits_under_train
from railhil.systems.line.judge.course import Course, stop_name
from railhil.systems.line.judge.run import LineRun
from railhil.systems.line.judge.signals import left_towards_red, passed_red
from railhil.systems.line.scenario.model import LineScenario
from railhil.systems.line.scenario.protection_check import SIGNAL_OVERLAP_M
from railhil.wire.ato import SimTruth
from railhil.wire.line import AtpStat, DoorStat

#: Least force that is traction, N: half of the resolution on the wire.
_FORCE_MIN_N = 10.0
#: Roll of a train that stands, m: the train protection brakes at 0.5 m, and its emergency brake takes up to 1.2 s to
#: build up; on the steepest grade that the holding brake is made for (40 per mille) the train then is at 1.3 m.
ROLL_MAX_M = 1.5


def limits_at(scenario: LineScenario, course: Course, time_s: FloatArray, position_m: FloatArray) -> FloatArray:
    """Speed limit of the whole train at instants and positions, m/s, shape of ``time_s``: by the leg on which it runs.

    A leg begins with the departure from the turn-back before it.
    """
    found = np.full(len(time_s), np.inf)
    begins = [0.0]
    for visit in course.visits:
        if scenario.stops[visit.stop].turn_back:
            begins.append(np.inf if visit.departed is None else visit.departed.instant_s)
    for leg, (begun_s, until_s) in enumerate(zip(begins, [*begins[1:], np.inf], strict=True)):
        rows = (time_s >= begun_s) & (time_s < until_s)
        profile = scenario.legs[leg].speed_limit_mps
        found[rows] = limits_under_train(profile, position_m[rows], scenario.train.length_m)
    return found


def broken(run: LineRun) -> list[str]:
    """One sentence for the first breach of each rule; one that begins with
    :data:`~railhil.judge.record_checks.UNCLEAR` names a gap or contradiction of the record."""
    trace = run.trace
    positions_m = trace.values(SimTruth.PORT, "TruePos")
    limits_mps = limits_at(run.scenario, run.course, trace.times_s(SimTruth.PORT), positions_m)
    found = of_train.broken(run.scenario, trace, limits_mps)
    if DoorStat.PORT not in run.forged:
        found += [*_traction_with_open_door(run)]
        found += [_numbered(8, said) for said in run.doors.breaches(run.scenario, run.course, run.motion)]
    if run.scenario.atp.enabled:
        found += [*_beyond_authority(run)] or [*passed_red(run)]
        found += [] if AtpStat.PORT in run.forged else _emergency_taken_back(trace)
    return [*found, *_left_without_departure(run), *left_towards_red(run)]


def _numbered(rule: int, said: str) -> str:
    return said if said.startswith(UNCLEAR) else f"invariant {rule}: {said}"


def _traction_with_open_door(run: LineRun) -> Iterator[str]:
    """Only doors that stay unlocked for longer than :data:`NOTICE_S` count, and up to the telegram after: the traction
    follows a lock in the next tick, and telegrams later."""
    trace, motion = run.trace, run.motion
    time_s = trace.times_s(DoorStat.PORT)
    if not len(time_s):
        return
    unlocked = trace.raw(DoorStat.PORT, "DoorsLocked") != FLAG_TRUE
    # Under way PsdLocked is that of a platform ahead.
    unlocked |= (trace.raw(DoorStat.PORT, "PsdLocked") != FLAG_TRUE) & (trace.raw(DoorStat.PORT, "PsdPresent") != 0)
    newest = np.maximum(np.searchsorted(time_s, motion.time_s, side="right") - 1, 0)
    earlier = np.maximum(np.searchsorted(time_s, motion.time_s - NOTICE_S, side="right") - 1, 0)
    known = motion.time_s - time_s[newest] < NOTICE_S
    unlocked_there = unlocked[newest] & unlocked[earlier] & unlocked[np.minimum(newest + 1, len(time_s) - 1)]
    wrong = np.flatnonzero(known & unlocked_there & (newest > earlier) & (motion.traction_n > _FORCE_MIN_N))
    if len(wrong):
        first = int(wrong[0])
        yield (
            f"invariant 7: {motion.traction_n[first] / 1e3:.1f} kN of traction with an open door, "
            f"at {motion.time_s[first]:.2f} s"
        )


def _beyond_authority(run: LineRun) -> Iterator[str]:
    scenario, motion = run.scenario, run.motion
    for section in scenario.sections:
        left, stop = run.course.visits[section.departure].departed, scenario.stops[section.arrival]
        after = run.course.visits[section.arrival].departed
        if left is None:
            return
        until_s = np.inf if after is None else after.instant_s
        part = motion.between(left.instant_s, until_s)
        limit_m = stop.position_m + stop.svl_overlap_m
        if len(part.position_m) and part.position_m.max() > limit_m:
            found = text_beside_limit(float(part.position_m.max()), limit_m, 2)
            yield (
                f"invariant 9: the front was at {found} m, supervised location {limit_m:.2f} m behind stop "
                f"{stop_name(scenario.stops, section.arrival)}"
            )
            return
    begun_s = run.course.visits[0].departed
    for signal in scenario.signals if begun_s is not None else ():
        limit_m = signal.position_m + SIGNAL_OVERLAP_M
        part = motion.between(0.0, signal.clear_s)
        if len(part.position_m) and part.position_m.max() > limit_m:
            found = text_beside_limit(float(part.position_m.max()), limit_m, 2)
            yield (
                f"invariant 9: the front was at {found} m before {signal.clear_s:g} s, supervised location "
                f"{limit_m:.2f} m behind a red signal"
            )
            return


def _emergency_taken_back(trace: Trace) -> Iterator[str]:
    braking = trace.raw(AtpStat.PORT, "AtpEmergency") == FLAG_TRUE
    lasting = braking[:-2] & braking[1:-1] & ~braking[2:]
    ended = np.flatnonzero(lasting)
    if len(ended) and not braking[ended[0] + 2 :].all():
        if braking[ended[0] + 3 :].all() and len(braking) > ended[0] + 3:
            yield f"{UNCLEAR}one {AtpStat.PORT} alone takes the emergency brake back"
        else:
            yield (
                f"invariant 10: the train protection took its emergency brake back at "
                f"{trace.times_s(AtpStat.PORT)[ended[0] + 2]:.2f} s"
            )


def _left_without_departure(run: LineRun) -> Iterator[str]:
    """A train that rolls away from a stop without a departure.

    A milestone of a creep only says that the train began to move: it may roll. Only from a place within the reach of
    creeping, and with doors that have not opened, may it move to the stopping point.
    """
    for visit in run.course.visits:
        told, stop = visit.arrived, run.scenario.stops[visit.stop]
        if told is None and visit.stop > 0:
            continue
        from_s = 0.0 if told is None else told.instant_s
        until_s = run.trace.end_s if visit.departed is None else visit.departed.instant_s
        part = run.motion.between(from_s, until_s)
        if not len(part.position_m):
            continue
        least_m, most_m = float(part.position_m.min()), float(part.position_m.max())
        creep_m = stop.position_m - least_m
        if not visit.jogs or not 0.0 < creep_m <= run.scenario.route.jog.reach_m + stop.stop_error_max_m:
            creep_m = 0.0
        moved_m = most_m - least_m if most_m - least_m > creep_m + ROLL_MAX_M else 0.0
        if visit.opened and not moved_m:
            after_m = run.motion.between(visit.opened[0].instant_s, until_s).position_m
            moved_m = float(np.ptp(after_m)) if len(after_m) and np.ptp(after_m) > ROLL_MAX_M else 0.0
        if moved_m:
            name = stop_name(run.scenario.stops, visit.stop)
            yield f"invariant 11: the train moved {moved_m:.2f} m at stop {name} without a departure"
            return
