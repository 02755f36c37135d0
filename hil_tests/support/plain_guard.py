"""The controller's guard in plain words, against which :mod:`hil_tests.support.guard_sweeps` holds it."""

from __future__ import annotations

from fractions import Fraction

from railhil.controller_node.ato.speed_watch import (
    LEVELS,
    Finding,
    Ladder,
    Reception,
    SpeedWatchState,
    command,
    observe,
)
from railhil.scenarios.load import load
from railhil.wire.ato import CtlCause

SCENARIO = load("lvshun_tieshan")
MS = 1_000_000


class PlainGuard:
    """The guard as a history: which telegrams were accepted, and when.

    Without the checks of the motion, which need more than random speeds.
    """

    def __init__(self) -> None:
        self.ladder = Ladder.of(SCENARIO)
        self.state = SpeedWatchState()
        self.fresh: list[int] = []
        self.good: list[tuple[int, int]] = []
        self.limits: list[int] = []
        self.sent: list[int] = [0]
        self.counters: dict[str, int] = {}
        self.sample = (0, 0)
        self.bad_ms: list[int] = []
        self.old_ms: list[int] = []
        self.is_old = False

    @staticmethod
    def owes(instants_ms: list[int], cost_ms: Fraction | int, limit_ms: int) -> bool:
        """Whether events were too many, each with a cost that time pays back."""
        debt_ms, at_ms = Fraction(0), 0
        for instant_ms in instants_ms:
            debt_ms = min(max(debt_ms - (instant_ms - at_ms), 0) + cost_ms, 2 * limit_ms)
            at_ms = instant_ms
        return debt_ms > limit_ms

    def look(self, telegram: Reception, now_ns: int, finding: Finding | None = None) -> None:
        at_ns, speed = self.good[-1] if self.good else (0, -1)
        margin = round(SCENARIO.watch.overspeed_margin_mps * 10_000)
        too_fast = bool(self.good and self.limits) and speed > self.limits[-1] * 40 + margin
        age_ms = (now_ns - at_ns) // MS
        self.state = observe(self.ladder, self.state, age_ms, telegram, speed == 0, too_fast, finding)

    def count(self, cause: str) -> None:
        self.counters[cause] = self.counters.get(cause, 0) + 1

    def speed(self, speed: int, check: int, life: int, now_ns: int) -> None:
        step = (life - self.fresh[-1]) % 16 if self.fresh else 1
        if step == 0 or step >= 8:
            self.count("out_of_order" if step else "duplicate")
            counts = step and not self.is_old
            self.old_ms += [now_ns // MS] if counts else []
            self.is_old = self.is_old or step > 0
            found = counts and self.owes(self.old_ms, 20, 80)
            return self.look(Reception.NONE, now_ns, LEVELS[CtlCause.TWO_SOURCES] if found else None)
        self.fresh.append(life)
        self.is_old = False
        if step > 1:
            self.count("gap")
        if check != 1 or speed < 0 or speed > 1_500_000:
            return self.refuse("out_of_range" if check == 1 else "check_variable", Reception.BAD, now_ns)
        if self.good:
            # 2 m/s2 for at least one tick, 0.05 m/s, and resolution and 12 sigma of noise, each 0.01 km/h.
            at_ns, before = self.sample
            if abs(speed - before) > 500 + 361 + 20_000 * max(now_ns - at_ns, 10 * MS) // 10**9:
                return self.refuse("speed_jump", Reception.IMPLAUSIBLE, now_ns)
        if not self.good or now_ns - self.sample[0] >= 100 * MS:
            self.sample = now_ns, speed
        if self.good and now_ns - self.good[-1][0] >= 21 * MS:
            self.state = self.state._replace(good_run=0)
        self.good.append((now_ns, speed))
        return self.look(Reception.GOOD, now_ns)

    def refuse(self, cause: str, telegram: Reception, now_ns: int) -> None:
        self.count(cause)
        self.bad_ms.append(now_ns // MS)
        found = self.owes(self.bad_ms, Fraction(10_000, 30), 10_000)
        self.look(telegram, now_ns, LEVELS[CtlCause.CHANNEL_MONITOR] if found else None)

    def notch(self, law_code: int, now_ns: int) -> tuple[int, bool]:
        self.look(Reception.NONE, now_ns)
        # Polls come every 20 ms: a clock that was behind makes no step of the ramp larger.
        self.sent.append(max(now_ns, self.sent[-1] + 20 * MS) if self.sent[-1] else now_ns)
        codes = [self.ladder.ramp_code_per_s * at_ns // 10**9 for at_ns in self.sent[-2:]]
        self.state, code, emergency = command(self.ladder, self.state, law_code, codes[1] - codes[0])
        return code, emergency
