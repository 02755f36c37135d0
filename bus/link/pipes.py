"""The link between the processes of one run: one pipe to each node, no switch between them.

Each node reads one pipe, its inbox; the two others write to it. A write of at most PIPE_BUF bytes is atomic, so frames
of two writers do not mix, and what one has written before it lets another act is read before what that one writes
then: in lockstep, where one node acts at a time, all inboxes have the same order. The supervisor's is the record; it
is written to before any node that can answer, and what is in it outlives its writer.

Nobody answers the plant's telegrams, so they may go to the controller before (:attr:`PipeLink.ahead`): it takes them in
while the plant makes the next. The record has them with the poll that follows; a plant that is killed in between takes
those of its last tick with it.

The pipes have no name: only processes that inherited them can use them, and the kernel removes them with the last one.
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import select
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, NamedTuple, cast

from railhil.bus.errors import BusUnavailable
from railhil.bus.frame import Frame
from railhil.bus.hub.wire import CLASSIC_SIZE, ROLES, pack_frame, pack_frames, unpack_frames
from railhil.bus.ident import Role, SupIdent
from railhil.bus.link.base import Link
from railhil.bus.link.turn import Turn
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame
from railhil.bus.select import PIPES
from railhil.bus.telegrams import SupCmd
from railhil.common.mypyc import mypyc_attr
from railhil.common.patience import PATIENCE_S
from railhil.dbc import wire_contract

_SUPERVISOR: Final = "supervisor"
#: Largest read; a multiple of the size of a frame.
_READ_BYTES: Final = 1 << 16
#: Requested size of the supervisor's inbox: it is read in bulk.
_RECORD_BYTES: Final = 1 << 20
#: Interval at which a node that waits for room looks whether it shall stop.
_LOOK_MS: Final = 100


def supervisor_polls() -> frozenset[bytes]:
    """The packed frames that the supervisor answers; it is woken for these alone."""
    contract = wire_contract()
    ports = (contract.port(name) for name in (SupCmd.PORT, SupIdent.PORT))
    polls = [master_frame(port.f_code, port.address) for port in ports]
    return frozenset(map(pack_frame, (*polls, master_frame(F_DEVICE_STATUS, Role.SUPERVISOR))))


class Ends(NamedTuple):
    """What one node holds: its inbox, the inboxes of the others by name, and the supervisor's bell."""

    inbox: int
    others: Mapping[str, int]
    bell: int

    @property
    def descriptors(self) -> tuple[int, ...]:
        """All descriptors."""
        return (self.inbox, *self.others.values(), self.bell)

    @property
    def channel(self) -> str:
        """The channel on a node's command line."""
        others = ",".join(f"{name}={end}" for name, end in self.others.items())
        return f"{PIPES}:{self.inbox},{others},{self.bell}"

    @classmethod
    def parse(cls, channel: str) -> Ends:
        """The ends that a channel names.

        :raises BusUnavailable: it names none, or this process has not inherited them.
        """
        try:
            first, *others, last = channel.partition(":")[2].split(",")
            named = {name: int(end) for name, _, end in (other.partition("=") for other in others)}
            ends = cls(int(first), named, int(last))
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
            made = {role: self._made(os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)) for role in ROLES}
            (bell,) = self._made((os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC),))
        except OSError as error:
            self.close()
            raise BusUnavailable(f"pipes between the nodes: {(error.strerror or str(error)).lower()}") from None
        with contextlib.suppress(OSError):
            # The limit of a user's pipes may be reached; the default size is enough.
            fcntl.fcntl(made[_SUPERVISOR][1], fcntl.F_SETPIPE_SZ, _RECORD_BYTES)
        #: For each node, its ends.
        self.ends = {
            role: Ends(made[role][0], {other: made[other][1] for other in ROLES if other != role}, bell)
            for role in ROLES
        }

    def _made(self, ends: tuple[int, ...]) -> tuple[int, ...]:
        self._open.update(ends)
        return ends

    def handed_over(self, role: str) -> None:
        """A node has been started: its inbox is now its own, so that its end can be noticed."""
        self._close(self.ends[role].inbox)

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
        """Close what is still held."""
        for end in tuple(self._open):
            self._close(end)


class _NoBus:
    """What :class:`Link` needs of its python-can bus."""

    channel_info = "pipes of this run"

    def shutdown(self) -> None:
        """Nothing beside the descriptors."""


