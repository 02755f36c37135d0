"""The controller's watch of its speed telegrams: a reaction ladder, as a pure state machine on whole numbers.

============== ================================================= ============================= =====================
level          entered when (age: of the last accepted telegram)  notch sent                    left on
============== ================================================= ============================= =====================
NORMAL         age <= hold                                       the law's                     -
HOLD           age > hold, or a bad telegram                     the last one, or less         1 good telegram
                                                                 traction if the law asks
TRACTION_CUT   age > traction cut, 3 bad in the last 10 with     at most 0, braking kept       5 good in a row
               this one, or a finding
SERVICE_BRAKE  age > service brake, or a finding                 ramp to the full service      standstill (see below),
                                                                 brake, jerk limited           or 10 good in a row
EMERGENCY      age > emergency while moving, overspeed, or a     full brake, emergency flag    never in a run
               finding
============== ================================================= ============================= =====================

A level is entered at once and only upwards; leaving a level leads to NORMAL or to the level that the current state
demands. A standstill is told by the telegrams themselves, so it ends no SERVICE_BRAKE that was entered because there
are too many bad ones or two senders (:data:`DOUBTED`), and with 3 bad in the last 10 it leads to TRACTION_CUT.

A bad telegram, an age above hold or a finding ends "in a row". After a level above HOLD the notch returns on the ramp
of the service brake, so that releasing the brake never jumps into traction.

A finding is the demand of another check while its condition lasts; levels and causes are in :data:`LEVELS`.

Thresholds are scenario data (:class:`railhil.systems.ato.scenario.model.WatchLimits`); the counts are our own and
follow common practice for vital data on a train bus.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Final, NamedTuple

from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlCause, WatchLevel

GOOD_AFTER_TRACTION_CUT: Final = 5
GOOD_AFTER_SERVICE_BRAKE: Final = 10
#: Number of bad telegrams among the last :data:`RECENT` that cuts traction.
BAD_FOR_TRACTION_CUT: Final = 3
RECENT = 10
#: How fast the service brake builds up and is released, m/s3.
SERVICE_BRAKE_JERK_MPS3: Final = 0.75

_CODES_PER_NOTCH: Final = 256
_NS_PER_S: Final = 1_000_000_000
_RECENT_MASK: Final = (1 << RECENT) - 1


class Reception(IntEnum):
    """Reception of TRN_SPEED since the last observation."""

    NONE = 0
    GOOD = 1
    BAD = 2
    #: A speed that no train can have reached since the last one.
    IMPLAUSIBLE = 3


# Looking up a member of an enum costs as much as a call on CPython 3.11, and the watch checks every telegram.
_NORMAL: Final = WatchLevel.NORMAL
_HOLD: Final = WatchLevel.HOLD
_TRACTION_CUT: Final = WatchLevel.TRACTION_CUT
_SERVICE_BRAKE: Final = WatchLevel.SERVICE_BRAKE
_EMERGENCY: Final = WatchLevel.EMERGENCY
_NO_TELEGRAM: Final = Reception.NONE
_GOOD: Final = Reception.GOOD
_BAD: Final = Reception.BAD


class Finding(NamedTuple):
    """Demand of a check besides the age of the speed: the level and its cause."""

    level: WatchLevel
    cause: CtlCause


#: The findings of the other checks, by cause. A brake that does not answer is an emergency when more brake has not
#: helped.
LEVELS = {
    cause: Finding(level, cause)
    for level, causes in (
        (
            WatchLevel.TRACTION_CUT,
            (CtlCause.SPEED_IMPLAUSIBLE, CtlCause.SPEED_LATENCY, CtlCause.OVERRUNS),
        ),
        (
            WatchLevel.SERVICE_BRAKE,
            (
                CtlCause.POSITION_LOST,
                CtlCause.POSITION_IMPLAUSIBLE,
                CtlCause.CHANNEL_MONITOR,
                CtlCause.CLOCK,
                CtlCause.TWO_SOURCES,
                CtlCause.BRAKE_NOT_ANSWERING,
            ),
        ),
        (WatchLevel.EMERGENCY, (CtlCause.RUNAWAY,)),
    )
    for cause in causes
}

#: Causes for which the telegrams that tell of a standstill are doubted.
DOUBTED: Final = frozenset((CtlCause.CHANNEL_MONITOR, CtlCause.TWO_SOURCES))


def stronger(*findings: Finding | None) -> Finding | None:
    """The finding of the highest level, with the smallest cause among several; None for none."""
    return max((one for one in findings if one), key=lambda one: (one.level, -one.cause), default=None)


class Ladder(NamedTuple):
    """Thresholds of one scenario, as whole numbers: ms, notch codes (1/256 notch), codes per second, 0.1 mm/s."""

    hold_ms: int
    traction_cut_ms: int
    service_brake_ms: int
    emergency_ms: int
    service_code: int
    full_code: int
    ramp_code_per_s: int
    overspeed_margin_01mmps: int

    @classmethod
    def of(cls, scenario: Scenario) -> Ladder:
        """Ladder of a scenario; the service brake is the notch that gives the train's service deceleration."""
        limits, train = scenario.watch, scenario.train
        codes_per_mps2 = _CODES_PER_NOTCH * train.inertial_mass_kg / train.force_per_notch_n
        full_code = round(train.notch_max * _CODES_PER_NOTCH)
        return cls(
            limits.hold_ms,
            limits.traction_cut_ms,
            limits.service_brake_ms,
            limits.emergency_ms,
            min(full_code, round(train.service_braking_mps2 * codes_per_mps2)),
            full_code,
            round(SERVICE_BRAKE_JERK_MPS3 * codes_per_mps2),
            round(limits.overspeed_margin_mps * 1e4),
        )

    def ramp_codes(self, since_ns: int, now_ns: int) -> int:
        """Change by the ramp in this time. Both ends are rounded, so that over many short times nothing is lost."""
        return self.ramp_code_per_s * now_ns // _NS_PER_S - self.ramp_code_per_s * since_ns // _NS_PER_S

    def is_overspeed(self, speed_01mmps: int, limit_01mmps: int) -> bool:
        """True when the measured speed is above the limit by more than the margin."""
        return speed_01mmps > limit_01mmps + self.overspeed_margin_01mmps


