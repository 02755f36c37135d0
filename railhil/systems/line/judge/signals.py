"""Red signals as a record shows them: whatever holds one red, the timetable or a fault, STN_INFO shows it.

SignalNext is the aspect of the next signal ahead of the front. Which one that is, follows from the train's place; while
it stands at a turn-back, it is the first one of the leg behind it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from railhil.common.digits import text_beside_limit
from railhil.record.trace import FloatArray
from railhil.systems.line.judge.course import stop_name
from railhil.systems.line.judge.run import LineRun
from railhil.systems.line.scenario.model import RouteSignal
from railhil.systems.line.scenario.protection_check import SIGNAL_OVERLAP_M, track_of
from railhil.wire.line import SignalAspect, StnInfo

#: Period of STN_INFO, s, with some margin.
_PERIOD_S: Final = 0.18
#: From the red aspect to the look of the train protection that sees it, s: its period and a telegram.
_SEEN_S: Final = 0.3


class _Told(NamedTuple):
    """One aspect: instant in s, true position of the front in m, the signal, and whether it is red."""

    time_s: float
    position_m: float
    signal: RouteSignal | None
    is_red: bool


def passed_red(run: LineRun) -> Iterator[str]:
    """The first signal that the front passes red, in one go and by more than its overlap.

    A signal that falls to red so near before the train that no emergency brake of the protection's model stops it does
    not count. Nor does a train that has been slower than the release speed behind the signal: by then it may be clear.
    """
    motion, told = run.motion, _aspects(run)
    slow_mps = run.scenario.atp.v_release_mps
    for signal in sorted(run.scenario.signals, key=lambda one: (one.leg, one.position_m)):
        beyond = np.flatnonzero(motion.position_m > signal.position_m)
        if not len(beyond) or not (shown := _shown_before(told, signal, float(motion.time_s[beyond[0]]))):
            continue
        limit_m = signal.position_m + SIGNAL_OVERLAP_M
        slow = np.flatnonzero(motion.speed_mps[beyond] <= slow_mps)
        far_m = float(motion.position_m[beyond[: slow[0] if len(slow) else len(beyond)]].max(initial=-np.inf))
        if far_m > limit_m and _could_stop(run, shown[0]):
            yield (
                f"invariant 9: the front was at {text_beside_limit(far_m, limit_m, 2)} m, supervised location "
                f"{limit_m:.2f} m behind a signal that showed red from {shown[0].time_s:.2f} s on"
            )
            return


def left_towards_red(run: LineRun) -> Iterator[str]:
    """The first departure into a section while a signal of it shows red, before the departure and after it."""
    told, stops = _aspects(run), run.scenario.stops
    for section in run.scenario.sections:
        left = run.course.visits[section.departure].departed
        if left is None:
            return
        near = [one for one in told if abs(one.time_s - left.instant_s) < _PERIOD_S]
        before, after = ([one for one in near if (one.time_s <= left.instant_s) is first] for first in (True, False))
        until_m = stops[section.arrival].position_m
        if before and after and all(_is_red_up_to(one, section.leg, until_m) for one in (before[-1], after[0])):
            name = stop_name(stops, section.departure)
            yield f"invariant 11: the train left stop {name} at {left.instant_s:.2f} s towards a red signal"
            return


def _is_red_up_to(told: _Told, leg: int, until_m: float) -> bool:
    signal = told.signal
    return told.is_red and signal is not None and signal.leg == leg and signal.position_m <= until_m


def _aspects(run: LineRun) -> list[_Told]:
    """What the record shows of signals; nothing if a fault changes the telegram."""
    signals, port = run.scenario.signals, StnInfo.PORT
    if not signals or port in run.forged:
        return []
    time_s = run.trace.times_s(port)
    legs = _legs_ahead(run, time_s, run.trace.raw(port, "Leg"))
    places_m = run.motion.positions_at(time_s)
    red = run.trace.raw(port, "SignalNext") == SignalAspect.RED
    return [
        _Told(
            at_s,
            place_m,
            min(
                (one for one in signals if one.leg == leg and one.position_m >= place_m),
                key=lambda one: one.position_m,
                default=None,
            ),
            is_red,
        )
        for at_s, place_m, leg, is_red in zip(
            time_s.tolist(), places_m.tolist(), legs.tolist(), red.tolist(), strict=True
        )
    ]


def _legs_ahead(run: LineRun, time_s: FloatArray, legs: NDArray[np.int64]) -> NDArray[np.int64]:
    """The legs of the next signals: those of the train, but at a stop the one into which it departs."""
    ahead = legs.copy()
    for section in run.scenario.sections:
        visit = run.course.visits[section.departure]
        if visit.arrived is not None:
            until_s = np.inf if visit.departed is None else visit.departed.instant_s
            ahead[(time_s >= visit.arrived.instant_s) & (time_s <= until_s)] = section.leg
    return ahead


def _shown_before(told: list[_Told], signal: RouteSignal, passed_s: float) -> list[_Told]:
    """The telegrams that show a signal red up to its passing, without a gap; empty if the last one does not."""
    found: list[_Told] = []
    next_s = passed_s
    for one in reversed(told):
        if one.time_s >= passed_s:
            continue
        if one.signal is not signal or not one.is_red or next_s - one.time_s > _PERIOD_S:
            break
        next_s = one.time_s
        found.append(one)
    return found[::-1]


def _could_stop(run: LineRun, first: _Told) -> bool:
    """Whether the protection can stop the train before the supervised location, when it first sees the red aspect."""
    line, signal = run.scenario, first.signal
    assert signal is not None
    track = track_of(line.atp, line.train, line.legs[signal.leg])
    end = track.end_target(signal.position_m, signal.position_m + SIGNAL_OVERLAP_M, 0.0, 0.0)
    seen_s = np.array([first.time_s, first.time_s + _SEEN_S])
    speed_mps = float(run.motion.speeds_at(seen_s).max())
    accel_mps2 = float(max(0.0, run.motion.between(first.time_s, first.time_s + _SEEN_S).accel_mps2.max(initial=0.0)))
    brakes_m = end.target.emergency.place_m(speed_mps, 0.0, accel_mps2)
    return first.position_m + speed_mps * _SEEN_S <= brakes_m
