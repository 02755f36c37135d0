"""The guard between mailboxes and law: accepts or refuses speed telegrams, and lets the watch limit the law's notch.

The checks of :mod:`railhil.controller_node.ato.speed_monitors` and :mod:`railhil.controller_node.ato.plausibility`
are called here; their results go into the watch as findings.
"""

from __future__ import annotations

from collections import Counter
from typing import Final

from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.lifesign import Life, LifeSign
from railhil.controller_node.ato.odometer import Odometer
from railhil.controller_node.ato.plausibility import POSITION_AGE_MAX_MS, SAMPLE_MS, Motion, MotionLimits, found
from railhil.controller_node.ato.safe_speed import SafeSpeed
from railhil.controller_node.ato.speed_monitors import (
    CHANNEL_WINDOW_MS,
    DISORDER_MAX_MS,
    DISORDER_MS,
    Debt,
    Latency,
)
from railhil.controller_node.ato.speed_watch import (
    LEVELS,
    Finding,
    Ladder,
    Reception,
    SpeedWatchState,
    command,
    observe,
    stronger,
)
from railhil.controller_node.ato.track_info import TrackInfo
from railhil.controller_node.ecan import BitCounter, MessageAge
from railhil.dbc import wire_contract
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlCause, SpeedSdt, TrkInfo, TrnSpeed, WatchLevel

#: Raw speeds beyond this are implausible for a train on this bench (0.1 mm/s, 150 m/s).
SPEED_MAX_01MMPS: Final = 1_500_000
_NS_PER_MS: Final = 1_000_000
_SAMPLE_NS: Final = SAMPLE_MS * _NS_PER_MS
# Looking up a member of an enum costs as much as a call on CPython 3.11, and this runs with every telegram.
_NEXT: Final = Life.NEXT
_GAP: Final = Life.GAP
_NO_TELEGRAM: Final = Reception.NONE
_GOOD: Final = Reception.GOOD


class Findings:
    """Present findings of the checks besides the age of the speed.

    :ivar by_check: the findings. :ivar strongest: the one that counts; None: there is none.
    """

    def __init__(self) -> None:
        self.by_check: dict[str, Finding] = {}
        self.strongest: Finding | None = None

    def note(self, check: str, cause: CtlCause, is_emergency: bool = False) -> None:
        """Note the present finding of a check, NONE if it has none."""
        if cause is CtlCause.NONE:
            if check not in self.by_check:
                return
            del self.by_check[check]
        else:
            level = WatchLevel.EMERGENCY if is_emergency else LEVELS[cause].level
            self.by_check[check] = Finding(level, cause)
        self.strongest = stronger(*self.by_check.values())


