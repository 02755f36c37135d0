"""Target curves below the train protection: ``ato_margin_m`` before its curves, ``ato_margin_kmh`` below its ceilings.

Read at a scenario's load.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import inf

import numpy as np

from railhil.common.errors import Finding, short_number
from railhil.scenarios.validation import Refuse
from railhil.systems.ato.scenario.model import Line, TargetCurve, Train
from railhil.systems.ato.scenario.target import target_of
from railhil.systems.line.braking.curve import DECELERATION_MIN_MPS2, GradeNotHeldError
from railhil.systems.line.braking.limits import Braking
from railhil.systems.line.braking.track import Levels, SpeedTarget, TrackLimits
from railhil.systems.line.scenario.model import LineScenario, Section
from railhil.systems.line.scenario.protection import Protection, protection_balises
from railhil.systems.line.scenario.sections import PROFILES, fastest_curve
from railhil.systems.line.scenario.statement import OVERSPEED

#: A red signal's supervised location lies this far behind it.
SIGNAL_OVERLAP_M = 20.0
#: A target curve is looked at this often.
_SAMPLE_S = 0.2
#: Indices of ``LimitCurve.times``.
_WARNING, _PERMITTED = 1, 2
#: Speeds are compared to this accuracy.
_ROUNDING_MPS = 1e-9
_KMH = 3.6


@dataclass(frozen=True, slots=True)
class _Sample:
    """A target curve at one instant, and the interval that the protection has of its position."""

    speed_mps: float
    accel_mps2: float
    least_m: float
    estimated_m: float
    most_m: float

    def gap_m(self, target: SpeedTarget, which: int) -> float:
        """Way to a limit of a target; infinite at speeds that it permits."""
        speed_mps = self.speed_mps
        if speed_mps <= target.floor.permitted_mps:
            return inf
        emergency, service = target.emergency, target.service
        gap_m = emergency.place_m(speed_mps, emergency.times[which], self.accel_mps2) - self.most_m
        if service is None:
            return gap_m
        return min(gap_m, service.place_m(speed_mps, service.times[which]) - self.estimated_m)

    def limit_mps(self, target: SpeedTarget, which: int, fastest_mps: float) -> float:
        """Speed of a limit before a target at this place."""
        emergency, service = target.emergency, target.service
        found_mps = emergency.speed_mps(self.most_m, emergency.times[which], fastest_mps, self.accel_mps2)
        if service is not None:
            found_mps = min(found_mps, service.speed_mps(self.estimated_m, service.times[which], fastest_mps))
        return max(found_mps, _level_mps(target.floor, which))


@lru_cache(maxsize=8)
def track_of(protection: Protection, train: Train, leg: Line) -> TrackLimits:
    """Ceilings and targets of a leg, made once for equal arguments.

    :raises GradeNotHeldError: the emergency brake does not hold a grade before a lower limit.
    """
    brake = protection.brake_model(train.gravity_mps2)
    braking = Braking(brake, brake.gradient_steps(leg.grade_permil, train.length_m), train.speed_limit_mps)
    return TrackLimits(braking, protection.increments_mps, leg.speed_limit_mps, train.length_m, train.speed_limit_mps)


def check_targets(line: LineScenario, refuse: Refuse) -> None:
    """Every target curve keeps the margins of the protection, and its brakes hold every grade on the way.

    Where regulation may shorten the running time, the fastest curve of each section stays below the warning, which cuts
    the traction off. Such a curve may pass the permitted speed, which the protection only tells
    (:func:`list_overspeeds`).

    :raises InputError: with the section, its worst place and speed, and the speed that is allowed there.
    """
    if not line.atp.enabled:
        return
    try:
        for leg in line.legs:
            track_of(line.atp, line.train, leg)
        for signal in line.signals:
            track = track_of(line.atp, line.train, line.legs[signal.leg])
            track.end_target(signal.position_m, signal.position_m + SIGNAL_OVERLAP_M, 0.0, 0.0)
        for section in line.sections:
            _check_target(line, section, section.target, "", refuse)
            for profile, curve in zip(PROFILES, section.profiles, strict=False):
                _check_target(line, section, curve, profile, refuse)
        for index, section in enumerate(line.sections if _shortens_times(line) else ()):
            _check_fastest(line, section, fastest_curve(line, index), refuse)
    except GradeNotHeldError as error:
        quantity = {"emergency": "A_safe", "service": "A_expected"}[error.brake]
        place, speed = short_number(round(error.position_m, 1)), short_number(round(error.speed_mps * _KMH, 1))
        raise refuse(
            ("atp",),
            Finding(f"{quantity} {error.found_mps2:.3f} m/s2 at {place} m, {speed} km/h"),
            f"above {DECELERATION_MIN_MPS2}: the {error.brake} brake does not hold this grade",
        ) from None


def list_overspeeds(line: LineScenario) -> tuple[str, ...]:
    """A sentence on the sections whose fastest curve passes the permitted speed; none if no section's does."""
    found = []
    for index, section in enumerate(line.sections if line.atp.enabled and _shortens_times(line) else ()):
        breach = _find_breach(line, section, fastest_curve(line, index), _PERMITTED)
        if breach is not None:
            over_kmh = (breach.speed_mps - breach.limit_mps) * _KMH
            found.append(f"{_name(line, section)} in {section.fastest_s:.1f} s ({over_kmh:.1f} km/h)")
    return (f"{OVERSPEED}{', '.join(found)}",) if found else ()


