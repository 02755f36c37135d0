"""What a line demands of a train: ceilings, and a target before each lower limit and before an end of authority.

Made once for a track, and once for an authority. A target tells from where on it can matter at all, so that a look at
a train far from every target costs a comparison.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace
from math import inf
from typing import NamedTuple

from railhil.scenarios.profiles import Profile, find_lowest
from railhil.systems.line.braking.limits import Braking, Increments, LimitCurve, interpolate, release_mps

#: Acceleration that no train of this kind exceeds. It only bounds the place from which an indication is looked for.
_ACCELERATION_MAX_MPS2 = 1.5
#: Curves are made up to this speed above the highest ceiling's emergency brake.
_SPEED_RESERVE_MPS = 3.0


@dataclass(frozen=True, slots=True)
class Levels:
    """Speeds at which the reactions begin, in m/s."""

    permitted_mps: float
    warning_mps: float
    service_mps: float
    emergency_mps: float

    @classmethod
    def above(cls, permitted_mps: float, increments: Increments) -> Levels:
        """Those of a ceiling, or the lowest ones before a lower limit."""
        return cls(
            permitted_mps,
            permitted_mps + interpolate(increments.warning, permitted_mps),
            permitted_mps + interpolate(increments.service, permitted_mps),
            permitted_mps + interpolate(increments.emergency, permitted_mps),
        )


_NOUGHT = Levels(0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class SpeedTarget:
    """A place with a lower speed.

    :ivar place_m: front at the lower limit, or end of authority.
    :ivar floor: lowest speeds that it demands: those at the target speed, 0 at an end of authority.
    :ivar emergency: limits from the EBD, for the most advanced position of the front.
    :ivar service: limits from the SBD, for its estimated position; None before a lower limit.
    :ivar matters_from_m: before this place no train reaches the indication.
    """

    place_m: float
    floor: Levels
    emergency: LimitCurve
    service: LimitCurve | None
    matters_from_m: float


class Release(NamedTuple):
    """A release speed, and the places from which only this one is supervised: ``from_max_m`` counts for the most
    advanced position of the front, ``from_m`` for the estimated one; both are infinite without a release speed."""

    speed_mps: float
    from_max_m: float
    from_m: float


class EndTarget:
    """An end of authority.

    :param trip_m: from the end of authority to the place at which a train that passes it trips at the latest.
    :param most_mps: largest release speed.
    """

    def __init__(
        self,
        eoa_m: float,
        emergency: LimitCurve,
        service: LimitCurve,
        matters_from_m: float,
        trip_m: float,
        most_mps: float,
    ) -> None:
        self.target = SpeedTarget(eoa_m, _NOUGHT, emergency, service, matters_from_m)
        self._emergency, self._service = emergency, service
        self.release = self._find_release(trip_m, most_mps)
        #: A train at this place that brakes from the release speed stands before the supervised location.
        self._reach_m = emergency.place_m(self.release.speed_mps, 0.0) - eoa_m

    def release_within(self, width_m: float) -> Release:
        """The release speed for an interval of the position of a width.

        A train trips when it has passed the end of authority for certain: then its front may be the width behind it.
        """
        if width_m <= self._reach_m or self.release.speed_mps <= 0.0:
            return self.release
        return self._find_release(width_m, self.release.speed_mps)

    def _find_release(self, trip_m: float, most_mps: float) -> Release:
        emergency, service = self._emergency, self._service
        speed_mps = release_mps(emergency, self.target.place_m, trip_m, most_mps)
        if speed_mps <= 0.0:
            return Release(0.0, inf, inf)
        from_max_m = emergency.place_m(speed_mps, emergency.times.service_s)
        return Release(speed_mps, from_max_m, service.place_m(speed_mps, service.times.service_s))


class TrackLimits:
    """Ceilings over the position of the front, and the targets before lower ones.

    :ivar ceilings: lowest limit under the whole train, and the train's own, by position of its front.
    :ivar lower: the targets, in order of their places.
    :param braking: its ``fastest_mps`` does not count; the curves go beyond the highest ceiling.
    :raises GradeNotHeldError: the emergency brake does not hold a grade before a lower limit.
    """

    def __init__(
        self,
        braking: Braking,
        increments: Increments,
        speed_limit_mps: Profile,
        length_m: float,
        train_limit_mps: float,
    ) -> None:
        self.ceilings = find_lowest(speed_limit_mps, length_m, train_limit_mps)
        self._from_m = tuple(at_m for at_m, _ in self.ceilings)
        self._levels = tuple(Levels.above(limit_mps, increments) for _, limit_mps in self.ceilings)
        highest_mps = max(levels.emergency_mps for levels in self._levels)
        self.braking = replace(braking, fastest_mps=highest_mps + _SPEED_RESERVE_MPS)
        self.lower = tuple(
            self._lower_target(at_m, floor)
            for (at_m, floor), before in zip(
                zip(self._from_m[1:], self._levels[1:], strict=True), self._levels[:-1], strict=True
            )
            if floor.permitted_mps < before.permitted_mps
        )

    def _lower_target(self, at_m: float, floor: Levels) -> SpeedTarget:
        limits = self.braking.emergency_limits(at_m, floor.emergency_mps, floor.permitted_mps)
        return SpeedTarget(at_m, floor, limits, None, self._matters_from_m(limits))

    def ceiling(self, from_m: float, to_m: float) -> Levels:
        """Levels of the lowest ceiling with the front between two places."""
        first = max(bisect_right(self._from_m, from_m) - 1, 0)
        lowest = self._levels[first]
        for row in range(first + 1, len(self._from_m)):
            if self._from_m[row] > to_m:
                break
            if self._levels[row].permitted_mps < lowest.permitted_mps:
                lowest = self._levels[row]
        return lowest

    def end_target(self, eoa_m: float, svl_m: float, trip_m: float, release_most_mps: float) -> EndTarget:
        """The target of an authority that ends at ``eoa_m``, with a supervised location ``svl_m``.

        :raises GradeNotHeldError: a brake does not hold a grade on the way.
        """
        emergency, service = self.braking.emergency_limits(svl_m, 0.0, 0.0), self.braking.service_limits(eoa_m)
        matters_from_m = self._matters_from_m(emergency, service)
        return EndTarget(eoa_m, emergency, service, matters_from_m, trip_m, release_most_mps)

    def _matters_from_m(self, *curves: LimitCurve) -> float:
        fastest_mps = self.braking.fastest_mps
        return min(
            curve.place_m(fastest_mps, curve.times.indication_s, accel)
            for curve in curves
            for accel in (0.0, _ACCELERATION_MAX_MPS2)
        )
