"""The faults of one node in one run: when each is active, what ends them, and the log of what they did."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from railhil.bus.codes import FaultOrder
from railhil.bus.injector.log import InjectionLog
from railhil.faults.activity import Activity
from railhil.faults.model import Fault
from railhil.faults.words import CLEAR


class Activities:
    """Faults of one node.

    :param faults: with their numbers in the run's list.
    """

    def __init__(self, faults: Iterable[tuple[int, Fault]]) -> None:
        #: In the order of their numbers.
        self.all = [Activity(fault, number) for number, fault in faults]
        self.log = InjectionLog()
        self.now_ns = 0
        self._orders: list[tuple[int, int]] = []
        # Values of the fault that is injected next.
        self._octets = bytearray()

    def look(self, now_ns: int, position_m: float, speed_mps: float) -> None:
        """Begin and end faults at an instant, by the truth."""
        self.now_ns = now_ns
        for number, order in self._orders:
            self.order_now(number, order)
        self._orders = []
        for one in self.all:
            if one.look(now_ns, position_m, speed_mps) and one.fault.what == CLEAR:
                self._clear(one)

    def happened(self, events: Iterable[str]) -> None:
        """Events of the run at the present instant."""
        for event in events:
            for one in self.all:
                one.happened(event, self.now_ns)

    def order(self, orders: Iterable[tuple[int, int]]) -> None:
        """Orders by hand (number of the fault, :class:`railhil.bus.codes.FaultOrder`); they act from the next instant
        on."""
        self._orders += orders

    def order_now(self, number: int, order: int) -> None:
        """An order by hand that acts from the present instant on; numbers of faults elsewhere are ignored.

        Values of which a part was lost inject nothing.
        """
        if order == FaultOrder.VALUE:
            self._octets.append(number)
            return
        octets, self._octets = bytes(self._octets), bytearray()
        inject = order == FaultOrder.INJECT
        for one in self.all:
            if one.number == number and not (inject and octets and not one.give(octets)):
                one.order(inject, self.now_ns)

    def note(self, activity: Activity, before: str, after: str) -> None:
        """A fault has changed something at the present instant."""
        self.log.note(activity, self.now_ns, before, after)

    def write(self, folder: Path | None, node: str) -> None:
        """Write the log into the run folder, if there is one."""
        if folder is not None and self.all:
            self.log.write(folder, node, self.all)

    def _clear(self, order: Activity) -> None:
        """End what is active at the place of a fault that clears it."""
        place = order.fault.place
        for one in self.all:
            if one.active and one is not order and one.fault.place == place:
                one.order(False, self.now_ns)
                self.note(order, one.fault.what, CLEAR)
        order.order(False, self.now_ns)