class SpeedWatchState(NamedTuple):
    """Memory of the watch.

    ``good_run`` good telegrams in a row (counted up to the largest number needed), ``recent`` the last telegrams,
    newest in bit 0, 1 = bad, ``code`` the notch last sent (1/256), ``kept_code`` the braking to keep during
    TRACTION_CUT (<= 0), ``returning`` while the notch returns on the ramp, ``cause`` for which the level was entered.
    """

    level: WatchLevel = WatchLevel.NORMAL
    good_run: int = 0
    recent: int = 0
    code: int = 0
    kept_code: int = 0
    returning: bool = False
    cause: CtlCause = CtlCause.NONE


def observe(
    ladder: Ladder,
    state: SpeedWatchState,
    age_ms: int,
    telegram: Reception,
    standstill: bool,
    overspeed: bool,
    finding: Finding | None,
) -> SpeedWatchState:
    """State after one observation, made at every telegram, and at every tick without one.

    :param age_ms: age of the last accepted telegram, 0 with a good one.
    :param standstill: according to that telegram.
    :param finding: the strongest of the other checks, None for none.
    """
    recent = state.recent
    if (
        state.level is _NORMAL
        and age_ms <= ladder.hold_ms
        and not (overspeed or finding)
        and (
            telegram is _NO_TELEGRAM
            or (recent == 0 and state.good_run == GOOD_AFTER_SERVICE_BRAKE and telegram is _GOOD)
        )
    ):
        # A channel that has been healthy for some time: nothing changes. This is nearly always the case.
        return state
    bad = telegram >= _BAD
    if telegram is not _NO_TELEGRAM:
        recent = (recent << 1 | bad) & _RECENT_MASK
    good_run = state.good_run
    if bad or finding or age_ms > ladder.hold_ms:
        good_run = 0
    elif telegram is _GOOD:
        good_run = min(good_run + 1, GOOD_AFTER_SERVICE_BRAKE)
    stands = standstill and state.cause not in DOUBTED
    level = _NORMAL if _may_leave(state.level, good_run, stands) else state.level
    if overspeed:
        demanded, cause = _EMERGENCY, CtlCause.OVERSPEED
    else:
        # The count of bad ones matters at a bad telegram, and where a standstill ends SERVICE_BRAKE: an old burst must
        # not cut traction again after a good run.
        counts = bad or (state.level is _SERVICE_BRAKE and good_run < GOOD_AFTER_TRACTION_CUT)
        cuts = counts and recent.bit_count() >= BAD_FOR_TRACTION_CUT
        # The speed telegrams are named if two demands are equal.
        demanded, cause = _by_telegrams(ladder, cuts, age_ms, telegram, standstill)
        if finding is not None and finding.level > demanded:
            demanded, cause = finding
    level = max(level, demanded)
    if level is state.level:
        cause = state.cause
    kept_code = state.kept_code
    if level is _TRACTION_CUT and state.level is not _TRACTION_CUT:
        kept_code = min(state.code, 0)
    return state._replace(level=level, good_run=good_run, recent=recent, kept_code=kept_code, cause=cause)


