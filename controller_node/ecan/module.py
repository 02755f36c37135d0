"""Reception as in the eCAN: acceptance by mailbox, one frame per mailbox, a time stamp with each.

There is no FIFO. A frame goes to the matching mailbox with the highest number. If that mailbox still holds an unread
frame, the newer frame overwrites it and the mailbox's lost flag (RML) is set; a mailbox with overwrite protection (OPC)
keeps the old frame and leaves the new one to the next matching mailbox, and when there is none the frame is lost
*without any flag*.

Source: TI SPRU074F, section 2.16 (overwrite protection) and chapter 3 (receiving); SPRUI07, chapter 13.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Final

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, Frame
from railhil.controller_node.ecan.mailboxes import MAILBOXES_MAX, Mailbox
from railhil.controller_node.ecan.timestamp import BitCounter

_STANDARD_IDS: Final = 0x800
#: An error frame is not a message, and to a classic CAN module a CAN FD frame is a faulty one.
_NEVER: Final = ERROR | FD | BRS


class Ecan:
    """Receive side of one module.

    ``lost``: for each mailbox number, frames that were overwritten unread (each sets RML, whose interrupt counts).
    ``lost_unseen``: frames that found only protected mailboxes, which the chip itself does not report.
    ``no_mailbox``: frames that no mailbox accepts; the node never sees them.
    ``stamps``: for each mailbox number, the time stamp of its newest frame in bit times.

    :param table: the node's mailboxes, receive and transmit.
    :param by_interrupt: numbers of the mailboxes that an interrupt reads before the next frame can arrive: they are
        never full.
    """

    def __init__(self, table: Sequence[Mailbox], counter: BitCounter, by_interrupt: Collection[int] = ()) -> None:
        self.lost = [0] * MAILBOXES_MAX
        self.lost_unseen = 0
        self.no_mailbox = 0
        self.stamps = [0] * MAILBOXES_MAX
        self._counter = counter
        self._receiving = sorted((box for box in table if not box.transmit), key=lambda box: -box.number)
        self._protected = {box.number for box in table if not box.overwrite}
        self._kept = [number not in by_interrupt for number in range(MAILBOXES_MAX)]
        self._full: list[Frame | None] = [None] * MAILBOXES_MAX
        self._now_ns, self._now_bits = 0, 0
        matching = {can_id: self._numbers(can_id, False) for can_id in range(_STANDARD_IDS)}
        #: Standard identifier -> numbers of the matching mailboxes, highest first; identifiers without a match are left
        #: out.
        self.matching = {can_id: numbers for can_id, numbers in matching.items() if numbers}

    @property
    def lost_messages(self) -> int:
        """Frames lost with a flag, all mailboxes together."""
        return sum(self.lost)

    @property
    def counters(self) -> dict[str, int]:
        """Frames that did not reach a reader, by cause; causes with a count of zero are left out."""
        counts = {
            "lost_messages": self.lost_messages,
            "lost_unseen": self.lost_unseen,
            "no_mailbox": self.no_mailbox,
        }
        return {cause: count for cause, count in counts.items() if count}

    def _numbers(self, can_id: int, extended: bool) -> list[int]:
        return [box.number for box in self._receiving if box.accepts(can_id, extended)]

    def receive(self, frame: Frame, now_ns: int) -> int:
        """Take a frame from the bus; returns the number of the mailbox that took it, -1 for none.

        A remote frame is accepted like a data frame: as on the chip, the reader decides what to do with it.
        """
        can_id, _, flags = frame
        if not flags:
            numbers = self.matching.get(can_id)
        else:
            numbers = None if flags & _NEVER else self._numbers(can_id, bool(flags & EXTENDED))
        if not numbers:
            self.no_mailbox += 1
            return -1
        for number in numbers:
            if self._full[number] is not None:
                if number in self._protected:
                    continue
                self.lost[number] += 1
            if self._kept[number]:
                self._full[number] = frame
            if now_ns != self._now_ns:
                # Several frames arrive in one tick.
                self._now_ns, self._now_bits = now_ns, self._counter.at(now_ns)
            self.stamps[number] = self._now_bits
            return number
        self.lost_unseen += 1
        return -1

    def read(self, number: int) -> Frame | None:
        """Empty a mailbox; returns the frame that it held, None when it was empty. Its time stamp stays in
        ``stamps``."""
        frame = self._full[number]
        self._full[number] = None
        return frame
