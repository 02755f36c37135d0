"""Whether the telegrams of a record agree on the course of a run: milestones, truth, doors and train protection.

What decides a verdict is told more than once: a milestone comes three times under one number, and the truth and the
telegrams of doors and protection show the same. Where two of them contradict each other, the record is not judged.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from railhil.bus.acceptance import life_of
from railhil.bus.layout import FLAG_TRUE, Telegram
from railhil.bus.schedule import Schedule
from railhil.faults.truth import HOLE_MAX_S
from railhil.judge.record_checks import STAMP_ERROR_MAX_S, UNCLEAR, hole
from railhil.record.trace import Trace
from railhil.systems.ato.judge.score import standstill_denied
from railhil.systems.line.judge.course import served_visits, stop_name
from railhil.systems.line.judge.run import LineRun
from railhil.wire.ato import PltStat, SimTruth
from railhil.wire.line import AtpLim, AtpStat, DoorStat, StnInfo

#: Telegrams of the plant that decide a verdict.
DECIDING: tuple[type[Telegram], ...] = (SimTruth, DoorStat, StnInfo, AtpLim, AtpStat)
#: Ports that show the same: one of each pair is enough.
TOGETHER = ((DoorStat.PORT, PltStat.PORT), (AtpLim.PORT, AtpStat.PORT))
_LIFE_VALUES = 16


def contradiction(run: LineRun) -> str:
    """The first contradiction, as a reason; empty if there is none."""
    return (
        next(filter(None, (hole(run.trace, *ports) for ports in TOGETHER)), "")
        or (DoorStat.PORT not in run.forged and _unseen_doors(run.trace))
        or next(filter(None, (_two_sources(run, telegram) for telegram in DECIDING)), "")
        or run.motion.jump()
        or _arrivals(run)
        or _passings(run)
        or (DoorStat.PORT not in run.forged and run.doors.unlike(run.scenario, run.course))
        or run.protection.unlike(run.course)
        or ""
    )


def _unseen_doors(trace: Trace) -> str:
    """A time without DOOR_STAT in which PLT_STAT shows doors that are not locked, as a reason; empty if there is none.

    Without DOOR_STAT nobody knows on which side they were open.
    """
    shown_s = np.concatenate([[-np.inf], trace.times_s(DoorStat.PORT), [np.inf]])
    open_s = trace.times_s(PltStat.PORT)[trace.raw(PltStat.PORT, "DoorsClosedLocked") != FLAG_TRUE]
    after = np.searchsorted(shown_s, open_s)
    unseen_s = open_s[np.minimum(open_s - shown_s[after - 1], shown_s[after] - open_s) > HOLE_MAX_S]
    if not len(unseen_s):
        return ""
    return f"{UNCLEAR}doors not locked at {unseen_s[0]:.2f} s, but no {DoorStat.PORT} within {HOLE_MAX_S:g} s of it"


def _two_sources(run: LineRun, telegram: type[Telegram]) -> str:
    """Two telegrams with one life sign and different contents, or a life sign that steps back: somebody else has sent
    one of them.

    Life signs recur after 16 telegrams; a longer gap says nothing. Nor do telegrams that a fault of the run changes.
    """
    trace, timing, port = run.trace, run.scenario.timing, telegram.PORT
    if port in run.forged:
        return ""
    life = life_of(telegram)
    assert life is not None, f"{port} has no life sign"
    if trace.count(port) < 2:
        return ""
    schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, trace.contract)
    period_s = schedule.ticks(port) * timing.base_tick_ns / 1e9
    time_s, signs = trace.times_s(port), trace.raw(port, life.name)
    steps, gaps_s = np.diff(signs) % _LIFE_VALUES, np.diff(time_s)
    # A gap of so many periods, with the error of the recorder's time stamps, fits so many steps.
    behind = (steps * period_s > gaps_s + STAMP_ERROR_MAX_S + period_s / 2) & (gaps_s < _LIFE_VALUES / 2 * period_s)
    again = np.flatnonzero((steps == 0) & (gaps_s < _LIFE_VALUES / 2 * period_s))
    same = _same_content(trace, telegram, again)
    wrong = np.sort(np.concatenate([np.flatnonzero(behind), again[~same]]))
    if not len(wrong):
        return ""
    return f"{UNCLEAR}{port} at {time_s[wrong[0] + 1]:.2f} s does not follow the telegram before it: two sources"


def _same_content(trace: Trace, telegram: type[Telegram], rows: np.ndarray) -> np.ndarray:
    """Whether the telegrams with these numbers have the contents of those after them, shape of ``rows``."""
    same = np.ones(len(rows), dtype=bool)
    if len(rows):
        for _, signal in telegram.signals():
            values = trace.raw(telegram.PORT, signal.name)
            same &= values[rows] == values[rows + 1]
    return same


def _arrivals(run: LineRun) -> str:
    """An arrival that the truth denies, or a standstill at a stop without an arrival."""
    motion, stops = run.motion, run.scenario.stops
    for visit in served_visits(run.scenario, run.course):
        if (told := visit.arrived) is not None:
            name = f"arrived at stop {stop_name(stops, visit.stop)}"
            denied = standstill_denied(
                name, told.instant_s, told.position_m, motion.time_s, motion.position_m, motion.speed_mps
            )  # fmt: skip
            if denied:
                return denied
    left_s = [(visit.stop, visit.departed.instant_s) for visit in run.course.visits if visit.departed is not None]
    for (_, from_s), (_, until_s) in pairwise([*left_s, (len(stops), run.trace.end_s)]):
        if unclear := _silent_standstill(run, from_s, until_s):
            return unclear
    return ""


def _silent_standstill(run: LineRun, from_s: float, until_s: float) -> str:
    """A standstill at the stop of a section between two departures for which there is no arrival, as a reason."""
    stops, reach_m = run.scenario.stops, run.scenario.route.jog.reach_m
    awaited = [one for one in served_visits(run.scenario, run.course) if one.arrived is None]
    if not awaited:
        return ""
    stop = stops[awaited[0].stop]
    if any(
        visit.arrived is not None and from_s <= visit.arrived.instant_s <= until_s for visit in run.course.visits
    ):  # fmt: skip
        return ""
    for ended_s, standstill in run.motion.standstills():
        at_s, place_m = standstill.instant_s, standstill.position_m
        if ended_s > from_s + STAMP_ERROR_MAX_S and at_s > from_s and place_m >= stop.position_m - reach_m:
            return (
                f"{UNCLEAR}no arrived at stop {stop_name(stops, awaited[0].stop)}, but SIM_TRUTH shows that the train "
                f"stands at {place_m:.2f} m from {at_s:.2f} s on"
            )
    return ""


def _passings(run: LineRun) -> str:
    """A stop that the truth passes without a milestone, or a milestone where the truth is elsewhere, as a reason."""
    motion, stops = run.motion, run.scenario.stops
    for visit in run.course.visits:
        stop = stops[visit.stop]
        if stop.service != "pass":
            continue
        name = stop_name(stops, visit.stop)
        told = visit.passed
        if told is None:
            if motion.position_m[-1] > stop.position_m + 1.0:
                return (
                    f"{UNCLEAR}no passed at stop {name}, but SIM_TRUTH shows the train at {motion.position_m[-1]:.2f} m"
                )
            continue
        around_s = np.array([told.instant_s - STAMP_ERROR_MAX_S, told.instant_s + STAMP_ERROR_MAX_S])
        first_m, last_m = motion.positions_at(around_s)
        if not first_m - 0.01 <= told.position_m <= last_m + 0.01:
            return (
                f"{UNCLEAR}passed at stop {name} at {told.instant_s:.2f} s, but SIM_TRUTH shows the train at "
                f"{last_m:.2f} m"
            )
    return ""