class Guard:
    """Feeds the watch with every TRN_SPEED telegram and asks it for the notch to send.

    :param counter: the counter that provides the time stamps; default: one at the bit rate of the port table.
    :param odometer: gets every accepted speed; when it loses the position, the train brakes. Default: an odometer that
        the law does not need. :param track: limit and grade, and the reaction to their age. Default: an object whose
        age is not watched.

    ``counters``: telegrams refused by cause (``duplicate``, ``out_of_order``, ``check_variable``, ``out_of_range``,
    ``speed_jump``) and ``gap`` for accepted ones after lost ones.
    """

    def __init__(
        self,
        scenario: Scenario,
        counter: BitCounter | None = None,
        odometer: Odometer | None = None,
        track: TrackInfo | None = None,
    ) -> None:
        self.counters: Counter[str] = Counter()
        #: Number of accepted telegrams.
        self.accepted = 0
        #: Speed of the last accepted telegram, None before the first.
        self.speed_01mmps: int | None = None
        self._ladder = Ladder.of(scenario)
        self._state = SpeedWatchState()
        self._life = LifeSign()
        self._counter = counter or BitCounter(wire_contract().bit_rate)
        self._age = MessageAge(self._counter)
        self._odometer = odometer or Odometer(scenario)
        #: The safe channel that must confirm every speed; None: the scenario has none.
        self.safe = SafeSpeed(scenario) if scenario.safety.sdt else None
        self._speed_ns = -1
        self._silence_ns = (self._ladder.hold_ms + 1) * _NS_PER_MS
        self._track = track or TrackInfo(scenario, watched=False)
        self._motion_limits = MotionLimits.of(scenario)
        self._motion = Motion(self._motion_limits)
        # A change up to this is plausible from one tick to the next.
        self._step_01mmps = self._motion_limits.step_01mmps
        self._changed_ns = 0
        # The last sample of the motion, with which the speeds after it are compared.
        self._sample_ns = -_SAMPLE_NS
        self._sample_01mmps = 0
        self._latency = Latency(scenario)
        self._poll_ns = self._latency.poll_ticks * scenario.timing.base_tick_ns
        # Up to when the ramp has gone; 0: no notch was sent yet.
        self._ramp_ns = 0
        # Each permitted bad telegram is paid back within the window divided by their number.
        permitted = scenario.watch.channel_bad_max
        self._channel = Debt(CHANNEL_WINDOW_MS, CHANNEL_WINDOW_MS * permitted, permitted)
        self._disorder = Debt(DISORDER_MS, DISORDER_MAX_MS)
        self._overruns_max = scenario.watch.overruns_max
        self._late = 0
        #: Whether it brakes because the law cannot run yet.
        self.waits = False
        self._findings = Findings()

    @property
    def level(self) -> WatchLevel:
        """Level of the reaction ladder."""
        return self._state.level

    @property
    def cause(self) -> CtlCause:
        """Cause for which the level was entered."""
        return self._state.cause

    def limit(self, track: TrkInfo, now_ns: int) -> None:
        """Take a TRK_INFO telegram that passed the traffic store."""
        self._track.take(track, now_ns)

    def period(self, is_late: bool) -> None:
        """A control period is computed; ``is_late``: periods before it were left out."""
        if not is_late and not self._late:
            return
        self._late = self._late + 1 if is_late else 0
        self._findings.note("overruns", CtlCause.OVERRUNS if self._late > self._overruns_max else CtlCause.NONE)

    def may_move(self, now_ns: int) -> bool:
        """Whether the train moves by its last speed, or this is older than SERVICE BRAKE allows; before the first speed
        its age counts from the node's beginning."""
        unconfirmed_ns = 0 if self.safe is None else self.safe.age_ns(now_ns)
        age_ns = max(self._age.ns(now_ns), unconfirmed_ns)
        return bool(self.speed_01mmps) or age_ns // _NS_PER_MS > self._ladder.service_brake_ms

    def wait(self, waits: bool) -> None:
        """The law cannot run yet, although the train may move: it brakes until the time of the run and a speed are
        known."""
        if waits is not self.waits:
            self.waits = waits
            self._findings.note("time", CtlCause.CLOCK if waits else CtlCause.NONE)

    def overrun(self, is_beyond: bool) -> None:
        """The train is beyond its end of authority by the balises, so the law's position is wrong: it brakes."""
        if is_beyond or self._findings.by_check:
            self._findings.note("overrun", CtlCause.POSITION_IMPLAUSIBLE if is_beyond else CtlCause.NONE)

    def speed(self, telegram: TrnSpeed, now_ns: int, stamp: int | None = None) -> None:
        """Take a TRN_SPEED telegram that passed the traffic store.

        :param stamp: when the mailbox received it, in bit times; default: now.
        """
        life = self._life.judge(telegram.life)
        if life is not _NEXT and not life.fresh:
            # A repeated or old telegram carries no new information: the age keeps growing.
            self.counters[life.value] += 1
            two_senders = False
            if life is Life.OUT_OF_ORDER:
                # The telegrams of two senders alternate; after a loss old ones come in a row.
                two_senders = not self._latency.doubt() and self._disorder.add(now_ns // _NS_PER_MS)
            self._observe(_NO_TELEGRAM, now_ns, None, LEVELS[CtlCause.TWO_SOURCES] if two_senders else None)
            return
        if life is _GAP:
            self.counters["gap"] += 1
        self._life.accept(telegram.life)
        self._latency.received(telegram.life)
        speed, last = telegram.speed_01mmps, self.speed_01mmps
        if telegram.check != CHECK_CORRECT:
            self._refuse("check_variable", Reception.BAD, now_ns)
            return
        if not 0 <= speed <= SPEED_MAX_01MMPS:
            self._refuse("out_of_range", Reception.BAD, now_ns)
            return
        if last is not None:
            change = speed - self._sample_01mmps
            if not -self._step_01mmps <= change <= self._step_01mmps and not self._motion_limits.fits(
                change, now_ns - self._sample_ns
            ):
                self._refuse("speed_jump", Reception.IMPLAUSIBLE, now_ns)
                return
            if speed != last:
                self._changed_ns = now_ns
        if now_ns - self._speed_ns >= self._silence_ns:
            # A silence ends a row of good telegrams, also one between two polls.
            self._state = self._state._replace(good_run=0)
        self.accepted += 1
        self.speed_01mmps = speed
        self._speed_ns = now_ns
        self._age.accept(self._counter.at(now_ns) if stamp is None else stamp)
        age_ns = self._age.ns(now_ns)
        self._odometer.speed(speed, now_ns - age_ns)
        if not -1 < now_ns - self._sample_ns < _SAMPLE_NS:
            self._sample(speed, now_ns)
        self._observe(_GOOD, now_ns, age_ns)

    def confirm(self, telegram: SpeedSdt, now_ns: int, tick: int | None) -> None:
        """Take a SPEED_SDT telegram that passed the traffic store; ``tick``: of the clock, None: not known yet."""
        assert self.safe is not None
        self.safe.take(telegram, now_ns, tick, self.speed_01mmps if self._speed_ns == now_ns else None)

    def _refuse(self, cause: str, telegram: Reception, now_ns: int) -> None:
        self.counters[cause] += 1
        too_many = self._channel.add(now_ns // _NS_PER_MS)
        self._observe(telegram, now_ns, None, LEVELS[CtlCause.CHANNEL_MONITOR] if too_many else None)

    def _sample(self, speed: int, now_ns: int) -> None:
        self._sample_ns, self._sample_01mmps = now_ns, speed
        position, position_ns = self._odometer.fitted
        age_ms = (now_ns - position_ns) // _NS_PER_MS
        place = position + speed * age_ms // 1000 if 0 <= age_ms <= POSITION_AGE_MAX_MS else None
        motion = self._motion
        motion.sample(now_ns, speed, self._state.code, self._track.grade_001permil(now_ns), self._changed_ns, place)
        if motion.is_suspicious or self._findings.by_check:
            self._findings.note("motion", *found(motion))

    def _observe(
        self, telegram: Reception, now_ns: int, age_ns: int | None = None, finding: Finding | None = None
    ) -> None:
        speed = self.speed_01mmps
        limit, track = self._track.limit_01mmps, self._track.finding(now_ns)
        if age_ns is None:
            age_ns = self._age.ns(now_ns)
        unconfirmed_ns = 0 if self.safe is None else self.safe.age_ns(now_ns)
        overspeed = speed is not None and limit is not None and self._ladder.is_overspeed(speed, limit)
        lost = self._odometer.lost(now_ns)
        other = self._findings.strongest
        if lost or finding or other or track:
            finding = stronger(finding, other, LEVELS[lost] if lost else None, track)
        is_confirmed = unconfirmed_ns <= age_ns
        age_ms = (age_ns if is_confirmed else unconfirmed_ns) // _NS_PER_MS
        state = observe(self._ladder, self._state, age_ms, telegram, speed == 0, overspeed, finding)
        if not is_confirmed and state.level is not self._state.level and state.cause is CtlCause.SPEED_AGE:
            state = state._replace(cause=CtlCause.SAFETY_CODE)
        self._state = state

    def look(self, now_ns: int) -> None:
        """Check the age of the last speed, at ``now_ns``."""
        self._observe(_NO_TELEGRAM, now_ns)

    def notch(self, law_code: int, now_ns: int) -> tuple[int, bool]:
        """Notch code (1/256) and emergency flag to send instead of the law's, at a poll at ``now_ns``."""
        # Before the first speed there is no life sign to compare the polls with.
        is_stale = self.speed_01mmps is not None and self._latency.polled()
        if is_stale or self._findings.by_check:
            self._findings.note("latency", CtlCause.SPEED_LATENCY if is_stale else CtlCause.NONE)
        # The overspeed is also checked in the tick of a good telegram: the speed limit may have arrived after it.
        self.look(now_ns)
        # A poll comes a period after the last one at the earliest. A clock that was behind, because speeds were late,
        # and catches up or is set right by TIME_SYNC, makes no step of the ramp larger.
        ramp_ns = max(now_ns, self._ramp_ns + self._poll_ns) if self._ramp_ns else now_ns
        ramp = self._ladder.ramp_codes(self._ramp_ns, ramp_ns)
        self._ramp_ns = ramp_ns
        self._state, code, emergency = command(self._ladder, self._state, law_code, ramp)
        return code, emergency