def _shortens_times(line: LineScenario) -> bool:
    """Whether a late train may take less time than a checked curve: a profile has a curve of its own."""
    return line.route.regulation == "retime"


def _name(line: LineScenario, section: Section) -> str:
    return f"{line.stops[section.departure].name} - {line.stops[section.arrival].name}"


@dataclass(frozen=True, slots=True)
class _Breach:
    """The place at which a curve is farthest above a limit."""

    speed_mps: float
    place_m: float
    limit_mps: float

    @property
    def found(self) -> Finding:
        """Speed and place in words."""
        return Finding(f"{self.speed_mps * _KMH:.1f} km/h at {self.place_m:.0f} m")


def _check_target(line: LineScenario, section: Section, curve: TargetCurve, profile: str, refuse: Refuse) -> None:
    """:param profile: whose curve it is; empty: the timetable's."""
    margin_mps = line.atp.ato_margin_mps
    breach = _find_breach(line, section, curve, _PERMITTED, line.atp.ato_margin_m, margin_mps)
    if breach is None:
        return
    allowed_mps = max(breach.limit_mps - margin_mps, 0.0)
    allowed = f"{allowed_mps * _KMH:.1f} km/h (atp: permitted {breach.limit_mps * _KMH:.1f} less ato_margin_kmh)"
    if profile:
        place = PROFILES.index(profile)
        reserve = f"route.profiles_percent[{place}], now {line.route.profiles_percent[place]:g}"
        allowed += f"; a larger reserve in {reserve}, makes it slower"
    name = f"target {_name(line, section)}{f', profile {profile}' if profile else ''}"
    raise refuse((name,), breach.found, allowed)


def _check_fastest(line: LineScenario, section: Section, curve: TargetCurve, refuse: Refuse) -> None:
    breach = _find_breach(line, section, curve, _WARNING)
    if breach is not None:
        name = f"target {_name(line, section)}, retimed to {section.fastest_s:.1f} s"
        allowed = (
            f"{breach.limit_mps * _KMH:.1f} km/h (atp: warning); a smaller route.generate.braking_max_mps2, or "
            "route.regulation = none or profiles, makes it slower"
        )
        raise refuse((name,), breach.found, allowed)


def _find_breach(
    line: LineScenario,
    section: Section,
    curve: TargetCurve,
    which: int,
    margin_m: float = 0.0,
    margin_mps: float = 0.0,
) -> _Breach | None:
    """Where a curve is farthest above a limit; None: it keeps the margins everywhere.

    :param margin_m: way to the limits before targets. ``margin_mps``: speed below the ceilings.
    """
    track = track_of(line.atp, line.train, line.legs[section.leg])
    targets = [_end_target(line, section, track), *track.lower]
    worst: _Breach | None = None
    for sample in _samples(line, section, curve):
        ceiling_mps = _level_mps(track.ceiling(sample.least_m, sample.most_m), which)
        broken = [ceiling_mps] if sample.speed_mps + margin_mps > ceiling_mps + _ROUNDING_MPS else []
        for target in targets:
            is_ahead = target.matters_from_m <= sample.most_m < target.place_m
            if is_ahead and sample.speed_mps > _level_mps(target.floor, which) and (
                sample.gap_m(target, which) < margin_m
            ):  # fmt: skip
                broken.append(sample.limit_mps(target, which, ceiling_mps))
        for limit_mps in broken:
            if worst is None or sample.speed_mps - limit_mps > worst.speed_mps - worst.limit_mps:
                worst = _Breach(sample.speed_mps, sample.estimated_m, limit_mps)
    return worst


def _level_mps(levels: Levels, which: int) -> float:
    return levels.permitted_mps if which == _PERMITTED else levels.warning_mps


def _end_target(line: LineScenario, section: Section, track: TrackLimits) -> SpeedTarget:
    stop, protection = line.stops[section.arrival], line.atp
    eoa_m, svl_m = stop.position_m + stop.eoa_overlap_m, stop.position_m + stop.svl_overlap_m
    return track.end_target(eoa_m, svl_m, protection.d_trip_m, protection.v_release_mps).target


def _samples(line: LineScenario, section: Section, curve: TargetCurve) -> Iterator[_Sample]:
    """A target curve until its stop; the interval is that behind the last balise, with an exact odometer."""
    protection, target = line.atp, target_of(curve)
    from_m, to_m = line.stops[section.departure].position_m, line.stops[section.arrival].position_m
    balises = line.legs[section.leg].balises
    own = protection_balises(protection.balise_spacing_m, balises, from_m, to_m)
    known_m = sorted({from_m, *(one.surveyed_m for one in (*balises, *own) if from_m < one.surveyed_m <= to_m)})
    time_s = np.arange(0.0, target.stop_time_s, _SAMPLE_S)
    speeds, accels = target.speed_mps(time_s).tolist(), target.accel_mps2(time_s).tolist()
    places = (target.position_m(time_s) + from_m).tolist()
    for speed_mps, accel_mps2, at_m in zip(speeds, accels, places, strict=True):
        balise_m = known_m[max(bisect_right(known_m, at_m) - 1, 0)]
        since_m, accuracy_m = at_m - balise_m, protection.balise_accuracy_m
        least_m = balise_m + since_m / (1.0 + protection.over_reading) - accuracy_m
        most_m = balise_m + since_m / (1.0 - protection.under_reading) + accuracy_m
        yield _Sample(max(speed_mps, 0.0), accel_mps2, least_m, at_m, most_m)
