"""The link between the processes of one run: pipes, and no switch beside the plant.

Only one node acts at a time, and each frame of another node answers the plant. So the plant writes the record: its own
frames and the controller's answers, in the order of both. The controller gets the frames of the plant and of the
supervisor in one inbox, and answers to the plant alone; the supervisor gets the record, and its answers go to both
others. The plant has an inbox for each of the two, so that the supervisor's answers do not go back to it.

The record waits in the plant until a poll wakes the supervisor, or until it fills a write. It is also written when no
answer has come for a while, and when the plant leaves. If the plant is killed, the frames since its last poll of the
supervisor are lost.

A write of at most PIPE_BUF bytes is atomic: frames of two writers do not mix. The plant writes to the controller before
it polls the supervisor, whose answer goes to the controller directly.

The plant's telegrams have no answer, so they may go to the controller early (:meth:`PipeLink.send_early`): it reads
them while the plant makes the next.

The pipes have no name: only processes that inherited them can use them, and the kernel removes them with the last
process.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import select
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, NamedTuple, cast

from railhil.bus.can_settings import PIPES
from railhil.bus.errors import BusLost, BusUnavailable
from railhil.bus.frame import Frame
from railhil.bus.link.base import Link, PackedEnd
from railhil.bus.link.spin_wait import ASLEEP, AWAKE, SpinWait
from railhil.bus.own_frames import supervisor_polls
from railhil.bus.packing import CLASSIC_SIZE, ROLES, pack_frame, pack_frames, unpack_frames
from railhil.bus.transports import Opening
from railhil.common.errors import describe_os_error
from railhil.common.mypyc import mypyc_attr
from railhil.common.patience import PATIENCE_S
from railhil.dbc import house_contract

_SUPERVISOR: Final = "supervisor"
#: Largest read; a multiple of the size of a frame.
_READ_BYTES: Final = 1 << 16
#: Requested size of the supervisor's inbox: it is read in bulk.
_RECORD_BYTES: Final = 1 << 20
#: Largest write that is atomic; a multiple of the size of a frame.
_WRITE_BYTES: Final = select.PIPE_BUF // CLASSIC_SIZE * CLASSIC_SIZE
#: Interval at which a node that waits for room checks whether it must stop.
_LOOK_MS: Final = 100


class Ends(NamedTuple):
    """The pipe ends of one node: its inboxes (the plant's first one is for the controller's answers), and the inboxes
    of the nodes that it writes to, by name."""

    inboxes: tuple[int, ...]
    others: Mapping[str, int]

    @property
    def descriptors(self) -> tuple[int, ...]:
        """All descriptors."""
        return (*self.inboxes, *self.others.values())

    @property
    def channel(self) -> str:
        """The channel on a node's command line."""
        others = ",".join(f"{name}={end}" for name, end in self.others.items())
        return f"{PIPES}:{'+'.join(map(str, self.inboxes))},{others}"

    @classmethod
    def parse(cls, channel: str) -> Ends:
        """The ends that a channel names.

        :raises BusUnavailable: it names none, or this process has not inherited them.
        """
        try:
            first, *others = channel.partition(":")[2].split(",")
            named = {name: int(end) for name, _, end in (other.partition("=") for other in others)}
            ends = cls(tuple(map(int, first.split("+"))), named)
            for end in ends.descriptors:
                os.fstat(end)
        except (ValueError, OSError, OverflowError):
            raise BusUnavailable(
                f"channel {channel!r}: found no pipes of this process; railhil run makes them for its own nodes"
            ) from None
        return ends


