"""Plausibility check of TRN_POS: the odometer compared with dead reckoning from the speed, in integers.

The dead-reckoned position integrates the accepted speeds and follows the odometer with the time constant
``FOLLOWING_NS``; a telegram is plausible if its odometer is nearer to it than::

    TOLERANCE_M + resolution + speed * hold age + possible error of the dead reckoning

The last part grows with time (resolution and noise of the speed) and with the age of the speed (``ACCEL_MAX_MPS2``) and
shrinks with each plausible telegram. The law gets the odometer itself while telegrams arrive on time and are plausible;
otherwise it gets the dead-reckoned position until ``GOOD_RUN`` plausible telegrams in a row. A telegram that is late by
no more than the hold age ends no row: the node tells its time by TRN_SPEED, which may be as late without a reaction.
After ``RECKONING_MAX_NS`` of dead reckoning the position is lost. Only plausible telegrams restore the odometer: an
odometer that has jumped and then continues evenly stays wrong. Implausible positions for that long contradict the
speed, which every law uses: the position is then implausible also for a law that needs none.
"""

from __future__ import annotations

from collections import Counter
from typing import Final

from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.lifesign import Life, LifeSign
from railhil.bus.schedule import Schedule
from railhil.controller_node.ato.control_loop import POSITION_MAX_01MM
from railhil.systems.ato.scenario.model import DISTANCE_MAX_M, POSITION_AGE_MAX_MS, Scenario
from railhil.wire.ato import CtlCause, TrnPos

#: Longest time on dead reckoning (reaction to the loss of position only: 1 s, then service brake).
RECKONING_MAX_NS: Final = POSITION_AGE_MAX_MS * 1_000_000
#: Plausible telegrams in a row before the odometer is used again; the same number as ends the service brake.
GOOD_RUN: Final = 10
#: Time constant with which the dead-reckoned position follows the odometer: a slow drift causes an error of the drift
#: over this time.
FOLLOWING_NS: Final = 1_000_000_000
#: Tolerance for a standing train with perfect sensors.
TOLERANCE_M: Final = 0.1
#: Largest acceleration or deceleration of any train: adhesion of steel on steel allows 0.2 g.
ACCEL_MAX_MPS2: Final = 2.0

#: Readings of the odometer beyond this are taken as this (0.1 mm); no scenario has a longer run.
READING_MAX_01MM: Final = round(DISTANCE_MAX_M * 1e4)

_NS_PER_S: Final = 1_000_000_000
_NOT_LOST: Final = CtlCause.NONE
_NS_PER_MS: Final = 1_000_000
_NEXT: Final = Life.NEXT


