"""Speed limit and grade from TRK_INFO, and their age.

A limit that is no longer sent is not relied upon: the traction is cut when :data:`CUT_PERIODS` telegrams in a row are
missing, and the train brakes when the last one is older than the largest age of a speed (``watch.emergency_ms``, 1 s).
A grade that old is not used: brake and runaway are then not judged. A telegram that repeats its life sign, or whose
check variables of limit and grade are not both correct, does not renew the age.
"""

from __future__ import annotations

from typing import Final

from railhil.bus.layout import CHECK_CORRECT
from railhil.bus.schedule import Schedule
from railhil.controller_node.ato.speed_watch import Finding
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import CtlCause, TrkInfo, WatchLevel

#: Periods without a telegram after which the traction is cut, as in the trains of the other systems.
CUT_PERIODS: Final = 3

_NEVER_NS: Final = 1 << 62
_CUT: Final = Finding(WatchLevel.TRACTION_CUT, CtlCause.TRACK_AGE)
_BRAKE: Final = Finding(WatchLevel.SERVICE_BRAKE, CtlCause.TRACK_AGE)


def ages_ns(scenario: Scenario) -> tuple[int, int]:
    """Ages above which the traction is cut, and the train brakes."""
    timing = scenario.timing
    schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, scenario.installed_system.contract)
    period_ns = schedule.ticks(TrkInfo.PORT) * timing.base_tick_ns
    return CUT_PERIODS * period_ns, scenario.watch.emergency_ms * 1_000_000


class TrackInfo:
    """Information from the track; times are counted by the node from its beginning.

    :param watched: False: no age is ever too large.
    """

    def __init__(self, scenario: Scenario, *, watched: bool = True) -> None:
        #: Speed limit in 0.1 mm/s; None before the first.
        self.limit_01mmps: int | None = None
        cut_ns, self._brake_ns = ages_ns(scenario) if watched else (_NEVER_NS, _NEVER_NS)
        self._old_ns = min(cut_ns, self._brake_ns)
        self._grade_001permil: int | None = None
        self._told_ns = 0
        self._life = -1

    def take(self, telegram: TrkInfo, now_ns: int) -> None:
        """Take a telegram that passed the traffic store: limit and grade, each if its check variable is correct."""
        if telegram.life == self._life:
            return
        self._life = telegram.life
        limit, grade = telegram.limit_check == CHECK_CORRECT, telegram.grade_check == CHECK_CORRECT
        if limit:
            self.limit_01mmps = telegram.speed_limit_4mmps * 40
        if grade:
            self._grade_001permil = telegram.grade_001permil
        if limit and grade:
            self._told_ns = now_ns

    def grade_001permil(self, now_ns: int) -> int | None:
        """Grade in 0.01 permil; None: not known, or too old."""
        return self._grade_001permil if now_ns - self._told_ns <= self._old_ns else None

    def finding(self, now_ns: int) -> Finding | None:
        """The reaction demanded by its age; None: none."""
        age_ns = now_ns - self._told_ns
        if age_ns <= self._old_ns:
            return None
        return _BRAKE if age_ns > self._brake_ns else _CUT