@mypyc_attr(allow_interpreted_subclasses=True)
class PipeLink(Link):
    """:class:`~railhil.bus.link.base.Link` of one node on the pipes of its run; classic frames, lockstep only.

    :param role: the node's name, one of :data:`~railhil.bus.hub.wire.ROLES`.
    """

    def __init__(self, ends: Ends, role: str, say: Callable[[str], None] | None = None) -> None:
        super().__init__(cast(Any, _NoBus()), say)
        self._ends = ends
        self._bell = ends.bell
        self._is_recorder = role == _SUPERVISOR
        poller = select.poll()
        poller.register(ends.bell, select.POLLIN)
        self._rung = poller.poll
        self._turn = Turn(ends.inbox, moves=role == "controller")
        others = dict(ends.others)
        # The bus administrator acts on every answer: its inbox comes last.
        last = "plant" if role != "plant" else "controller"
        self._usual = [others[name] for name in sorted(others, key=lambda name: (name == last, name))]
        # Who answers is written to last, or its answer could overtake the poll.
        self._asking = self._usual[::-1]
        self._record = others.get(_SUPERVISOR, -1)
        # What the controller got ahead of the record.
        self._held = b""
        self._asks = supervisor_polls() if role == "plant" else frozenset()
        self._is_plant = role == "plant"
        self._gone: set[int] = set()

    @property
    def is_private(self) -> bool:
        """See :attr:`Link.is_private`; only processes that inherited the pipes can use them."""
        return True

    def send(self, frames: Sequence[Frame]) -> None:
        """See :meth:`Link.send`.

        :raises BusLost: no other node is left, or one has not read for too long.
        """
        if self.sent is not None:
            self.sent.note(frames)
        held, self._held = self._held, b""
        for packet in pack_frames(frames) or ([b""] if held else []):
            asks = packet[-CLASSIC_SIZE:] in self._asks
            for end in self._asking if asks else self._usual:
                if not held or end != self._record:
                    self._put(end, packet)
                elif len(held) + len(packet) <= select.PIPE_BUF:
                    self._put(end, held + packet)
                else:
                    self._put(end, held)
                    self._put(end, packet)
            held = b""
            if asks:
                os.eventfd_write(self._bell, 1)
        self.counters["sent"] += len(frames)

    @property
    def ahead(self) -> Callable[[Sequence[Frame]], bool] | None:
        """See :attr:`Link.ahead`; only while the plant is awake, for then the controller has a processor of its own."""
        return self._ahead if self._is_plant else None

    def _ahead(self, frames: Sequence[Frame]) -> bool:
        packet = b"".join(pack_frames(frames))
        if not self._turn.is_awake or len(self._held) + len(packet) > select.PIPE_BUF:
            return False
        try:
            os.write(self._usual[-1], packet)
        except (BlockingIOError, BrokenPipeError):
            # As a whole or not at all: what comes of it is decided when they are sent.
            return False
        if self.sent is not None:
            self.sent.note(frames)
        self._held += packet
        self.counters["sent"] += len(frames)
        return True

    def _put(self, end: int, packet: bytes) -> None:
        """Write to the inbox of another node."""
        try:
            os.write(end, packet)
        except BlockingIOError:
            self._write_later(end, packet)
        except BrokenPipeError:
            self._has_gone(end)

    def offer(self, frames: Sequence[Frame]) -> int:
        """See :meth:`Link.offer`; all are accepted."""
        self.send(frames)
        return len(frames)

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """See :meth:`Link.receive`; all that has arrived.

        :raises BusLost: as :meth:`receive_packed`.
        """
        return unpack_frames(self.receive_packed(timeout_s))

    @property
    def packed(self) -> Callable[[float | None], bytes] | None:
        """See :attr:`Link.packed`."""
        return self.receive_packed

    def receive_packed(self, timeout_s: float | None) -> bytes:
        """:meth:`receive`, as packed by the other nodes.

        :raises BusLost: no other node is left (not for the supervisor, which has started them), or what has arrived is
            not made of frames.
        """
        timeout_ms = None if timeout_s is None else timeout_s * 1000
        if self._is_recorder:
            if self._rung(timeout_ms):
                os.eventfd_read(self._bell)
        elif not self._turn.wait(timeout_ms):
            return b""
        try:
            packet = os.read(self._ends.inbox, _READ_BYTES)
        except BlockingIOError:
            return b""
        if not packet and not self._is_recorder:
            raise self._lost("the other nodes have ended")
        if len(packet) % CLASSIC_SIZE:
            raise self._lost(f"{len(packet)} bytes read, allowed: frames of {CLASSIC_SIZE}")
        self.counters["received"] += len(packet) // CLASSIC_SIZE
        return packet

    def has_ended(self, node: str) -> bool:
        """See :meth:`Link.has_ended`; a node has ended when nobody reads its inbox, and all that it sent is read."""
        if super().has_ended(node):
            return True
        end = self._ends.others.get(node)
        if end is None:
            return False
        poller = select.poll()
        poller.register(end, 0)
        if not poller.poll(0):
            return False
        return not select.select((self._ends.inbox,), (), (), 0.0)[0]

    def close(self) -> None:
        """See :meth:`Link.close`; what was sent is in the pipes."""
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
                # Room for less than the packet.
                time.sleep(_LOOK_MS / 1000)
            except BrokenPipeError:
                self._has_gone(end)
                return
        raise self._lost(f"cannot send: {self._name_of(end)} has not read for {PATIENCE_S:g} s")

    def _name_of(self, end: int) -> str:
        return next(name for name, other in self._ends.others.items() if other == end)

    def _has_gone(self, end: int) -> None:
        """A node that has ended takes nothing; who waits for it asks :meth:`has_ended`."""
        self._gone.add(end)
        if len(self._gone) == len(self._ends.others) and not self._is_recorder:
            raise self._lost("cannot send: the other nodes have ended")
