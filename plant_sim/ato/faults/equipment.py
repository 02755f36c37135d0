"""Faults of the train's equipment: interlocks that open, the line voltage, traction and service brake.

Faults of traction and brake: :mod:`railhil.faults.actuators`. A delayed notch acts later in whole ticks. ``full`` is
the largest force of the side at the present speed.

The emergency brake is a path of its own, as on a train whose brake pipe or loop does not pass through the service
brake's electronics: at EMERGENCY these faults of the brake do not act, and the main breaker opens, which ends traction
whatever the drive does. Every interlock that blocks traction ends it as well: it opens the contactors.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterable
from math import prod

from railhil.faults.activity import Activity
from railhil.faults.actuators import FaultySide
from railhil.plant_sim.ato.forces import EffortLimit
from railhil.plant_sim.ato.plant_readings import TrainStatus
from railhil.plant_sim.faults.injections import Injections

#: Place -> field of the status that is False while a fault ``off`` is active there.
INTERLOCKS = {
    "power": "power_on",
    "pantograph": "pantograph_up",
    "main_breaker": "main_breaker_closed",
    "doors": "doors_closed_locked",
    "parking_brake": "parking_brake_released",
    "safety_loop": "safety_loop_closed",
}
LINE_VOLTAGE = "line_voltage"


class FaultyEquipment:
    """Sets the fields of a train's status that active faults change; other fields stay as they are.

    :param own: places whose faults the plant itself takes.
    """

    def __init__(self, injections: Injections, own: Collection[str] = ()) -> None:
        self._injections = injections
        self._names = tuple(name for name in (LINE_VOLTAGE, *INTERLOCKS) if name not in own)
        injections.attach(self._take)

    def _take(self) -> None:
        self._faults = self._injections.at("train", *self._names)

    def change(self, status: TrainStatus) -> None:
        """Take the faults that have begun or ended."""
        healthy = TrainStatus()
        for one in self._faults:
            field = INTERLOCKS.get(one.fault.place.name, "line_voltage_percent")
            setattr(status, field, getattr(healthy, field))
        for one in self._faults:
            name = one.fault.place.name
            if name == LINE_VOLTAGE:
                found = one.fault.parameter("share") * 100 if one.active else 100.0
                before, status.line_voltage_percent = (
                    status.line_voltage_percent,
                    min(status.line_voltage_percent, found),
                )
                self._injections.effect(one, found < before, f"{before:g} %", f"{found:g} %")
            elif one.active:
                setattr(status, INTERLOCKS[name], False)
                self._injections.effect(one, True, "true", "false")
            else:
                self._injections.effect(one, False, "", "")


#: A force that differs by more than this from the commanded one is a fault's effect.
_NOTICED_N = 1.0


def share_limit(limit: EffortLimit, share: float) -> EffortLimit:
    """A share of a force limit at every speed."""
    curve_n = tuple(force_n * share for force_n in limit.curve_n)
    return EffortLimit(limit.force_max_n * share, limit.power_max_w * share, limit.curve_mps, curve_n)


def cap_limit(limit: EffortLimit, force_n: float) -> EffortLimit:
    """A force limit, cut at ``force_n``."""
    return limit._replace(force_max_n=min(limit.force_max_n, max(0.0, force_n)))


class Side(FaultySide):
    """Traction or service brake; forces are >= 0.

    :param sign: 1 for traction, -1 for the brake: the sign of its notches.
    :ivar pole: factor on its pole.
    """

    def __init__(self, activities: Iterable[Activity], sign: int, tick_s: float) -> None:
        super().__init__(activities)
        self.pole = 1.0
        self._dead_ticks = 0
        self._sign = sign
        self._tick_s = tick_s
        most = max((self._ticks(one.longest_delay_s()) for one in self.faults), default=0)
        # Notches of this side at the ends of the last ticks; None: no fault needs them.
        self._past: deque[int] | None = deque([0], maxlen=most + 1) if most else None

    def _ticks(self, time_s: float) -> int:
        return round(time_s / self._tick_s)

    def change(self, present: float) -> None:
        """See :meth:`FaultySide.change`."""
        super().change(present)
        self.pole = prod(self.state.poles, start=1.0)
        self._dead_ticks = sum(map(self._ticks, self.state.delays_s))

    def part(self, code: int) -> int:
        """The part of a notch code that this side carries out."""
        return max(code, 0) if self._sign > 0 else min(code, 0)

    def acting(self, code: int) -> int:
        """The notch code of this side that acts when the plant's code is ``code``."""
        if self.state.instead is not None:
            return 0
        if self._dead_ticks and self._past is not None:
            return self._past[max(0, len(self._past) - 1 - self._dead_ticks)]
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
            match one.field:
                case "share":
                    acts = commanded_n > 0.0
                    before, after = f"{commanded_n:.0f} N", f"{commanded_n * self.state.share:.0f} N"
                case "poles":
                    acts = commanded_n > 0.0
                    before, after = "pole", f"pole x {self.pole:g}"
                case "delays_s":
                    before, after = str(self.part(code)), str(self.acting(code))
                    acts = before != after
                case "instead":
                    acts = instead_n is not None and abs(instead_n - commanded_n) > _NOTICED_N
                    before, after = f"{commanded_n:.0f} N", f"{instead_n or 0.0:.0f} N"
            injections.effect(one.activity, acts and possible and one.activity.active, before, after)
