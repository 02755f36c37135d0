"""Faults of traction and service brake: what their actuator does instead of what it is told.

========== ==========================================================================================
weak, off  a share of the force, whoever commands it (notch or the watch's service brake); none
scale      the same with any factor: a train that is stronger or weaker than its data
slow       the actuator's pole is multiplied while the side acts
dead_time  the notch acts later, in whole ticks
stuck      the force of its first instant stays
full       all the force that the side has at the present speed
========== ==========================================================================================

The emergency brake is a path of its own, as on a train whose brake pipe or loop does not pass through the service
brake's electronics: at EMERGENCY these faults of the brake do not act, and the main breaker opens, which ends traction
whatever the drive does. An open main breaker, a lowered pantograph, or no line voltage ends it as well.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from railhil.bus.injector.activity import Activity
from railhil.plant_sim.faults.injections import Injections, longest, number_of
from railhil.plant_sim.forces import EffortLimit

#: A force that differs by more than this from the commanded one is a fault's effect.
_NOTICED_N = 1.0


def shared(limit: EffortLimit, share: float) -> EffortLimit:
    """A share of a force limit at every speed."""
    curve_n = tuple(force_n * share for force_n in limit.curve_n)
    return EffortLimit(limit.force_max_n * share, limit.power_max_w * share, limit.curve_mps, curve_n)


def capped(limit: EffortLimit, force_n: float) -> EffortLimit:
    """A force limit, and never more than ``force_n``."""
    return limit._replace(force_max_n=min(limit.force_max_n, max(0.0, force_n)))


@dataclass(frozen=True, slots=True)
class SideState:
    """What the active faults make of one side: share of its force, factor on the pole, dead time in ticks, and the
    force that it gives instead of the commanded one (None: no such fault; infinite: full)."""

    share: float = 1.0
    pole: float = 1.0
    dead_ticks: int = 0
    instead_n: float | None = None


class Side:
    """Traction or service brake with its faults, in the order of their numbers.

    :param sign: 1 for traction, -1 for the brake: the sign of its notches.
    """

    def __init__(self, faults: Sequence[Activity], sign: int, tick_s: float) -> None:
        self.faults = faults
        self.state = SideState()
        self._sign = sign
        self._tick_s = tick_s
        self._held_n: dict[int, float] = {}
        late = [one.fault for one in faults if one.fault.what == "dead_time"]
        most = max((self._ticks(longest(fault, "delay_s")) for fault in late), default=0)
        # Notches of this side at the ends of the last ticks; None: no fault needs them.
        self._past: deque[int] | None = deque([0], maxlen=most + 1) if most else None

    def _ticks(self, time_s: float) -> int:
        return round(time_s / self._tick_s)

    def change(self, force_n: float) -> None:
        """Faults have begun or ended.

        :param force_n: force of this side at this instant, >= 0.
        """
        share, pole, dead_ticks = 1.0, 1.0, 0
        instead_n: float | None = None
        for one in self.faults:
            what = one.fault.what
            if not one.active:
                self._held_n.pop(one.number, None)
            elif what == "weak":
                share *= number_of(one.fault, "share")
            elif what == "scale":
                share *= number_of(one.fault, "factor")
            elif what == "off":
                share = 0.0
            elif what == "slow":
                pole *= number_of(one.fault, "factor")
            elif what == "dead_time":
                dead_ticks += self._ticks(number_of(one.fault, "delay_s"))
            elif what == "full":
                instead_n = float("inf")
            elif what == "stuck":
                instead_n = self._held_n.setdefault(one.number, force_n)
        self.state = SideState(share, pole, dead_ticks, instead_n)

    def part(self, code: int) -> int:
        """The part of a notch code that this side carries out."""
        return max(code, 0) if self._sign > 0 else min(code, 0)

    def acting(self, code: int) -> int:
        """The notch code of this side that acts, when the plant's is ``code``."""
        if self.state.instead_n is not None:
            return 0
        if self.state.dead_ticks and self._past is not None:
            return self._past[max(0, len(self._past) - 1 - self.state.dead_ticks)]
        return self.part(code)

    def remember(self, code: int) -> None:
        """The notch code at the end of a tick."""
        if self._past is not None:
            self._past.append(self.part(code))

    def note(
        self, injections: Injections, possible: bool, code: int, commanded_n: float, instead_n: float | None
    ) -> None:
        """Note which faults change anything over the coming tick.

        :param possible: whether this side acts at all.
        :param code: notch code of the plant.
        :param commanded_n: force that a healthy side would give in the end, >= 0.
        :param instead_n: force that it gives instead; None: no such fault is active.
        """
        for one in self.faults:
            before, after = f"{commanded_n:.0f} N", f"{commanded_n * self.state.share:.0f} N"
            acts = commanded_n > 0.0
            if one.fault.what == "dead_time":
                before, after = str(self.part(code)), str(self.acting(code))
                acts = before != after
            elif one.fault.what in ("stuck", "full"):
                acts = instead_n is not None and abs(instead_n - commanded_n) > _NOTICED_N
                after = f"{instead_n or 0.0:.0f} N"
            elif one.fault.what == "slow":
                before, after = "pole", f"pole x {self.state.pole:g}"
            injections.effect(one, acts and possible and one.active, before, after)
