"""The slave side of the bus: keeps the mailboxes of a node and answers the bus administrator's polls."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from railhil.bus.clock import BusClock
from railhil.bus.frame import Frame
from railhil.bus.layout import Telegram
from railhil.bus.lifesign import MAX_STEP
from railhil.bus.mvb import F_DEVICE_STATUS, TelegramSource, device_status_frame, parse_master_frame
from railhil.bus.schedule import Schedule
from railhil.bus.store import TrafficStore
from railhil.bus.telegrams import TimeSync
from railhil.dbc import Contract, Port, wire_contract

#: Device status word: class 2/3 device, nothing to report (IEC 61375-3-1, type nibble 1).
_STATUS_READY = 0x1000


class Responder:
    """Reacts to one frame at a time; holds no socket, so it runs in a process or in memory alike.

    :param device: MVB device address, answered to device status polls.
    :param schedule: base tick, and the period of every port in ticks.
    :param sinks: ports with a mailbox.
    :param answers: for each port that this node sources, what makes the telegram when the poll comes.
    :param on_commit: called with the port's name whenever a telegram was accepted.
    :param contract: of the run's system; None: that of railhil's own train.
    """

    def __init__(
        self,
        device: int,
        schedule: Schedule,
        sinks: list[Port],
        answers: Mapping[str, Callable[[], Telegram]],
        *,
        fd: bool = False,
        on_commit: Callable[[str], None] | None = None,
        contract: Contract | None = None,
    ) -> None:
        contract = contract or wire_contract()
        clock_port = contract.clock_port
        self.clock = BusClock(schedule.base_tick_ns, schedule.ticks(clock_port.name), clock_port)
        self.store = TrafficStore(sinks)
        self._device = device
        self._on_commit = on_commit
        self._poll_id = contract.poll_id
        self._clock_ids = (contract.clock_port.address, contract.clock_port.fd_id)
        self._answers = {
            contract.port(name).f_code << 12 | contract.port(name).address: (
                TelegramSource(contract.port(name), fd),
                make,
            )
            for name, make in answers.items()
        }
        # The polls of the fastest own port are the clock's second leg: period in ticks, and master word. A port
        # slower than the life sign can bridge is no clock: its extra polls would be taken for lost time.
        paced = [
            port for port in map(contract.port, answers) if port.period_ns and schedule.ticks(port.name) <= MAX_STEP
        ]
        self._pace = min(
            ((schedule.ticks(port.name), port.f_code << 12 | port.address) for port in paced), default=(0, -1)
        )

    def handle(self, frame: Frame) -> list[Frame]:
        """Take one frame; returns the answer to a poll of this node, otherwise nothing."""
        can_id, data, flags = frame
        if can_id == self._poll_id and not flags:
            return self._answer(data)
        if can_id in self._clock_ids:
            self.clock.feed(frame)
        self.deliver(frame, self.clock.now_ns)
        return []

    def deliver(self, frame: Frame, received_ns: int) -> None:
        """Hand a frame that arrived at ``received_ns`` to the store, and tell of the telegram that it completes."""
        committed = self.store.feed(frame, received_ns)
        if committed is not None:
            if committed == TimeSync.PORT:
                telegram, _ = self.store.read(TimeSync, self.clock.now_ns)
                if telegram is not None:
                    self.clock.synchronise(telegram)
            if self._on_commit is not None:
                self._on_commit(committed)

    def _answer(self, data: bytes) -> list[Frame]:
        asked = parse_master_frame(data)
        if asked is None:
            self.store.counters["wrong_master_word"] += 1
            return []
        f_code, address = asked
        if f_code == F_DEVICE_STATUS:
            return [device_status_frame(self._device, _STATUS_READY)] if address == self._device else []
        word = f_code << 12 | address
        found = self._answers.get(word)
        if found is None:
            return []
        period_ticks, pace_word = self._pace
        if word == pace_word:
            self.clock.polled(period_ticks)
        source, make = found
        return source.frames(make().encode())
