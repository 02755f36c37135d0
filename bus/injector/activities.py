"""The faults of one node in one run: when each is active, its end, and the log of its effects.

The log has for each fault its instants and hits, each with the value before and after.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from railhil.bus.codes import FaultOrder
from railhil.common.errors import InputError, Words
from railhil.common.user_files import whole_file
from railhil.faults.activity import Activity
from railhil.faults.language import fault_text
from railhil.faults.model import Fault
from railhil.faults.words import CLEAR

#: Files of a run folder, by node: ``faults-plant.csv``.
FILE_NAME = "faults-{node}.csv"
#: Word in place of the node's name, for the log of the faults inside the plant.
INSIDE = "inside-plant"
#: Header of such a file.
COLUMNS = ("fault", "time_ns", "what", "before", "after")


class Hit(NamedTuple):
    """One change: ``fault`` is its number from 1; ``before`` and ``after`` are texts (raw bytes in hex, values)."""

    fault: int
    time_ns: int
    what: str
    before: str
    after: str


class InjectionLog:
    """Hits of one node, in the order of the simulation."""

    def __init__(self) -> None:
        self.hits: list[Hit] = []

    def note(self, activity: Activity, time_ns: int, before: str, after: str) -> None:
        """Note that a fault has changed something, and count it (:meth:`Activity.hit`)."""
        self.hits.append(Hit(activity.number, time_ns, activity.fault.what, before, after))
        activity.hit(time_ns)

    def text(self, activities: Sequence[Activity]) -> str:
        """The file: a row ``begun`` and ``ended`` for each fault that became active, and one for each hit, by time.

        Where an operator has given values, ``begun`` has the fault's text.
        """
        rows = [(hit.time_ns, hit.fault, 1, hit) for hit in self.hits]
        for one in activities:
            if one.begun_ns is not None:
                text = fault_text(one.fault, judging=False) if one.given else ""
                rows.append((one.begun_ns, one.number, 0, Hit(one.number, one.begun_ns, "begun", "", text)))
            if one.ended_ns is not None and one.begun_ns is not None:
                rows.append((one.ended_ns, one.number, 2, Hit(one.number, one.ended_ns, "ended", "", "")))
        buffer = io.StringIO()
        writer = csv.writer(buffer, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(hit for *_, hit in sorted(rows, key=lambda row: row[:3]))
        return buffer.getvalue()

    def write(self, folder: Path, node: str, activities: Sequence[Activity]) -> None:
        """Write :data:`FILE_NAME` into a run folder."""
        with whole_file(folder / FILE_NAME.format(node=node)) as path:
            path.write_text(self.text(activities), encoding="utf-8")


def _has_begun(one: Activity) -> InputError:
    found = Words(f"{fault_text(one.fault, judging=False)}, which begins at {(one.begun_ns or 0) / 1e9:g} s")
    return InputError(
        "branch", f"fault {one.number}", found, "a fault that begins at the instant of the branch or later"
    )


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
        # The last instant with position and speed; events and, if they are kept, such instants, in their order.
        self._last: tuple[int, float, float] | None = None
        self._past: list[tuple[int, float, float] | str] = []
        self._remembers = False

    def look(self, now_ns: int, position_m: float, speed_mps: float) -> None:
        """Begin and end faults at an instant, by the truth."""
        self.now_ns = now_ns
        self._last = now_ns, position_m, speed_mps
        if self._remembers:
            self._past.append(self._last)
        for number, order in self._orders:
            self.order_now(number, order)
        self._orders = []
        for one in self.all:
            if one.look(now_ns, position_m, speed_mps) and one.fault.what == CLEAR:
                self._clear(one)

    def happened(self, events: Iterable[str]) -> None:
        """Events of the run at the present instant."""
        for event in events:
            self._past.append(event)
            for one in self.all:
                one.happened(event, self.now_ns)

    def order(self, orders: Iterable[tuple[int, int]]) -> None:
        """Take orders by hand (number of the fault, :class:`railhil.bus.codes.FaultOrder`); they act from the next
        instant on."""
        self._orders += orders

    def order_now(self, number: int, order: int) -> None:
        """Take an order by hand that acts from the present instant on; numbers of faults elsewhere are ignored.

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

    def remember(self) -> None:
        """Keep the instants of the run from now on, for :meth:`adopt`. A run has not advanced yet."""
        self._remembers = True
        if self._last is not None:
            self._past.append(self._last)

    def adopt(self, faults: Iterable[tuple[int, Fault]]) -> None:
        """Have other faults from the next instant on, as if they had been there from the start.

        A fault that keeps its number and its text keeps its state. No other fault may have begun, old or new.

        :raises InputError: one has begun.
        """
        assert self._remembers, "this node does not remember its instants"
        before = {one.number: one for one in self.all}
        found = []
        for number, fault in faults:
            known = before.get(number)
            if known is not None and known.fault == fault:
                found.append(before.pop(number))
            else:
                found.append(self._waiting(fault, number))
        for one in before.values():
            if one.begun_ns is not None:
                raise _has_begun(one)
        self.all[:] = found

    def _waiting(self, fault: Fault, number: int) -> Activity:
        """A new fault, after all that has happened.

        :raises InputError: it would have begun.
        """
        made, now_ns = Activity(fault, number), 0
        for item in self._past:
            if isinstance(item, str):
                made.happened(item, now_ns)
            else:
                now_ns = item[0]
                made.look(*item)
                if made.begun_ns is not None:
                    raise _has_begun(made)
        return made

    def note(self, activity: Activity, before: str, after: str) -> None:
        """Note that a fault has changed something at the present instant."""
        self.log.note(activity, self.now_ns, before, after)

    def write(self, folder: Path | None, node: str) -> None:
        """Write the log into the run folder, if there is one."""
        if folder is not None and self.all:
            self.log.write(folder, node, self.all)

    def _clear(self, order: Activity) -> None:
        """End the active faults at the place of a fault that clears them."""
        place = order.fault.place
        for one in self.all:
            if one.active and one is not order and one.fault.place == place:
                one.order(False, self.now_ns)
                self.note(order, one.fault.what, CLEAR)
        order.order(False, self.now_ns)