class Odometer:
    """Position for the law, and whether it can be relied upon.

    Dead-reckoned lengths are in 1e-13 m (0.1 mm/s times ns): no product is rounded, and the difference of
    two of 400 km fits into 64 bits. Only the law's input is limited to the 200 km of its formats.

    ``counters``: TRN_POS telegrams refused, by cause: ``position_duplicate``, ``position_out_of_order``,
    ``position_check`` (check variable not correct), ``position_jump`` (not plausible).

    :param task_period_ns: time between two readings of the mailboxes, by which a telegram may be older.
    :param needed: False for a law that does not use the position; a silent port is then no loss.
    """

    def __init__(self, scenario: Scenario, task_period_ns: int = 0, *, needed: bool = False) -> None:
        timing, sensors = scenario.timing, scenario.sensors
        schedule = Schedule.from_contract(
            timing.base_tick_ns, timing.port_period_ns, scenario.installed_system.contract
        )
        self.counters: Counter[str] = Counter()
        #: Number of plausible telegrams.
        self.accepted = 0
        self._needed = needed
        self._in_time_ns = schedule.ticks(TrnPos.PORT) * timing.base_tick_ns + task_period_ns
        self._exact = round((TOLERANCE_M + sensors.odometer_lsb_m) * 1e4) * _NS_PER_S
        self._hold_ns = scenario.watch.hold_ms * _NS_PER_MS
        # A longer silence ends a row.
        self._silent_ns = self._in_time_ns + self._hold_ns
        self._speed_error_01mmps = round((sensors.speed_lsb_mps / 2 + sensors.speed_noise_sigma_mps) * 1e4)
        self._accel_01mmps2 = round(ACCEL_MAX_MPS2 * 1e4)
        self._life = LifeSign()
        self._begun = False
        self._heard = False
        self._run = GOOD_RUN
        # The last plausible telegram (0.1 mm), its arrival, and when the odometer was last used.
        self._reading_01mm = 0
        self._fitted_ns = 0
        self._trusted_ns = 0
        # When the first implausible telegram since then arrived, and the last one.
        self._jumped_ns: int | None = None
        self._jumping_ns = 0
        # Dead-reckoned position, its possible error and time; the last speed and its time.
        self._place = 0
        self._slack = 0
        self._at_ns = 0
        self._speed_01mmps = 0
        self._speed_ns = 0

    def speed(self, speed_01mmps: int, at_ns: int) -> None:
        """Take an accepted speed, measured at ``at_ns``."""
        if not self._begun:
            self._begun = True
            self._at_ns = self._speed_ns = self._fitted_ns = self._trusted_ns = at_ns
            self._speed_01mmps = speed_01mmps
        self._reckon(at_ns)
        # The speed changed linearly between the readings: half of the difference is still missing.
        if at_ns > self._speed_ns:
            self._place += (speed_01mmps - self._speed_01mmps) * (at_ns - self._speed_ns) // 2
        self._speed_01mmps, self._speed_ns = speed_01mmps, at_ns

    def position(self, telegram: TrnPos, at_ns: int) -> None:
        """Take a TRN_POS telegram that passed the traffic store, received at ``at_ns``."""
        life = self._life.judge(telegram.life)
        if life is not _NEXT and not life.fresh:
            # No new information: the odometer keeps ageing.
            self.counters[f"position_{life.value}"] += 1
            return
        self._life.accept(telegram.life)
        if telegram.check != CHECK_CORRECT:
            self.counters["position_check"] += 1
            self._run = 0
            return
        self._reckon(at_ns)
        reading_01mm = _within(telegram.odometer_mm * 10, READING_MAX_01MM)
        if not self._heard or not self._begun:
            # The first telegram, or none has told a speed yet: there is nothing to compare it with.
            self._heard = True
            self._place, self._fitted_ns = reading_01mm * _NS_PER_S, at_ns
        off = reading_01mm * _NS_PER_S - self._place
        if abs(off) > self._tolerance():
            self.counters["position_jump"] += 1
            self._run = 0
            if self._jumped_ns is None or at_ns - self._jumping_ns > RECKONING_MAX_NS:
                self._jumped_ns = at_ns
            self._jumping_ns = at_ns
            return
        self.accepted += 1
        since_ns = max(at_ns - self._fitted_ns, 0)
        share_ns = min(since_ns, FOLLOWING_NS)
        self._place += off * share_ns // FOLLOWING_NS
        self._slack -= self._slack * share_ns // FOLLOWING_NS
        if since_ns > self._silent_ns:
            self._run = 0
        self._run = min(self._run + 1, GOOD_RUN)
        self._reading_01mm, self._fitted_ns = reading_01mm, at_ns
        if self._run == GOOD_RUN:
            self._trusted_ns = at_ns
            self._jumped_ns = None

    @property
    def fitted(self) -> tuple[int, int]:
        """The last plausible odometer reading (0.1 mm) and its arrival (ns); 0 and the beginning before the first."""
        return self._reading_01mm, self._fitted_ns

    def at(self, now_ns: int) -> int:
        """Position for the law in 0.1 mm: the odometer, or the dead-reckoned position."""
        if self._heard and self._run == GOOD_RUN and now_ns - self._fitted_ns <= self._in_time_ns:
            return _within(self._reading_01mm, POSITION_MAX_01MM)
        return self.reckoned(now_ns)[0]

    def reckoned(self, now_ns: int) -> tuple[int, int]:
        """Dead-reckoned position at ``now_ns``, and the tolerance for the odometer; 0.1 mm."""
        self._reckon(now_ns)
        return _within(self._place // _NS_PER_S, POSITION_MAX_01MM), self._tolerance() // _NS_PER_S

    def lost(self, now_ns: int) -> CtlCause:
        """Cause for which the position is lost: dead reckoning for too long with a law that needs a position, or
        implausible telegrams for as long. For other laws a silent port means nothing, also after an implausible
        telegram."""
        jumped_ns = self._jumped_ns
        if jumped_ns is None:
            lost = self._needed and self._begun and now_ns - self._trusted_ns > RECKONING_MAX_NS
            return CtlCause.POSITION_LOST if lost else _NOT_LOST
        if not self._needed and now_ns - self._jumping_ns > self._in_time_ns:
            return _NOT_LOST
        since_ns = self._trusted_ns if self._needed else jumped_ns
        return CtlCause.POSITION_IMPLAUSIBLE if now_ns - since_ns > RECKONING_MAX_NS else _NOT_LOST

    def _tolerance(self) -> int:
        if not self._heard:
            # The position is unknown before the first telegram.
            return POSITION_MAX_01MM * _NS_PER_S
        return self._exact + self._speed_01mmps * self._hold_ns + self._slack

    def _reckon(self, at_ns: int) -> None:
        """Advance the position with the last speed. After the clock was set back, wait until it has caught up."""
        step_ns = at_ns - self._at_ns
        if step_ns <= 0 or not self._begun:
            return
        self._at_ns = at_ns
        self._place += self._speed_01mmps * step_ns
        if self._speed_01mmps:
            since_ns = at_ns - self._speed_ns
            changed_01mmps = self._accel_01mmps2 * since_ns // _NS_PER_S if since_ns > 0 else 0
            self._slack += (self._speed_error_01mmps + changed_01mmps) * step_ns


def _within(value: int, most: int) -> int:
    return min(max(value, -most), most)