class Pipes:
    """The pipes of one run, held by the supervisor until their nodes are started.

    :raises BusUnavailable: this process may not open that many files.
    """

    def __init__(self) -> None:
        self._open: set[int] = set()
        try:
            record, heard, answers, orders = (self._made() for _ in range(4))
        except OSError as error:
            self.close()
            raise BusUnavailable(f"pipes between the nodes: {describe_os_error(error)}") from None
        with contextlib.suppress(OSError):
            # The limit of a user's pipes may be reached; the default size is enough.
            fcntl.fcntl(record[1], fcntl.F_SETPIPE_SZ, _RECORD_BYTES)
        #: The ends of each node.
        self.ends = {
            "plant": Ends((answers[0], orders[0]), {"controller": heard[1], _SUPERVISOR: record[1]}),
            "controller": Ends((heard[0],), {"plant": answers[1]}),
            # The bus administrator comes last: it acts on every answer, and the other nodes must have it before.
            _SUPERVISOR: Ends((record[0],), {"controller": heard[1], "plant": orders[1]}),
        }

    def _made(self) -> tuple[int, int]:
        ends = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
        self._open.update(ends)
        return ends

    def handed_over(self, role: str) -> None:
        """Close the ends of a started node here, so that its end can be noticed."""
        kept = {end for other in ROLES if other != role for end in self.ends[other].descriptors}
        for end in set(self.ends[role].descriptors) - kept:
            self._close(end)

    def own(self) -> Ends:
        """The supervisor's ends; those of the nodes are closed."""
        ends = self.ends[_SUPERVISOR]
        for end in self._open - set(ends.descriptors):
            self._close(end)
        self._open.clear()
        return ends

    def _close(self, end: int) -> None:
        if end in self._open:
            self._open.remove(end)
            os.close(end)

    def close(self) -> None:
        """Close the ends that are still held."""
        for end in tuple(self._open):
            self._close(end)


class _NoBus:
    """The part of a python-can bus that :class:`Link` needs."""

    channel_info = "pipes of this run"

    def shutdown(self) -> None:
        """Nothing beside the descriptors."""


