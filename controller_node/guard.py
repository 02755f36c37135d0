"""The guard between mailboxes and law: accepts or refuses speed telegrams, and lets the watch limit the law's notch."""

from __future__ import annotations

from collections import Counter

from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.lifesign import Life, LifeSign
from railhil.bus.safe_telegrams import SpeedSdt
from railhil.bus.telegrams import CtlCause, TrkInfo, TrnSpeed
from railhil.controller_node.ecan import BitCounter, MessageAge
from railhil.controller_node.odometer import Odometer
from railhil.controller_node.safe_speed import SafeSpeed
from railhil.controller_node.speed_watch import (
    Ladder,
    Reception,
    Seen,
    SpeedWatchLevel,
    SpeedWatchState,
    command,
    observe,
)
from railhil.dbc import wire_contract
from railhil.scenarios.model import Scenario

#: Raw speeds beyond this are implausible for a train on this bench (0.1 mm/s, 150 m/s).
SPEED_MAX_01MMPS = 1_500_000
_NS_PER_MS = 1_000_000


class Guard:
    """Feeds the watch with every TRN_SPEED telegram and asks it for the notch to send.

    :param counter: the counter that provides the time stamps; default: one at the bit rate of the port table.
    :param odometer: gets every accepted speed; when it loses the position, the train brakes. Default: one that is not
        needed by the law.

    ``counters``: telegrams refused by cause (``duplicate``, ``out_of_order``, ``check_variable``, ``out_of_range``)
    and ``gap`` for accepted ones after lost ones.
    """

    def __init__(self, scenario: Scenario, counter: BitCounter | None = None, odometer: Odometer | None = None) -> None:
        self.counters: Counter[str] = Counter()
        #: Speed of the last accepted telegram, None before the first.
        self.speed_01mmps: int | None = None
        self._ladder = Ladder.of(scenario)
        self._state = SpeedWatchState()
        self._life = LifeSign()
        self._counter = counter or BitCounter(wire_contract().bit_rate)
        self._age = MessageAge(self._counter)
        self._odometer = odometer or Odometer(scenario)
        self._sent_ns = 0
        #: The safe channel that must confirm every speed; None: the scenario has none.
        self.safe = SafeSpeed(scenario) if scenario.safety.sdt else None
        self._speed_ns = -1
        self._limit_01mmps: int | None = None

    @property
    def level(self) -> SpeedWatchLevel:
        """Level of the reaction ladder."""
        return self._state.level

    @property
    def cause(self) -> CtlCause:
        """Why the level was entered."""
        return self._state.cause

    def limit(self, track: TrkInfo) -> None:
        """Take the speed limit of a TRK_INFO telegram whose check variable is correct."""
        if track.limit_check == CHECK_CORRECT:
            self._limit_01mmps = track.speed_limit_4mmps * 40

    def speed(self, telegram: TrnSpeed, now_ns: int, stamp: int | None = None) -> None:
        """Take a TRN_SPEED telegram that passed the traffic store.

        :param stamp: when the mailbox received it, in bit times; default: now.
        """
        life = self._life.judge(telegram.life)
        if not life.fresh:
            # A repeated or old telegram carries no new information: the age keeps growing.
            self.counters[life.value] += 1
            self._observe(Reception.NONE, now_ns)
            return
        if life is Life.GAP:
            self.counters["gap"] += 1
        self._life.accept(telegram.life)
        if telegram.check != CHECK_CORRECT:
            self.counters["check_variable"] += 1
            self._observe(Reception.BAD, now_ns)
        elif not 0 <= telegram.speed_01mmps <= SPEED_MAX_01MMPS:
            self.counters["out_of_range"] += 1
            self._observe(Reception.BAD, now_ns)
        else:
            self.speed_01mmps = telegram.speed_01mmps
            self._speed_ns = now_ns
            self._age.accept(self._counter.at(now_ns) if stamp is None else stamp)
            age_ns = self._age.ns(now_ns)
            self._odometer.speed(telegram.speed_01mmps, now_ns - age_ns)
            self._observe(Reception.GOOD, now_ns, age_ns)

    def confirm(self, telegram: SpeedSdt, now_ns: int, tick: int) -> None:
        """Take a SPEED_SDT telegram that passed the traffic store; ``tick``: of the clock."""
        assert self.safe is not None
        self.safe.take(telegram, now_ns, tick, self.speed_01mmps if self._speed_ns == now_ns else None)

    def _observe(self, telegram: Reception, now_ns: int, age_ns: int | None = None) -> None:
        speed = self.speed_01mmps
        limit = self._limit_01mmps
        if age_ns is None:
            age_ns = self._age.ns(now_ns)
        unconfirmed_ns = 0 if self.safe is None else self.safe.age_ns(now_ns)
        overspeed = speed is not None and limit is not None and self._ladder.is_overspeed(speed, limit)
        # Positional arguments: this runs at every tick, and keyword arguments take twice as long.
        seen = Seen(age_ns // _NS_PER_MS, telegram, speed == 0, overspeed, self._odometer.lost(now_ns))
        if unconfirmed_ns <= age_ns:
            self._state = observe(self._ladder, self._state, seen)
            return
        state = observe(self._ladder, self._state, seen._replace(age_ms=unconfirmed_ns // _NS_PER_MS))
        if state.level is not self._state.level and state.cause is CtlCause.SPEED_AGE:
            state = state._replace(cause=CtlCause.SAFETY_CODE)
        self._state = state

    def look(self, now_ns: int) -> None:
        """Check the age of the last speed, at ``now_ns``."""
        self._observe(Reception.NONE, now_ns)

    def notch(self, law_code: int, now_ns: int) -> tuple[int, bool]:
        """Notch code (1/256) and emergency flag to send instead of the law's at ``now_ns``."""
        # Also in the tick of a good telegram: the speed limit may have arrived after it.
        self.look(now_ns)
        elapsed_ms = (now_ns - self._sent_ns) // _NS_PER_MS
        self._sent_ns = now_ns
        self._state, code, emergency = command(self._ladder, self._state, law_code, elapsed_ms)
        return code, emergency
