"""Red signals as a record shows them: whatever holds one red, the timetable or a fault, STN_INFO shows it.

SignalNext is the aspect of the next signal ahead of the front. Which one that is, follows from the train's place; while
it stands at a turn-back, it is the first one of the leg behind it. The exit of a stop is shown, too, while it is held
red. Platform doors on the way are a signal: DOOR_STAT shows whether they are locked.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from railhil.bus.layout import FLAG_TRUE
from railhil.common.digits import text_beside_limit
from railhil.faults import parse_faults
from railhil.faults.words import ONLY
from railhil.record.trace import FloatArray
from railhil.systems.line.judge.course import stop_name
from railhil.systems.line.judge.run import LineRun
from railhil.systems.line.scenario.model import RouteSignal
from railhil.systems.line.scenario.protection_check import SIGNAL_OVERLAP_M, track_of
from railhil.wire.line import DoorStat, SignalAspect, StnInfo

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
    """The signals that the front passes red, in one go and by more than their overlap; so are platforms on the way.

    A signal that falls to red so near before the train that no emergency brake of the protection's model stops it does
    not count. Nor does a train that has been slower than the release speed behind the signal: by then it may be clear.
    """
    told = _aspects(run)
    for signal in sorted(run.scenario.signals, key=lambda one: (one.leg, one.position_m)):
        yield from _passed(run, told, signal, "a signal that showed red")
    for platform in _platforms(run):
        yield from _passed(
            run, _locks(run, platform), platform, "the beginning of a platform with doors shown unlocked"
        )


def _passed(run: LineRun, told: list[_Told], signal: RouteSignal, what: str) -> Iterator[str]:
    """Whether the front passes a signal that is shown red.

    :param what: the signal in words.
    """
    motion = run.motion
    beyond = np.flatnonzero(motion.position_m > signal.position_m)
    if not len(beyond) or not (shown := _shown_before(told, signal, float(motion.time_s[beyond[0]]))):
        return
    limit_m = signal.position_m + SIGNAL_OVERLAP_M
    slow = np.flatnonzero(motion.speed_mps[beyond] <= run.scenario.atp.v_release_mps)
    far_m = float(motion.position_m[beyond[: slow[0] if len(slow) else len(beyond)]].max(initial=-np.inf))
    if far_m > limit_m and _could_stop(run, shown[0]):
        yield (
            f"invariant 9: the front was at {text_beside_limit(far_m, limit_m, 2)} m, supervised location "
            f"{limit_m:.2f} m behind {what} from {shown[0].time_s:.2f} s on"
        )


def _platforms(run: LineRun) -> list[RouteSignal]:
    """The platforms with doors that the train passes, as signals: each ends the authority before it."""
    length_m = run.scenario.train.length_m
    return [
        RouteSignal(stop.position_m - length_m, 0.0, stop.leg)
        for stop in run.scenario.stops
        if stop.service == "pass" and stop.psd
    ]


def _locks(run: LineRun, platform: RouteSignal) -> list[_Told]:
    """What the record shows of the doors of a platform on the way; nothing if a fault changes the telegram."""
    port = DoorStat.PORT
    if port in run.forged:
        return []
    time_s = run.trace.times_s(port)
    red = (run.trace.raw(port, "PsdLocked") != FLAG_TRUE) & (run.trace.raw(port, "PsdPresent") == 0)
    columns = time_s, run.motion.positions_at(time_s), red
    return [
        _Told(at_s, at_m, platform, is_red)
        for at_s, at_m, is_red in zip(*(one.tolist() for one in columns), strict=True)
    ]


def left_towards_red(run: LineRun) -> Iterator[str]:
    """The first departure into a section while a signal of it, or the exit of the stop, shows red, before the departure
    and after it."""
    told, stops = _aspects(run), run.scenario.stops
    for section in run.scenario.sections:
        left = run.course.visits[section.departure].departed
        if left is None:
            return
        near = [one for one in told if abs(one.time_s - left.instant_s) < _PERIOD_S]
        before, after = ([one for one in near if (one.time_s <= left.instant_s) is first] for first in (True, False))
        if not before or not after or not (before[-1].is_red and after[0].is_red):
            continue
        until_m = stops[section.arrival].position_m
        shown = [_is_of_section(one.signal, section.leg, until_m) for one in (before[-1], after[0])]
        towards = "towards a red signal" if all(shown) else "while its exit was red"
        if all(shown) or all(_is_exit(run, one) for one in (before[-1], after[0])):
            name = stop_name(stops, section.departure)
            yield f"invariant 11: the train left stop {name} at {left.instant_s:.2f} s {towards}"
            return


def _is_of_section(signal: RouteSignal | None, leg: int, until_m: float) -> bool:
    return signal is not None and signal.leg == leg and signal.position_m <= until_m


def _is_exit(run: LineRun, told: _Told) -> bool:
    """Whether a red aspect is that of an exit: the next signal is clear by timetable, and no fault holds it."""
    if told.signal is None:
        return True
    number = run.scenario.signals.index(told.signal) + 1
    held = {fault.parameter(ONLY.name) for fault in parse_faults(run.scenario.faults) if fault.place.name == "signal"}
    return told.time_s >= told.signal.clear_s and number not in held


def _aspects(run: LineRun) -> list[_Told]:
    """What the record shows of signals; nothing if a fault changes the telegram."""
    signals, port = run.scenario.signals, StnInfo.PORT
    red = run.trace.raw(port, "SignalNext") == SignalAspect.RED
    if not red.any() or port in run.forged:
        return []
    time_s = run.trace.times_s(port)
    legs = _legs_ahead(run, time_s, run.trace.raw(port, "Leg"))
    places_m = run.motion.positions_at(time_s)
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
