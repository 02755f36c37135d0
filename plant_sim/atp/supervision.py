"""Speed and position against ceilings and targets: one look of the protection.

A limit from an EBD is compared with the most advanced position of the front, one from an SBD with the estimated
position; of several targets the first to be reached counts. Before a lower limit no limit is below those of its speed.
"""

from __future__ import annotations

from math import inf

from railhil.plant_sim.atp.position import PositionInterval
from railhil.plant_sim.atp.readings import CEILING, NONE, RELEASE, TARGET
from railhil.systems.line.braking.track import EndTarget, Levels, Release, SpeedTarget, TrackLimits

#: The highest limit that a speed exceeds.
NOTHING, ABOVE_PERMITTED, ABOVE_WARNING, ABOVE_SERVICE, ABOVE_EMERGENCY = range(5)

#: Indices of ``LimitCurve.times``.
_SERVICE, _WARNING, _PERMITTED, _INDICATION = range(4)
#: Two limits usually differ by about this speed: where the search for the next one begins.
_LIMITS_APART_MPS = 0.5


class Supervision:
    """Looks at one train on one track with one authority.

    :ivar end: the end of authority; None before the first one.
    :ivar excess: the highest limit that the speed exceeds (:data:`NOTHING` to :data:`ABOVE_EMERGENCY`).
    :ivar cause: what demands that limit.
    :ivar indicated: the targets whose indication has been reached.
    :ivar release: the release speed for the present interval; None before the first authority.
    :ivar is_released: only the release speed is supervised before the end of authority.
    :ivar is_tripped: the front has passed the end of authority for certain.
    :ivar levels: the speeds of the limits here.
    :ivar lowest_target: the target that demands them; None: the ceiling does.
    """

    __slots__ = (
        "_ahead", "_end_cause", "_near", "_track", "cause", "end", "excess", "indicated", "is_released", "is_tripped",
        "levels", "lowest_target", "release",
    )  # fmt: skip

    def __init__(self, track: TrackLimits) -> None:
        self._track = track
        self._ahead = sorted(track.lower, key=lambda target: target.matters_from_m)
        self._near: list[SpeedTarget] = []
        self._end_cause = TARGET
        self.end: EndTarget | None = None
        self.indicated: list[SpeedTarget] = []
        self.excess, self.cause = NOTHING, NONE
        self.release: Release | None = None
        self.is_released = self.is_tripped = False
        self.levels = Levels(0.0, 0.0, 0.0, 0.0)
        self.lowest_target: SpeedTarget | None = None

    def authorise(self, end: EndTarget, cause: int) -> None:
        """Take another end of authority, and the cause of what it demands."""
        if self.end is not None:
            self._forget(self.end.target)
        self.end, self._end_cause = end, cause

    def look(self, place: PositionInterval, speed_mps: float, accel_mps2: float) -> None:
        """Find which limits a speed exceeds at a place, and the limits there."""
        least_m, most_m = place.least_m, place.most_m
        levels = self._track.ceiling(least_m, most_m)
        self.excess, self.cause = _find_excess(levels, speed_mps), CEILING
        self.lowest_target = None
        while self._ahead and self._ahead[0].matters_from_m <= most_m:
            self._near.append(self._ahead.pop(0))
        for target in tuple(self._near):
            if target.place_m < least_m:
                self._near.remove(target)
                self._forget(target)
            elif target.place_m > most_m:
                levels = self._look_at(target, TARGET, levels, place, speed_mps, accel_mps2)
        end = self.end
        if end is not None:
            self.is_tripped = least_m > end.target.place_m
            self.release = release = end.release_within(most_m - least_m)
            self.is_released = most_m >= release.from_max_m or place.estimated_m >= release.from_m
            if self.is_released:
                levels = self._look_at_release(end, release.speed_mps, speed_mps)
            elif end.target.matters_from_m <= most_m:
                levels = self._look_at(end.target, self._end_cause, levels, place, speed_mps, accel_mps2)
        if self.excess == NOTHING:
            self.cause = NONE
        self.levels = levels

    def _forget(self, target: SpeedTarget) -> None:
        if target in self.indicated:
            self.indicated.remove(target)

    def _look_at_release(self, end: EndTarget, released_mps: float, speed_mps: float) -> Levels:
        self.lowest_target = end.target
        if speed_mps > released_mps:
            self.excess, self.cause = ABOVE_EMERGENCY, RELEASE
        return Levels(released_mps, released_mps, released_mps, released_mps)

    def _look_at(
        self,
        target: SpeedTarget,
        cause: int,
        levels: Levels,
        place: PositionInterval,
        speed_mps: float,
        accel_mps2: float,
    ) -> Levels:
        """Judge the speed before one target; the lower of its limits and the given ones."""
        emergency, service = target.emergency, target.service
        to_emergency_m = emergency.place_m(speed_mps, 0.0, accel_mps2) - place.most_m
        to_service_m = inf if service is None else service.place_m(speed_mps, 0.0) - place.estimated_m

        def is_past(which: int) -> bool:
            return to_emergency_m < speed_mps * emergency.times[which] or (
                service is not None and to_service_m < speed_mps * service.times[which]
            )

        floor = target.floor
        excess = NOTHING
        if speed_mps > floor.permitted_mps and is_past(_INDICATION):
            if target not in self.indicated:
                self.indicated.append(target)
            if speed_mps > floor.emergency_mps and to_emergency_m < 0.0:
                excess = ABOVE_EMERGENCY
            elif speed_mps > floor.service_mps and is_past(_SERVICE):
                excess = ABOVE_SERVICE
            elif speed_mps > floor.warning_mps and is_past(_WARNING):
                excess = ABOVE_WARNING
            elif is_past(_PERMITTED):
                excess = ABOVE_PERMITTED
        if excess > self.excess:
            self.excess, self.cause = excess, cause
        return self._lower_levels(target, levels, place, speed_mps, accel_mps2)

    def _lower_levels(
        self, target: SpeedTarget, levels: Levels, place: PositionInterval, speed_mps: float, accel_mps2: float
    ) -> Levels:
        emergency, service, floor = target.emergency, target.service, target.floor
        most_m, estimated_m = place.most_m, place.estimated_m
        fastest_mps = levels.emergency_mps
        if emergency.place_m(fastest_mps, emergency.times[_PERMITTED], accel_mps2) >= most_m and (
            service is None or service.place_m(fastest_mps, service.times[_PERMITTED]) >= estimated_m
        ):
            return levels

        def speed_mps_of(which: int, most_mps: float, near_mps: float) -> float:
            """From the EBD, and from the SBD where it demands less."""
            found_mps = emergency.speed_mps(most_m, emergency.times[which], most_mps, accel_mps2, near_mps)
            if service is None or service.place_m(found_mps, service.times[which]) >= estimated_m:
                return found_mps
            return service.speed_mps(estimated_m, service.times[which], found_mps, 0.0, near_mps)

        ebi_mps = emergency.speed_mps(most_m, 0.0, fastest_mps, accel_mps2, speed_mps)
        sbi_mps = speed_mps_of(_SERVICE, ebi_mps, ebi_mps - _LIMITS_APART_MPS)
        warning_mps = speed_mps_of(_WARNING, sbi_mps, sbi_mps - _LIMITS_APART_MPS)
        permitted_mps = speed_mps_of(_PERMITTED, warning_mps, warning_mps - _LIMITS_APART_MPS)
        found = Levels(
            min(max(permitted_mps, floor.permitted_mps), levels.permitted_mps),
            min(max(warning_mps, floor.warning_mps), levels.warning_mps),
            min(max(sbi_mps, floor.service_mps), levels.service_mps),
            min(max(ebi_mps, floor.emergency_mps), levels.emergency_mps),
        )
        if found.permitted_mps < levels.permitted_mps:
            self.lowest_target = target
        return found


def _find_excess(levels: Levels, speed_mps: float) -> int:
    if speed_mps <= levels.permitted_mps:
        return NOTHING
    if speed_mps > levels.emergency_mps:
        return ABOVE_EMERGENCY
    if speed_mps > levels.service_mps:
        return ABOVE_SERVICE
    return ABOVE_WARNING if speed_mps > levels.warning_mps else ABOVE_PERMITTED
