"""Bus administrator: publishes its own ports on their period and polls the ports of the others.

In lockstep it waits for every answer, so simulation time stops until all nodes have answered.
:mod:`railhil.common.patience` limits the wait. In real time an answer later than ``reply_ns`` is a missed telegram, and
the old value ages.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Final

from railhil.bus.clock import Pacer
from railhil.bus.errors import OTHER_ADMINISTRATOR, BusOccupied, PeerSilent
from railhil.bus.frame import ERROR, Frame
from railhil.bus.ident import Role
from railhil.bus.layout import Telegram
from railhil.bus.link import Endpoint
from railhil.bus.link.base import PackedEnd
from railhil.bus.mvb import (
    F_DEVICE_STATUS,
    TelegramSource,
    device_status_fault,
    master_frame,
    parse_device_status,
)
from railhil.bus.own_frames import OwnFrames
from railhil.bus.packing import pack_frame
from railhil.bus.store import TrafficStore
from railhil.common.patience import PATIENCE_S
from railhil.dbc import Contract, Port

#: Reply time-out in real time (the MVB's 42.7 us cannot be met on CAN).
REPLY_NS: Final = 5_000_000
#: How long to listen for further answers to one device status poll once every device has answered.
_SCAN_ANSWER_S: Final = 0.03
#: Wait on a private bus for the answers to all polls of the scan, after the first answer of each node.
_LATE_ANSWER_NS: Final = 1_000_000_000
#: Lockstep: interval at which to check whether the awaited node has ended.
_LOOK_NS: Final = 100_000_000


class SendQueue:
    """Output of the administrator, in order: the telegrams that it publishes, and polls. A poll sends everything before
    it.

    :param contract: wire contract of the run's system; the administrator publishes the ports of the plant.
    :param fd: send the CAN FD form.
    :param realtime: nothing is sent early.
    :param send_early: passes published telegrams on before they are sent, and returns False when it cannot now. None:
        published telegrams wait for the next ``flush`` or poll.
    :param packed: endpoint for packed frames. In lockstep it sends all frames of the run, and its own ``send_early``
        takes the published telegrams.
    :param unread: port that no node reads before the end of the run; it is passed on with the next telegram or poll.
    """

    def __init__(
        self,
        endpoint: Endpoint,
        contract: Contract,
        *,
        fd: bool = False,
        realtime: bool = False,
        send_early: Callable[[Sequence[Frame]], bool] | None = None,
        packed: PackedEnd | None = None,
        unread: str = "",
    ) -> None:
        self._endpoint = endpoint
        self._sources = {port.name: TelegramSource(port, fd) for port in contract.ports if port.source == "plant"}
        self._queue: list[Frame] = []
        self._send_early = None if realtime else send_early
        self._packed = None if realtime else packed
        # Instead of the queue.
        self._packet = b""
        self._polls = {port.name: pack_frame(master_frame(port.f_code, port.address)) for port in contract.ports}
        self._unread = unread

    def publish(self, telegram: Telegram) -> None:
        """Queue one telegram; it is sent with the next ``flush`` or poll."""
        packed = self._packed
        if packed is not None:
            packet = self._packet + self._sources[telegram.PORT].packed(telegram.encode())
            # Emptied first, as below.
            self._packet = b""
            if self._unread == telegram.PORT or not packed.send_early(packet):
                self._packet = packet
            return
        self._queue.extend(self._sources[telegram.PORT].frames(telegram.encode()))
        if self._send_early is not None and self._unread != telegram.PORT:
            # Emptied first, as below.
            queue, self._queue = self._queue, []
            if not self._send_early(queue):
                self._queue = queue

    def flush(self) -> None:
        """Send the queue."""
        # The queue is emptied first: a signal in the middle of sending ends the run and sends its last event
        # afterwards. The frames of this queue must not go out twice.
        if packet := self._packet:
            assert self._packed is not None
            self._packet = b""
            self._packed.send_packed(packet)
        if queue := self._queue:
            self._queue = []
            self._endpoint.send(queue)

    def poll(self, port: Port) -> None:
        """Send the queue, and the poll of a port after it."""
        if self._packed is not None:
            self._packet += self._polls[port.name]
        else:
            self._queue.append(master_frame(port.f_code, port.address))
        self.flush()


class Administrator:
    """Master of the bus on one endpoint.

    :param store: mailboxes for the ports that are polled.
    :param queue: sends telegrams and polls on the same endpoint.
    :param now_ns: returns the simulation time; called at each reception.
    :param pacer: pace of the run, and the wall clock for all time-outs.
    :param contract: wire contract of the run's system.
    :param reply_ns: real time: wall time after which an answer is too late.
    :param patience_s: lockstep: wall time for an answer whose owner is not known to have ended.
    """

    def __init__(
        self,
        endpoint: Endpoint,
        store: TrafficStore,
        queue: SendQueue,
        now_ns: Callable[[], int],
        pacer: Pacer,
        contract: Contract,
        *,
        reply_ns: int = REPLY_NS,
        patience_s: float = PATIENCE_S,
    ) -> None:
        self.counters: Counter[str] = Counter()
        #: Answers to the device status that were refused, by the reason in words.
        self.refused_status: Counter[str] = Counter()
        self.queue = queue
        self._endpoint = endpoint
        self.store = store
        self._now_ns = now_ns
        self._pacer = pacer
        self._monotonic_ns = pacer.wall.monotonic_ns
        self._contract = contract
        self._own = OwnFrames(contract)
        # Identifiers of the frame that completes a telegram, for classic CAN and CAN FD.
        self._last_ids = {port.name: (port.can_ids[-1], port.fd_id) for port in contract.ports}
        self._patience_ns = round(patience_s * 1e9)
        self._reply_ns = reply_ns

    def poll(self, port: Port) -> bool:
        """Ask the owner of a port for its telegram.

        Lockstep waits for the answer; real time gives up after the reply time-out. In both, an answer that the store
        refuses (damaged in transit) is a missed telegram.

        :returns: True when the answer was committed to the store, False for a missed one.
        :raises PeerSilent: in lockstep, when the owner has ended or the patience is exhausted.
        """
        self.counters["polls"] += 1
        if self._pacer.rate:
            self._discard_late()
        self.queue.poll(port)
        committed = self._in_time(port) if self._pacer.rate else self._awaited(port)
        if committed:
            return True
        self.counters["missed_polls"] += 1
        if committed is None and not self._pacer.rate:
            has_ended = self._endpoint.has_ended(port.source)
            why = "which has ended" if has_ended else f"for {self._patience_ns / 1e9:g} s"
            raise PeerSilent(
                f"bus administrator waits for {port.source} ({port.name}), {why}, "
                f"at simulation time {self._now_ns() / 1e9:.2f} s"
            )
        return False

    def _discard_late(self) -> None:
        """Drop answers that came after the reply time-out. If one were taken for the next answer, all later answers
        would be one poll late."""
        deadline_ns = self._monotonic_ns() + self._reply_ns
        while frames := self._endpoint.receive(0.0):
            self.counters["late_frames"] += len(frames)
            if self._monotonic_ns() >= deadline_ns:
                return

    def _in_time(self, port: Port) -> bool | None:
        """Real time: True when an answer was committed, False when it was refused, None when no answer came in time."""
        deadline_ns = self._monotonic_ns() + self._reply_ns
        committed = None
        while committed is None and (remaining_ns := deadline_ns - self._monotonic_ns()) > 0:
            committed = self._take(port, remaining_ns)
        return committed

    def _awaited(self, port: Port) -> bool | None:
        """Lockstep: like :meth:`_in_time`; None when no answer can be expected any more.

        The waiting time is the sum over short waits, each counted at most with its nominal length, so time in which
        this process itself was suspended (a paused container, a debugger) is not held against the other node.
        """
        waited_ns, last_look = 0, False
        while True:
            begun_ns = self._monotonic_ns()
            committed = self._take(port, _LOOK_NS)
            if committed is not None:
                return committed
            if self._endpoint.is_cut_off(port.source):
                # A fault on the bus, not a slow node: the telegram is missed, as in real time.
                return False
            if self._endpoint.is_down:
                # No answer can come over an interface that is down; the link limits that wait itself.
                waited_ns, last_look = 0, False
            elif last_look:
                return None
            else:
                waited_ns += min(self._monotonic_ns() - begun_ns, _LOOK_NS)
                # A node that has ended may have answered before: check once more.
                last_look = waited_ns >= self._patience_ns or self._endpoint.has_ended(port.source)

    def _take(self, port: Port, timeout_ns: int) -> bool | None:
        """Pass arriving frames to the store; True: an answer was committed, False: refused, None: there was none.

        An empty frame on the last identifier of the telegram means that the source does not answer.
        """
        name, last_ids = port.name, self._last_ids[port.name]
        committed = None
        for frame in self._endpoint.receive(timeout_ns / 1e9):
            is_last = frame.can_id in last_ids and frame in self._own
            if is_last and not frame.data:
                # A source under a fault sends this frame in lockstep only: in real time nothing waits for its answer.
                self.counters["no_answer"] += 1
                committed = False if committed is None else committed
            elif self.store.feed(frame, self._now_ns()) == name:
                committed = True
            elif is_last and committed is None:
                committed = False
        return committed

    def find_devices(self, devices: Iterable[int], timeout_ns: int, interval_ns: int = 100_000_000) -> set[int]:
        """Ask each device for its status (F_code 15) until all have answered or ``timeout_ns`` of wall time is over.

        :returns: the devices that did *not* answer.
        :raises BusOccupied: another administrator polls on this bus, or two nodes answer as the same device.
        """
        missing = set(devices)
        deadline_ns = self._monotonic_ns() + timeout_ns
        # Polls without an answer so far.
        open_polls = 0
        while missing and self._monotonic_ns() < deadline_ns:
            self._endpoint.send([master_frame(F_DEVICE_STATUS, device) for device in sorted(missing)])
            open_polls += len(missing)
            round_ns = self._monotonic_ns() + interval_ns
            while missing and (remaining_ns := round_ns - self._monotonic_ns()) > 0:
                answers = self._status_answers(self._endpoint.receive(remaining_ns / 1e9))
                open_polls -= answers.total()
                missing -= answers.keys()
        if not missing:
            if self._endpoint.is_private:
                # A private bus has no other node, and each poll has its answer.
                self._await_answers(open_polls)
            else:
                self._refuse_doubles(set(devices))
        return missing

    def _await_answers(self, open_polls: int) -> None:
        """Take the answers to earlier polls of a node that came late."""
        end_ns = self._monotonic_ns() + _LATE_ANSWER_NS
        while open_polls > 0 and (remaining_ns := end_ns - self._monotonic_ns()) > 0:
            open_polls -= self._status_answers(self._endpoint.receive(remaining_ns / 1e9)).total()

    def _status_answers(self, frames: list[Frame]) -> Counter[int]:
        """Devices that have answered, once per answer."""
        contract = self._contract
        answers: Counter[int] = Counter()
        for frame in frames:
            if frame not in self._own:
                if frame.can_id == contract.device_status_id and not frame.flags & ERROR:
                    self.refused_status["no classic data frame with a standard identifier"] += 1
                continue
            if frame.can_id == contract.poll_id:
                raise BusOccupied(OTHER_ADMINISTRATOR)
            if frame.can_id == contract.device_status_id:
                answer = parse_device_status(frame.data)
                if answer is not None:
                    answers[answer[0]] += 1
                else:
                    self.refused_status[device_status_fault(frame.data)] += 1
        return answers

    def _refuse_doubles(self, devices: set[int]) -> None:
        """Two nodes that answer as the same device would corrupt the run: each poll would be answered twice."""
        names = {role.value: role.name.lower() for role in Role}
        self._late_answers()
        for device in sorted(devices):
            # Ask a second time to be sure: a surplus answer may be a late one from the scan.
            if self._answers_of(device) > 1 and self._answers_of(device) > 1:
                raise BusOccupied(
                    f"two nodes answer as device {device} ({names.get(device, 'a node')}): one too many on this bus; "
                    "a controller that is there already is used with --no-controller"
                )

    def _answers_of(self, device: int) -> int:
        self._endpoint.send([master_frame(F_DEVICE_STATUS, device)])
        return self._late_answers()[device]

    def _late_answers(self) -> Counter[int]:
        """Answers until none has come for a while."""
        found: Counter[int] = Counter()
        now_s = self._monotonic_ns() / 1e9
        end_s, quiet_s = now_s + 10 * _SCAN_ANSWER_S, now_s + _SCAN_ANSWER_S
        while now_s < min(end_s, quiet_s) and (frames := self._endpoint.receive(quiet_s - now_s)):
            answers = self._status_answers(frames)
            now_s = self._monotonic_ns() / 1e9
            if answers:
                found += answers
                quiet_s = now_s + _SCAN_ANSWER_S
        return found
