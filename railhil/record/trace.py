"""The telegrams of a run as arrays, from which the score, the table of signals and the plots are computed."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.bus.frame import Frame
from railhil.bus.ident import Ident
from railhil.bus.mvb import master_tail, parse_master_frame
from railhil.bus.own_frames import OwnFrames
from railhil.bus.store import TrafficStore
from railhil.common.mypyc import mypyc_attr
from railhil.dbc import Contract, Signal

FloatArray: TypeAlias = npt.NDArray[np.float64]
#: Source of refused frames that belong to no port.
BUS: Final = "bus"
#: Up to this number, telegrams are decoded faster one by one than as arrays.
_FEW: Final = 12
_NO_WORDS: Final[list[int]] = []
#: Causes that say nothing about the port whose identifier the frame may have.
_OF_THE_BUS: Final = ("error_frame", "remote_frame", "extended_id")


class Noted(NamedTuple):
    """A telegram or frame that was refused, or a poll that was missed: its time, port and cause."""

    time_ns: int
    source: str
    cause: str


class Telegrams(NamedTuple):
    """Telegrams of one port: times in ns, shape (n,); place of each among all telegrams taken together, shape (n,);
    process data, joined."""

    port: str
    times_ns: npt.NDArray[np.int64]
    order: npt.NDArray[np.int64]
    data: bytes


class NodeCounters(NamedTuple):
    """The nodes' own counts of telegrams received (:mod:`railhil.bus.reception`), by node.

    ``exact``: the record and the nodes have got the same frames, except those that an injected fault kept from a node.
    """

    exact: bool
    nodes: Mapping[str, Mapping[str, Any]]

    def as_json(self) -> dict[str, Any]:
        """As in ``certificate.json``."""
        return {"exact": self.exact, "nodes": dict(self.nodes)}


@mypyc_attr(allow_interpreted_subclasses=True)
class Trace:
    """Committed telegrams per port, with the simulation time of each.

    Raw process data are kept as received (16 to 40 bytes per telegram) and decoded together on request.
    """

    def __init__(self, contract: Contract) -> None:
        #: Wire contract of the telegrams.
        self.contract = contract
        self._times_ns: dict[str, array[int]] = {}
        self._order: dict[str, array[int]] = {}
        self._added = 0
        self._data: dict[str, bytearray] = {}
        #: The telegrams found by :meth:`ident`, with their data; a trace that continues another takes them over.
        self.idents: dict[type[Ident], tuple[bytes, Ident | None]] = {}
        #: The telegrams of a port as whole numbers, from which the signals are extracted while there are few telegrams.
        self._words: dict[str, list[int]] = {}
        #: Frames in the record that do not belong to the contract.
        self.foreign = 0
        #: Polls in the record.
        self.polls = 0
        #: Refused frames and telegrams, in the order of the record.
        self.refused: list[Noted] = []
        #: Empty frames, with which a source says that it does not answer.
        self.no_answers: list[Noted] = []
        #: The nodes' own counts; None: unknown.
        self.reported: NodeCounters | None = None
        #: Time of the last frame, in ns.
        self.end_ns = 0
        self._missed: list[Noted] = []
        # Ports whose last poll has no good answer yet, with its time and the fault of the answer.
        self._awaited: dict[str, Noted] = {}

    @property
    def missed_polls(self) -> int:
        """Polls without a good telegram before the port was polled again or the record ended."""
        return len(self._missed) + len(self._awaited)

    @property
    def missed(self) -> list[Noted]:
        """The missed polls, with the cause ``no_answer`` or ``answer_refused``."""
        return [*self._missed, *self._awaited.values()]

    @property
    def end_s(self) -> float:
        """Time of the last frame, in s."""
        return self.end_ns / 1e9

    def polled(self, port: str, time_ns: int) -> None:
        """Take a poll of a port."""
        self.polls += 1
        if port in self._awaited:
            self._missed.append(self._awaited[port])
        self._awaited[port] = Noted(time_ns, port, "no_answer")

    def refuse(self, source: str, time_ns: int, cause: str) -> None:
        """Note a refused frame or telegram."""
        self.refused.append(Noted(time_ns, source, cause))
        if source in self._awaited:
            self._awaited[source] = self._awaited[source]._replace(cause="answer_refused")

    def add(self, port: str, time_ns: int, data: bytes) -> None:
        """Append one telegram."""
        times_ns = self._times_ns.get(port)
        if times_ns is None:
            times_ns = self._times_ns[port] = array("q")
            self._order[port] = array("q")
            self._data[port] = bytearray()
        times_ns.append(time_ns)
        self._order[port].append(self._added)
        self._added += 1
        self._awaited.pop(port, None)
        self._data[port] += data

    def take_whole(self, telegrams: Iterable[Telegrams], polls: int, awaited: Iterable[Noted]) -> None:
        """As :meth:`polled` and :meth:`add`, for frames without a refused one or a missed poll.

        :param telegrams: in the order in which the first of each port is complete.
        :param polls: how many there are.
        :param awaited: the last polls without an answer, in their order.
        """
        added = 0
        for port, times_ns, order, data in telegrams:
            if port not in self._times_ns:
                self._times_ns[port], self._order[port], self._data[port] = array("q"), array("q"), bytearray()
            self._times_ns[port].frombytes(times_ns.tobytes())
            self._order[port].frombytes((order + self._added).tobytes())
            self._data[port] += data
            self._awaited.pop(port, None)
            added += len(times_ns)
        self._added += added
        self.polls += polls
        self._awaited |= {noted.source: noted for noted in awaited}

    def is_awaited(self, port: str) -> bool:
        """Whether the last poll of a port has no good answer yet."""
        return port in self._awaited

    def count(self, port: str) -> int:
        """Number of telegrams of a port."""
        return len(self._times_ns.get(port, ()))

    def times_ns(self, port: str) -> array[int]:
        """Simulation time of each telegram of a port in ns, shape (n,)."""
        return self._times_ns.get(port, array("q"))

    def order(self, port: str) -> npt.NDArray[np.int64]:
        """Place of each telegram of a port among all telegrams of the record, shape (n,).

        It gives the order of two telegrams of the same instant.
        """
        return np.array(self._order.get(port, ()), dtype=np.int64)

    def times_s(self, port: str) -> FloatArray:
        """Simulation time of each telegram of a port in s, shape (n,)."""
        return np.array(self.times_ns(port), dtype=np.int64) / 1e9

    def has(self, port: str, signal: str) -> bool:
        """Whether the contract of the record has this signal; an earlier version may lack it."""
        return self.contract.has(port, signal)

    def word(self, port: str, signal: str, raw: int) -> str:
        """A raw value as the wire contract names it, else as a number; KeyError for an unknown port or signal."""
        return self._signal(port, signal).values.get(raw, str(raw))

    def _signal(self, port: str, signal: str) -> Signal:
        try:
            return self.contract.port(port).signal(signal)
        except KeyError:
            raise KeyError(f"{port}.{signal}") from None

    def numbers(self, port: str, signal: str) -> npt.NDArray[np.int64] | FloatArray:
        """Raw values of a signal without a scale, else physical ones, shape (n,)."""
        return (self.raw if self._signal(port, signal).scale == 1 else self.values)(port, signal)

    def raw(self, port: str, signal: str) -> npt.NDArray[np.int64]:
        """Raw values of a signal, shape (n,); KeyError for an unknown port or signal."""
        found = self._signal(port, signal)
        if len(self._times_ns.get(port, ())) <= _FEW:
            return np.array(self._few(port, signal), dtype=np.int64)
        entry = self.contract.port(port)
        data = np.frombuffer(bytes(self._data.get(port, b"")), dtype=np.uint8).reshape(-1, entry.data_bytes)
        width = min(entry.data_bytes, 8)
        block = data[:, found.block * 8 : found.block * 8 + width].astype(np.uint64)
        word = np.zeros(len(block), dtype=np.uint64)
        for column in range(width):
            word = (word << np.uint64(8)) | block[:, column]
        shift = width * 8 - (found.first_bit - found.block * 64) - found.length
        values = ((word >> np.uint64(shift)) & np.uint64((1 << found.length) - 1)).astype(np.int64)
        if found.signed:
            sign = np.int64(1 << (found.length - 1))
            values = (values ^ sign) - sign
        return values

    def _few(self, port: str, signal: str) -> list[int]:
        """As :meth:`raw`, one telegram after the other: for a panel, which decodes a few telegrams many times."""
        entry = self.contract.port(port)
        words = self._words.get(port, _NO_WORDS)
        if len(words) != self.count(port):
            data, size = self._data[port], entry.data_bytes
            words = self._words[port] = [int.from_bytes(data[at : at + size]) for at in range(0, len(data), size)]
        shift, mask, most = entry.cut(signal)
        found = [word >> shift & mask for word in words]
        return found if most == mask else [raw - mask - 1 if raw > most else raw for raw in found]

    def values(self, port: str, signal: str) -> FloatArray:
        """Physical values of a signal (raw * scale, in the unit of the port table), shape (n,)."""
        scale = self._signal(port, signal).scale
        return np.asarray(self.raw(port, signal) * scale, dtype=np.float64)

    def ident(self, telegram: type[Ident]) -> Ident | None:
        """First handshake telegram of a node, None when it is not in the record."""
        data = bytes(self._data.get(telegram.PORT, b""))
        known = self.idents.get(telegram)
        if known is None or known[0] != data:
            known = self.idents[telegram] = data, self._ident(telegram)
        return known[1]

    def _ident(self, telegram: type[Ident]) -> Ident | None:
        known = {entry.name for entry in self.contract.port(telegram.PORT).signals}
        columns = {
            name: self.raw(telegram.PORT, signal.name).tolist()
            for name, signal in telegram.signals()
            if signal.name in known
        }
        idents = (
            telegram(**{name: values[index] for name, values in columns.items()})
            for index in range(self.count(telegram.PORT))
        )
        return next((ident for ident in idents if ident.is_own), None)


class TraceReader:
    """Makes a trace of recorded frames in bus order, in one part or in several.

    :param contract: the one used for recording.
    """

    def __init__(self, contract: Contract) -> None:
        self.trace = Trace(contract)
        self._ports = contract
        self._own = OwnFrames(contract)
        self._store = TrafficStore(contract.ports)
        polled = [port for port in contract.ports if port.mode == "poll"]
        self._polls = {master_tail(port.f_code, port.address): port.name for port in polled}
        self._silences = {port.can_ids[-1]: port.name for port in polled}
        self._names = {can_id: port.name for port in contract.ports for can_id in (*port.can_ids, port.fd_id)}
        self._counted = Counter(self._store.counters)

    @property
    def is_between_telegrams(self) -> bool:
        """False while blocks of an incomplete telegram are kept."""
        return self._store.is_empty

    def take(self, frames: Iterable[tuple[int, Frame]]) -> None:
        """Take frames ``(time_ns, frame)``."""
        trace, store, counted = self.trace, self._store, self._counted
        polls, silences, names, own = self._polls, self._silences, self._names, self._own
        poll_id, check, feed = self._ports.poll_id, store.check, store.feed
        time_ns = trace.end_ns
        for time_ns, frame in frames:
            can_id, data, flags = frame
            is_own = frame in own
            trace.foreign += not is_own
            if can_id == poll_id and is_own:
                if (asked := polls.get(data)) is not None:
                    trace.polled(asked, time_ns)
                elif parse_master_frame(data) is None:
                    trace.refuse(BUS, time_ns, "wrong_master_word")
                continue
            checked = check(frame)
            port = feed(frame, time_ns, checked)
            if port is not None:
                trace.add(port, time_ns, store.raw(port))
            elif checked.cause or checked.part < 0:
                # A block that only waits for its trailer is not refused.
                cause = checked.cause or next(iter(store.counters - counted))
                counted[cause] += 1
                if not data and not flags and can_id in silences:
                    trace.no_answers.append(Noted(time_ns, silences[can_id], "no_answer"))
                    continue
                source = names.get(can_id, f"{BUS} {can_id:03X}") if cause not in _OF_THE_BUS else BUS
                trace.refuse(source, time_ns, cause)
        trace.end_ns = time_ns


def trace_of(frames: Iterable[tuple[int, Frame]], contract: Contract) -> Trace:
    """Trace of recorded frames ``(time_ns, frame)`` in bus order; :func:`railhil.record.log_trace.trace_of_log`
    does the same for a log, in less time.

    :param contract: the one used for recording.
    """
    reader = TraceReader(contract)
    reader.take(frames)
    return reader.trace
