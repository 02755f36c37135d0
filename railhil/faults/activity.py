"""When a fault is active: its trigger and its end, decided by the simulated truth."""

from __future__ import annotations

from railhil.faults.model import BRAKING_MPS2, Fault
from railhil.faults.operator_values import with_octets

_NS_PER_S = 1_000_000_000


class MotionEvents:
    """Events of the motion: the beginning of ``standstill``, ``braking`` and ``traction``."""

    def __init__(self) -> None:
        self._before = (True, False, False)

    def seen(self, speed_mps: float, accel_mps2: float, traction_n: float) -> list[str]:
        """The events of one instant."""
        now = speed_mps == 0.0, accel_mps2 <= -BRAKING_MPS2, traction_n > 0.0
        before, self._before = self._before, now
        if now == before:
            return []
        names = ("standstill", "braking", "traction")
        return [name for name, is_so, was_so in zip(names, now, before, strict=True) if is_so and not was_so]


class Activity:
    """One fault of a run: waiting, active, or over. It becomes active once.

    The injector calls :meth:`look` at every tick before it uses :attr:`active`, in addition :meth:`happened` with each
    event, and :meth:`telegram` before each telegram of the fault's port. ``spent`` counts its changes.

    :param fault: with all distributions drawn.
    :param number: its place in the run's list, from 1.
    """

    __slots__ = (
        "_at_ns", "_before", "_duration_ns", "_edge", "_end_ns", "_met", "active", "begun_ns", "ended_ns", "fault",
        "given", "hits", "number", "over",
    )  # fmt: skip

    def __init__(self, fault: Fault, number: int) -> None:
        self.fault = fault
        self.number = number
        self.active = False
        self.over = False
        #: Whether an operator has given it other values.
        self.given = False
        #: Simulation time at which it became active and at which it ended; None before.
        self.begun_ns: int | None = None
        self.ended_ns: int | None = None
        #: Number of telegrams or samples that it has changed.
        self.hits = 0
        trigger = fault.trigger
        # The simulation time from which it is active, as soon as its condition has been met.
        self._at_ns: int | None = None
        self._met = False
        # Value of a position or speed at the last tick: only a crossing counts.
        self._before: float | None = None
        self._edge = 1 if trigger.edge == "rising" else -1
        self._duration_ns = None if fault.duration_s is None else round(fault.duration_s * _NS_PER_S)
        self._end_ns: int | None = None
        if trigger.kind == "time":
            self._meet(round(float(trigger.value) * _NS_PER_S))

    def look(self, now_ns: int, position_m: float, speed_mps: float) -> bool:
        """Whether the fault is active at ``now_ns``, with the train's true position and speed at this instant."""
        if self.over:
            return False
        if not self._met:
            kind = self.fault.trigger.kind
            if kind == "position":
                self._crossing(position_m, now_ns)
            elif kind == "speed":
                self._crossing(speed_mps, now_ns)
        if not self.active:
            if self._at_ns is None or now_ns < self._at_ns:
                return False
            self.active, self.begun_ns = True, now_ns
            if self._duration_ns is not None:
                self._end_ns = now_ns + self._duration_ns
        if self._end_ns is not None and now_ns >= self._end_ns:
            self._finish(now_ns)
        return self.active

    def happened(self, event: str, now_ns: int) -> None:
        """Take an event of the run: a milestone or a level of one of the watches, in lower case."""
        trigger = self.fault.trigger
        if not self._met and trigger.kind == "event" and trigger.value == event:
            self._meet(now_ns)
        elif self.active and self.fault.until == event:
            self._finish(now_ns)

    def telegram(self, number: int, now_ns: int) -> None:
        """Take the number of the next telegram on the fault's port, counted from 1."""
        trigger = self.fault.trigger
        if not self._met and trigger.kind == "telegram" and number >= float(trigger.value):
            self._meet(now_ns)

    def order(self, inject: bool, now_ns: int) -> None:
        """Take an order by hand: inject the fault now, or clear it."""
        if inject and not self._met:
            self._meet(now_ns)
        elif not inject and not self.over:
            self._finish(now_ns)

    def give(self, octets: bytes) -> bool:
        """Take other values for a fault that has not begun (:mod:`railhil.faults.operator_values`).

        :returns: False: they are not whole.
        """
        if self._met or self.over:
            return True
        found = with_octets(self.number, self.fault, octets)
        if found is not None:
            self.fault, self.given = found, True
        return found is not None

    def hit(self, now_ns: int) -> None:
        """Note one more changed telegram or sample; after ``count`` of them the fault is over."""
        self.hits += 1
        if self.fault.count is not None and self.hits >= self.fault.count:
            self._finish(now_ns)

    def _crossing(self, value: float, now_ns: int) -> None:
        threshold, before = float(self.fault.trigger.value), self._before
        self._before = value
        if before is not None and (before - threshold) * self._edge < 0.0 <= (value - threshold) * self._edge:
            self._meet(now_ns)

    def _meet(self, now_ns: int) -> None:
        self._met = True
        self._at_ns = now_ns + round(self.fault.trigger.delay_s * _NS_PER_S)

    def _finish(self, now_ns: int) -> None:
        self.active, self.over = False, True
        self.ended_ns = now_ns