def _may_leave(level: WatchLevel, good_run: int, standstill: bool) -> bool:
    if level is _EMERGENCY:
        # There is no reset on this bench.
        return False
    if level is _SERVICE_BRAKE:
        return standstill or good_run >= GOOD_AFTER_SERVICE_BRAKE
    if level is _TRACTION_CUT:
        return good_run >= GOOD_AFTER_TRACTION_CUT
    return good_run >= 1


def _by_telegrams(
    ladder: Ladder, cuts: bool, age_ms: int, telegram: Reception, standstill: bool
) -> tuple[WatchLevel, CtlCause]:
    """Level demanded by the speed telegrams alone, and its cause.

    :param cuts: too many of the last ones were bad.
    """
    if age_ms > ladder.service_brake_ms:
        emergency = age_ms > ladder.emergency_ms and not standstill
        level = _EMERGENCY if emergency else _SERVICE_BRAKE
        return level, CtlCause.SPEED_AGE
    if age_ms > ladder.traction_cut_ms:
        return _TRACTION_CUT, CtlCause.SPEED_AGE
    refused = CtlCause.SPEED_IMPLAUSIBLE if telegram is Reception.IMPLAUSIBLE else CtlCause.BAD_TELEGRAMS
    if cuts:
        return _TRACTION_CUT, refused
    if age_ms > ladder.hold_ms:
        return _HOLD, CtlCause.SPEED_AGE
    if telegram >= _BAD:
        return _HOLD, refused
    return _NORMAL, CtlCause.NONE


def command(ladder: Ladder, state: SpeedWatchState, law_code: int, ramp: int) -> tuple[SpeedWatchState, int, bool]:
    """The notch to send instead of the law's.

    :param law_code: the law's last result, 1/256 notch, inside the notch range.
    :param ramp: change by the ramp since the last notch was sent (:meth:`Ladder.ramp_codes`).
    :returns: state, notch code, emergency brake flag.
    """
    last = state.code
    level, returning = state.level, state.returning or state.level >= _TRACTION_CUT
    if level is _EMERGENCY:
        code = -ladder.full_code
    elif level is _SERVICE_BRAKE:
        # If the law or a kept notch brakes harder than the service brake, that notch is kept.
        # Traction must not continue while the ramp begins: the ladder may reach this level from any other in one step.
        braking = min(last, 0)
        code = min(law_code, max(-ladder.service_code, braking - ramp), braking)
    elif level is _TRACTION_CUT:
        code = min(law_code, state.kept_code)
    elif level is _HOLD:
        code = last if last < 0 else min(max(law_code, 0), last)
    else:
        code = min(law_code, last + ramp) if returning else law_code
        returning = code < law_code
    # A negative ramp ends at the full brake, too.
    code = max(code, -ladder.full_code)
    if code != last or returning != state.returning:
        state = state._replace(code=code, returning=returning)
    return state, code, level is _EMERGENCY