@mypyc_attr(allow_interpreted_subclasses=True)
class PipeLink(Link):
    """:class:`~railhil.bus.link.base.Link` of one node on the pipes of its run; classic frames, lockstep only.

    :param role: the node's name, one of :data:`~railhil.bus.packing.ROLES`.
    """

    @classmethod
    def opened(cls, opening: Opening) -> PipeLink:
        """Take the ends that this process has inherited.

        :raises BusUnavailable: there are none.
        """
        return cls(Ends.parse(str(opening.config["channel"])), opening.name, opening.say)

    def __init__(self, ends: Ends, role: str, say: Callable[[str], None] | None = None) -> None:
        super().__init__(cast(Any, _NoBus()), say)
        self._ends = ends
        self._is_plant = role == "plant"
        self._is_recorder = role == _SUPERVISOR
        # Inboxes whose writers have not ended.
        self._inboxes = [*ends.inboxes]
        sleep = ASLEEP if self._is_recorder else AWAKE
        self._spin_wait = SpinWait(ends.inboxes, moves=role == "controller", sleep=sleep)
        # The inboxes that frames go to at once, in this order; the plant's record waits.
        self._usual = [end for name, end in ends.others.items() if not self._is_plant or name != _SUPERVISOR]
        self._record = ends.others[_SUPERVISOR] if self._is_plant else -1
        self._answers = ends.inboxes[0] if self._is_plant else -1
        # Frames that the record does not have yet.
        self._held = b""
        self._asks: frozenset[bytes] = frozenset()
        if self._is_plant:
            self._asks = frozenset(map(pack_frame, supervisor_polls(house_contract())))
        self._gone: set[int] = set()

    @property
    def is_private(self) -> bool:
        """See :attr:`Link.is_private`; only processes that inherited the pipes can use them."""
        return True

    @property
    def packed(self) -> PackedEnd:
        """See :attr:`Link.packed`."""
        return self

    def send(self, frames: Sequence[Frame]) -> None:
        """See :meth:`Link.send`; without frames, the plant writes what the record does not have yet.

        :raises BusLost: as :meth:`send_packed`.
        """
        for packet in pack_frames(frames):
            self.send_packed(packet)
        if not frames:
            self._write_record()

    def send_packed(self, packet: bytes) -> None:
        """:meth:`send` of packed classic frames.

        :raises BusLost: the plant: no other node is left; a node has not read for too long.
        """
        while len(packet) > _WRITE_BYTES:
            self.send_packed(packet[:_WRITE_BYTES])
            packet = packet[_WRITE_BYTES:]
        self._noted(packet)
        for end in self._usual:
            self._put(end, packet)
        if self._is_plant:
            self._hold(packet)
            if packet[-CLASSIC_SIZE:] in self._asks:
                self._write_record()

    def send_early(self, packet: bytes) -> bool:
        """See :meth:`PackedEnd.send_early`; only while the plant is awake: then the controller has a processor of its
        own."""
        if not self._spin_wait.is_awake or len(packet) > _WRITE_BYTES:
            return False
        try:
            os.write(self._usual[0], packet)
        except (BlockingIOError, BrokenPipeError):
            # The write is atomic. If it fails, the frames are sent later.
            return False
        self._noted(packet)
        self._hold(packet)
        return True

    def _noted(self, packet: bytes) -> None:
        if self.sent is not None:
            self.sent.note_packed(packet)
        self.counters["sent"] += len(packet) // CLASSIC_SIZE

    def _hold(self, packet: bytes) -> None:
        """The plant's record is written with the next poll of the supervisor."""
        if len(self._held) + len(packet) > _WRITE_BYTES:
            self._write_record()
        # A read may return more than fits one write; a part of a longer write would be lost.
        while len(packet) > _WRITE_BYTES:
            self._held, packet = packet[:_WRITE_BYTES], packet[_WRITE_BYTES:]
            self._write_record()
        self._held += packet

    def _write_record(self) -> None:
        # The buffer is emptied first: a signal in the middle of writing ends the run, and its last event is recorded
        # afterwards.
        held, self._held = self._held, b""
        if held:
            self._put(self._record, held)

    def _put(self, end: int, packet: bytes) -> None:
        """Write to the inbox of another node."""
        try:
            os.write(end, packet)
        except BlockingIOError:
            self._write_later(end, packet)
        except BrokenPipeError:
            self._has_gone(end)

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """See :meth:`Link.receive`; all that has arrived.

        :raises BusLost: as :meth:`receive_packed`.
        """
        return unpack_frames(self.receive_packed(timeout_s))

    def receive_packed(self, timeout_s: float | None) -> bytes:
        """:meth:`receive`, as packed by the other nodes.

        :raises BusLost: no other node is left (not for the supervisor, which has started them), or the bytes received
            are not frames.
        """
        ready = self._spin_wait.wait(None if timeout_s is None else timeout_s * 1000)
        if not ready and self._held and timeout_s != 0:
            # No node can answer any more.
            self._write_record()
        arrived = b""
        for inbox, _ in ready:
            packet = self._read(inbox)
            if inbox == self._answers:
                self._hold(packet)
            arrived = arrived + packet if arrived else packet
        return arrived

    def _read(self, inbox: int) -> bytes:
        try:
            packet = os.read(inbox, _READ_BYTES)
        except BlockingIOError:
            return b""
        if not packet:
            # All its writers have ended.
            self._spin_wait.leave(inbox)
            self._inboxes.remove(inbox)
            if not self._inboxes and not self._is_recorder:
                raise self._lost("the other nodes have ended")
        if len(packet) % CLASSIC_SIZE:
            raise self._lost(f"{len(packet)} bytes read, allowed: frames of {CLASSIC_SIZE}")
        self.counters["received"] += len(packet) // CLASSIC_SIZE
        return packet

    def has_ended(self, node: str) -> bool:
        """See :meth:`Link.has_ended`; a node has ended when no process reads its inbox, and all frames that it sent are
        read."""
        if super().has_ended(node):
            return True
        end = self._ends.others.get(node)
        if end is None:
            return False
        poller = select.poll()
        poller.register(end, 0)
        if not poller.poll(0):
            return False
        return not select.select(self._inboxes, (), (), 0.0)[0]

    def close(self) -> None:
        """See :meth:`Link.close`; frames that were sent are in the pipes."""
        with contextlib.suppress(BusLost, OSError):
            # No process reads the record any more.
            self._write_record()
        for end in self._ends.descriptors:
            with contextlib.suppress(OSError):
                # Closed before.
                os.close(end)

    def _write_later(self, end: int, packet: bytes) -> None:
        """Write to an inbox that is full."""
        self.counters["send_retries"] += 1
        poller = select.poll()
        poller.register(end, select.POLLOUT)
        give_up_s = time.monotonic() + PATIENCE_S
        while time.monotonic() < give_up_s:
            self.while_waiting()
            if not poller.poll(_LOOK_MS):
                continue
            try:
                os.write(end, packet)
                return
            except BlockingIOError:
                # There is room for a part of the packet only.
                time.sleep(_LOOK_MS / 1000)
            except BrokenPipeError:
                self._has_gone(end)
                return
        raise self._lost(f"cannot send: {self._name_of(end)} has not read for {PATIENCE_S:g} s")

    def _name_of(self, end: int) -> str:
        return next(name for name, other in self._ends.others.items() if other == end)

    def _has_gone(self, end: int) -> None:
        """A node that has ended takes nothing; a node that waits for it asks :meth:`has_ended`."""
        self._gone.add(end)
        if self._is_plant and len(self._gone) == len(self._ends.others):
            raise self._lost("cannot send: the other nodes have ended")
