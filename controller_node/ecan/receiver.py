"""Who reads the mailboxes, and when: interrupts at once, or a task with a period.

By default every mailbox is read by interrupt, before the next frame can come, and nothing is ever lost. With a task
period the data mailboxes are read by a task at its instants only; what comes between overwrites. The polls of the bus
administrator and the bench's own telegrams (time, end of the run) are read by interrupt in both cases.
"""

from __future__ import annotations

from railhil.bus.frame import Frame
from railhil.bus.responder import Responder
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.controller_node.ecan.mailboxes import POLL, Mailbox
from railhil.controller_node.ecan.module import Ecan
from railhil.controller_node.ecan.timestamp import BitCounter
from railhil.dbc import wire_contract

_BY_INTERRUPT = (POLL, TimeSync.PORT, RunEvent.PORT)


class Receiver:
    """Takes frames in bus order and hands those that are read in time to the responder.

    :param table: the node's mailboxes; None with CAN FD, which the chip does not know: then the responder takes every
        identifier of its ports at once.
    :param task_period_ns: simulation time between two readings of the data mailboxes; 0 reads each at once.
    """

    def __init__(
        self, responder: Responder, table: tuple[Mailbox, ...] | None, counter: BitCounter, task_period_ns: int = 0
    ) -> None:
        receiving = [box for box in table or () if not box.transmit]
        self._task_numbers = [box.number for box in receiving if task_period_ns and box.port not in _BY_INTERRUPT]
        at_once = {box.number for box in receiving}.difference(self._task_numbers)
        self.ecan = None if table is None else Ecan(table, counter, at_once)
        self._responder = responder
        self._clock = responder.clock
        self._counter = counter
        self._clock_id = wire_contract().clock_port.address
        self._poll_number = next((box.number for box in receiving if box.port == POLL), -1)
        self._task_period_ns = task_period_ns
        self._task_slot = -1
        self._reading = -1

    @property
    def stamp(self) -> int:
        """Time stamp of the message that is being read, in bit times."""
        return self._counter.at(self._clock.now_ns) if self.ecan is None else self.ecan.stamps[self._reading]

    @property
    def lost_messages(self) -> int:
        """Frames that were overwritten in their mailbox before they were read."""
        return 0 if self.ecan is None else self.ecan.lost_messages

    @property
    def counters(self) -> dict[str, int]:
        """What did not reach the responder, by cause."""
        return {} if self.ecan is None else self.ecan.counters

    def handle(self, frame: Frame) -> list[Frame]:
        """Take one frame; returns the answer to a poll of this node, otherwise nothing."""
        ecan, clock = self.ecan, self._clock
        if ecan is None:
            return self._responder.handle(frame)
        if frame[0] == self._clock_id:
            # Stands for the chip's own timer: it runs on whoever reads the mailbox.
            clock.feed(frame)
        if self._task_period_ns:
            # Before the frame is stored: the task is due at the tick, the tick's frames come after it.
            self.read_when_due()
        now_ns = clock.tick * clock.base_tick_ns
        number = ecan.receive(frame, now_ns)
        if number < 0:
            return []
        if number == self._poll_number:
            return self._responder.handle(frame)
        if number not in self._task_numbers:
            self._reading = number
            self._responder.deliver(frame, now_ns)
        return []

    def read_when_due(self) -> None:
        """The task: once per period, read every mailbox that holds a frame, in ascending order."""
        ecan = self.ecan
        if ecan is None or not self._task_period_ns:
            return
        now_ns = self._clock.now_ns
        slot = now_ns // self._task_period_ns
        if slot == self._task_slot:
            return
        self._task_slot = slot
        for number in self._task_numbers:
            frame = ecan.read(number)
            if frame is not None:
                self._reading = number
                self._responder.deliver(frame, now_ns - self._counter.age_ns(ecan.stamps[number], now_ns))
