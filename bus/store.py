"""Traffic store: CAN frames in, complete checked telegrams out, with their age.

The receiving rules of the MVB-on-CAN mapping: blocks are staged per port. They are committed when the trailer comes, if
all blocks have arrived since the last trailer and within ``assembly_ns`` of it, and if count, F_code, address and every
check sequence are correct. Otherwise the whole telegram is dropped, the cause is counted, and the old value keeps
ageing. A repeated block replaces the earlier one and its time, so blocks left over from one telegram, or stray ones, do
not affect the next.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Final, NamedTuple, TypeVar

from railhil.bus.frame import ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.layout import Telegram
from railhil.bus.mvb import check_sequence, master_tail, single_frame_fault
from railhil.dbc import Port

#: Age of a port that has never received anything (freshness timer 65535 ms of an MVB link layer).
NEVER_NS: Final = 65_535_000_000
#: All blocks of a telegram must arrive within this time (simulation time in lockstep).
ASSEMBLY_NS: Final = 5_000_000

T = TypeVar("T", bound=Telegram)

#: Causes for which a frame or telegram is not accepted, as they appear in ``TrafficStore.counters``.
CAUSES = (
    "error_frame",
    "remote_frame",
    "extended_id",
    "unknown_id",
    "wrong_length",
    "wrong_check_sequence",
    "wrong_master_word",
    "wrong_block_count",
    "missing_block",
    "assembly_timeout",
)


class _Sink:
    """Receiving side of one port."""

    __slots__ = (
        "accepted", "block_count", "blocks", "committed_ns", "data", "data_bytes", "fd_bytes", "is_single", "missing",
        "name", "tail", "times_ns",
    )  # fmt: skip

    def __init__(self, port: Port) -> None:
        self.name = port.name
        self.data_bytes = port.data_bytes
        self.is_single = port.single_frame
        self.block_count = port.blocks
        self.tail = master_tail(port.f_code, port.address)
        self.fd_bytes = port.data_bytes + 8
        if port.single_frame:
            self.fd_bytes = 8
        elif port.f_code == 4:
            # 40 bytes is not a valid CAN FD length.
            self.fd_bytes = -(-self.fd_bytes // 16) * 16
        # Blocks of the telegram being received; the number still missing, and the times of the others.
        self.blocks = [b""] * port.blocks
        self.times_ns = [0] * port.blocks
        self.missing = port.blocks
        self.data = b""
        self.committed_ns = -1
        self.accepted = 0


class FrameCheck(NamedTuple):
    """The check of a single frame: kind, identifier, length and, for a complete telegram, check sequence.

    ``cause``: cause of refusal, one of :data:`CAUSES`; empty for a good frame. A good frame is ``part`` of the telegram
    of ``sink``: the number of the block, -1 the trailer, -3 the CAN FD form.
    """

    cause: str
    sink: _Sink | None = None
    part: int = 0


_REFUSED: Final = {cause: FrameCheck(cause) for cause in CAUSES}
_UNKNOWN_ID: Final = _REFUSED["unknown_id"]


class TrafficStore:
    """Mailboxes for the ports of one node.

    A port that is not in ``ports`` has no mailbox: its frames are counted as ``unknown_id`` and never decoded.
    No content of a frame raises an exception here.
    """

    def __init__(self, ports: Iterable[Port], assembly_ns: int = ASSEMBLY_NS) -> None:
        self.counters: Counter[str] = Counter()
        self._assembly_ns = assembly_ns
        self._sinks: dict[str, _Sink] = {}
        # CAN identifier -> the check of a good frame.
        self._by_id: dict[int, FrameCheck] = {}
        for port in ports:
            sink = _Sink(port)
            self._sinks[port.name] = sink
            for block in range(port.blocks):
                self._by_id[port.address + block] = FrameCheck("", sink, block)
            if not port.single_frame:
                self._by_id[port.address + 4] = FrameCheck("", sink, -1)
            self._by_id[port.fd_id] = FrameCheck("", sink, -3)

    def feed(self, frame: Frame, now_ns: int, checked: FrameCheck | None = None) -> str | None:
        """Take one frame at time ``now_ns``; returns the name of the port whose telegram it completed, else None.

        :param checked: result of :meth:`check`, if the frame was already checked.
        """
        cause, sink, part = checked or self.check(frame)
        if sink is None:
            return self._reject(cause)
        data = frame.data
        if sink.is_single:
            return self._commit(sink, data[: sink.data_bytes], now_ns)
        if part == -1:
            return self._commit_blocks(sink, data, now_ns)
        if part == -3:
            size = sink.data_bytes
            sink.blocks = [data[k : k + 8] for k in range(0, size, 8)]
            sink.missing = 0
            sink.times_ns = [now_ns] * sink.block_count
            return self._commit_blocks(sink, data[size : size + 8], now_ns)
        if not sink.blocks[part]:
            sink.missing -= 1
        sink.blocks[part] = data
        sink.times_ns[part] = now_ns
        return None

    def check(self, frame: Frame) -> FrameCheck:
        """Check a single frame; nothing is counted or stored before :meth:`feed`."""
        can_id, data, flags = frame
        if flags:
            if flags & ERROR:
                return _REFUSED["error_frame"]
            if flags & REMOTE:
                return _REFUSED["remote_frame"]
            if flags & EXTENDED:
                return _REFUSED["extended_id"]
        found = self._by_id.get(can_id, _UNKNOWN_ID)
        _, sink, part = found
        if sink is None:
            return found
        if part == -3:
            if not flags & FD or len(data) != sink.fd_bytes:
                return _REFUSED["wrong_length"]
        elif flags or len(data) != 8:
            return _REFUSED["wrong_length"]
        if sink.is_single:
            cause = single_frame_fault(data, sink.data_bytes, sink.tail)
            if cause:
                return _REFUSED[cause]
        return found

    def _reject(self, cause: str) -> str | None:
        self.counters[cause] += 1
        return None

    def _commit_blocks(self, sink: _Sink, trailer: bytes, now_ns: int) -> str | None:
        blocks, count, missing = sink.blocks, sink.block_count, sink.missing
        sink.blocks = [b""] * count
        sink.missing = count
        if missing:
            return self._reject("missing_block")
        # Blocks that waited in mailboxes are fed in the order of the blocks, not of their arrival.
        times_ns = sink.times_ns
        if times_ns.count(now_ns) != count and max(now_ns, *times_ns) - min(now_ns, *times_ns) > self._assembly_ns:
            return self._reject("assembly_timeout")
        if trailer[4] & 0xF != count:
            return self._reject("wrong_block_count")
        if trailer[5:] != sink.tail:
            return self._reject("wrong_master_word")
        if bytes(map(check_sequence, blocks)) != trailer[:count]:
            return self._reject("wrong_check_sequence")
        return self._commit(sink, b"".join(blocks), now_ns)

    def _commit(self, sink: _Sink, data: bytes, now_ns: int) -> str:
        sink.data = data
        sink.committed_ns = now_ns
        sink.accepted += 1
        return sink.name

    def read(self, telegram: type[T], now_ns: int, port: str = "") -> tuple[T | None, int]:
        """Newest telegram of a port and its age in ns: ``(None, NEVER_NS)`` before the first one.

        :param port: another port with this layout; default: the telegram's own.
        :raises KeyError: when this node has no mailbox for the port.
        """
        sink = self._sinks[port or telegram.PORT]
        if sink.committed_ns < 0:
            return None, NEVER_NS
        return telegram.decode(sink.data), now_ns - sink.committed_ns

    def raw(self, port: str) -> bytes:
        """Process data of the newest telegram of a port, empty before the first; KeyError without a mailbox."""
        return self._sinks[port].data

    def accepted(self, port: str) -> int:
        """Number of telegrams committed for a port since the start; KeyError without a mailbox."""
        return self._sinks[port].accepted

    @property
    def is_empty(self) -> bool:
        """Whether no port has blocks of an incomplete telegram."""
        return all(sink.missing == sink.block_count for sink in self._sinks.values())

    @property
    def ports(self) -> tuple[str, ...]:
        """Names of the ports with a mailbox."""
        return tuple(self._sinks)
