"""Reading of the mailboxes: at once by interrupts, or by a periodic task.

By default every mailbox is read by interrupt, before the next frame can arrive, and nothing is lost. With a task period
the data mailboxes are read only at the task's instants; frames that arrive in between overwrite each other. The polls
of the bus administrator and the bench's own telegrams (time, end of the run) are read by interrupt in both cases.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from railhil.bus.frame import Frame
from railhil.bus.store import FrameCheck
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.controller_node.ecan.mailboxes import POLL, Mailbox
from railhil.controller_node.ecan.module import Ecan
from railhil.controller_node.ecan.timestamp import BitCounter

_BY_INTERRUPT: Final = (POLL, TimeSync.PORT, RunEvent.PORT)


class Receiver:
    """The mailboxes of a node and their readers, as :class:`railhil.bus.responder.CanModule`.

    :param table: the node's mailboxes.
    :param task_period_ns: simulation time between two readings of the data mailboxes; 0 reads each at once.
    """

    def __init__(self, table: tuple[Mailbox, ...], counter: BitCounter, task_period_ns: int = 0) -> None:
        receiving = [box for box in table if not box.transmit]
        self._task_numbers = [box.number for box in receiving if task_period_ns and box.port not in _BY_INTERRUPT]
        self.has_task = bool(self._task_numbers)
        at_once = {box.number for box in receiving}.difference(self._task_numbers)
        self.ecan = Ecan(table, counter, at_once)
        # Standard identifier -> the mailbox that takes its frames and is read before the next one: it is never full.
        self._free = {can_id: boxes[0] for can_id, boxes in self.ecan.matching.items() if boxes[0] in at_once}
        self._stamps = self.ecan.stamps
        self._counter = counter
        # Time stamp of now: several frames arrive in one tick.
        self._now_ns, self._now_bits = -1, 0
        # By mailbox number: the store's check of its newest frame, if it was made.
        self._checked: dict[int, FrameCheck | None] = {}
        self._task_period_ns = task_period_ns
        self._task_slot = -1

    def receive(self, frame: Frame, checked: FrameCheck | None, now_ns: int) -> int | None:
        """Take a frame; returns its time stamp when it is read at once, None when it is lost or waits for the task."""
        can_id, _, flags = frame
        number = self._free.get(can_id)
        if number is not None and not flags:
            # It does not stay in its mailbox: nearly every frame for this node.
            if now_ns != self._now_ns:
                self._now_ns, self._now_bits = now_ns, self._counter.at(now_ns)
            self._stamps[number] = bits = self._now_bits
            return bits
        ecan = self.ecan
        number = ecan.receive(frame, now_ns)
        if number < 0:
            return None
        if self.has_task and number in self._task_numbers:
            self._checked[number] = checked
            return None
        return ecan.stamps[number]

    def read_due(self, now_ns: int) -> Sequence[tuple[Frame, FrameCheck | None, int, int]]:
        """The task: once per period, read every mailbox that holds a frame, in ascending order.

        :returns: the frame, its check if there was one, its arrival (simulation time, ns), and its time stamp.
        """
        slot = now_ns // self._task_period_ns
        if slot == self._task_slot:
            return ()
        self._task_slot = slot
        stamps, age_ns = self.ecan.stamps, self._counter.age_ns
        return [
            (frame, self._checked[number], now_ns - age_ns(stamps[number], now_ns), stamps[number])
            for number in self._task_numbers
            if (frame := self.ecan.read(number)) is not None
        ]
