"""The train's end of the safe command: NOTCH_CMD acts only if NOTCH_SDT confirms it at the same instant.

NOTCH_SDT is polled directly after NOTCH_CMD. It confirms the command if SDTv2's sink finds it fresh
(:mod:`railhil.bus.sdt`), its time is the present one, and its notch and emergency flag equal the command's. A command
that is not confirmed is not accepted: its age grows in the train's watch. An emergency command acts without
confirmation.
"""

from __future__ import annotations

from collections import Counter

from railhil.bus.schedule import Schedule
from railhil.bus.sdt import SAFE_DATA_VERSION, SafeSink, SinkLimits, Validity, safe_tick, source_identity
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import NotchCmd, NotchSdt


class SafeCommand:
    """Confirms commands that have passed the gate.

    ``counters``: safe telegrams that confirmed nothing, by cause with the prefix ``safe_``: the causes of
    :class:`railhil.bus.sdt.SafeSink`, ``time``, ``differs``.
    """

    def __init__(self, scenario: Scenario) -> None:
        timing, safety = scenario.timing, scenario.safety
        schedule = Schedule.from_contract(
            timing.base_tick_ns, timing.port_period_ns, scenario.installed_system.contract
        )
        self._counters: Counter[str] = Counter()
        #: Number of telegrams that confirmed a command.
        self.accepted = 0
        self._n_rxsafe = safety.n_rxsafe
        limits = SinkLimits(n_rxsafe=safety.n_rxsafe, n_ssc=safety.n_rxsafe + 1, cmthr=safety.cmthr)
        self._sink = SafeSink([source_identity(NotchSdt.port().address)], SAFE_DATA_VERSION, limits, self._counters)
        self._period_ticks = schedule.ticks(NotchSdt.PORT)
        self._cycle_tick = 0
        self._held: NotchCmd | None = None
        self._held_tick = -1
        self._confirmed_tick = -1

    @property
    def counters(self) -> dict[str, int]:
        """See the class."""
        return {f"safe_{cause}": count for cause, count in self._counters.items()}

    @property
    def refuses(self) -> bool:
        """True when the last command that passed the gate was not confirmed."""
        return self._held_tick > self._confirmed_tick

    def hold(self, command: NotchCmd, tick: int) -> None:
        """Keep a command that has passed the gate."""
        self._held, self._held_tick = command, tick

    def confirmed(self, telegram: NotchSdt, tick: int) -> NotchCmd | None:
        """The command of this tick if the safe telegram confirms it."""
        missed = (tick - self._cycle_tick) // self._period_ticks - 1
        self._cycle_tick = tick
        for _ in range(min(missed, self._n_rxsafe)):
            self._sink.judge(None)
        if self._sink.judge(telegram.encode()) is not Validity.FRESH:
            return None
        if safe_tick(telegram) != tick & 0xFFFFFF:
            self._counters["time"] += 1
            return None
        held = self._held
        if held is None or self._held_tick != tick:
            return None
        if (held.notch_256th, held.emergency) != (telegram.notch_256th, telegram.emergency):
            self._counters["differs"] += 1
            return None
        self._confirmed_tick = tick
        self.accepted += 1
        return held
