"""The controller's end of the safe speed: TRN_SPEED counts only while SPEED_SDT confirms it.

SPEED_SDT brings the speed of the same instant once more, with SDTv2's protection (:mod:`railhil.bus.sdt`) and with the
time of the train. It confirms the speed if the sink finds it fresh, its time equals the controller's clock, and its
speed equals a TRN_SPEED accepted at the same instant. Its age is the time since the last confirmation, beyond the
``n_rxsafe`` periods that the channel tolerates; the watch takes the larger of this age and the age of TRN_SPEED.

The time is needed because the sequence counter repeats itself every 256 telegrams: recorded telegrams that come again
after a multiple of that would otherwise be fresh. A controller that does not know the time of the run yet answers with
the time of the last confirmation. The train can then accept its braking, and refuses a recorded time.
"""

from __future__ import annotations

from collections import Counter

from railhil.bus.schedule import Schedule
from railhil.bus.sdt import SAFE_DATA_VERSION, SafeSink, SinkLimits, Validity, safe_tick, source_identity
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import SpeedSdt

_TICK_MODULUS = 1 << 24


class SafeSpeed:
    """Confirms accepted speeds.

    ``counters``: safe telegrams that confirmed nothing, by cause with the prefix ``safe_``: the causes of
    :class:`railhil.bus.sdt.SafeSink`, ``time``, ``differs``.
    """

    def __init__(self, scenario: Scenario) -> None:
        timing, safety = scenario.timing, scenario.safety
        ticks = Schedule.from_contract(
            timing.base_tick_ns, timing.port_period_ns, scenario.installed_system.contract
        ).ticks(SpeedSdt.PORT)
        self._counters: Counter[str] = Counter()
        #: Number of telegrams that confirmed a speed.
        self.accepted = 0
        self._n_rxsafe = safety.n_rxsafe
        limits = SinkLimits(n_rxsafe=safety.n_rxsafe, n_ssc=safety.n_rxsafe + 1, cmthr=safety.cmthr)
        self._sink = SafeSink([source_identity(SpeedSdt.port().address)], SAFE_DATA_VERSION, limits, self._counters)
        self._period_ns = ticks * timing.base_tick_ns
        self._late_ticks = safety.n_rxsafe * ticks
        self._cycle_ns = 0
        self._confirmed_ns = 0
        #: Time of the train at the last confirmation, in its ticks.
        self.told_tick = 0

    @property
    def counters(self) -> dict[str, int]:
        """See the class."""
        return {f"safe_{cause}": count for cause, count in self._counters.items()}

    def take(self, telegram: SpeedSdt, now_ns: int, tick: int | None, speed_01mmps: int | None) -> None:
        """Take a SPEED_SDT telegram that passed the traffic store.

        :param tick: of the controller's clock; None: it is not known yet, and the telegram's time is not checked.
        :param speed_01mmps: accepted from TRN_SPEED at this instant; None: none was.
        """
        since_ns = now_ns - self._cycle_ns
        cycles = since_ns // self._period_ns
        # A telegram that comes late does not take the time of the next one.
        self._cycle_ns = now_ns - since_ns % self._period_ns if cycles > 0 else now_ns
        for _ in range(min(cycles - 1, self._n_rxsafe)):
            self._sink.judge(None)
        if self._sink.judge(telegram.encode()) is not Validity.FRESH:
            return
        off = 0 if tick is None else (safe_tick(telegram) - tick) % _TICK_MODULUS
        if min(off, _TICK_MODULUS - off) > self._late_ticks:
            self._counters["time"] += 1
        elif speed_01mmps is not None and speed_01mmps != telegram.speed_01mmps:
            self._counters["differs"] += 1
        else:
            self._confirmed_ns = now_ns
            self.accepted += 1
            self.told_tick = safe_tick(telegram)

    def age_ns(self, now_ns: int) -> int:
        """Time without confirmation, beyond what the channel tolerates."""
        return max(0, now_ns - self._confirmed_ns - self._n_rxsafe * self._period_ns)
