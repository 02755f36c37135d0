"""The supervisor on the bus: records every frame, answers its polls, notices the end of the run.

The answer to the SUP_CMD poll is the flow control: it is sent only after all earlier frames have been received. Frames
that only need recording are not decoded here; the score reads them back from the log.
"""

from __future__ import annotations

import time
from array import array
from collections import deque
from collections.abc import Callable, Sequence
from operator import itemgetter

from railhil.bus.codes import Event, FaultOrder, SupCommand, ends_run
from railhil.bus.frame import BRS, Frame
from railhil.bus.hub.wire import CLASSIC_SIZE, pack_frames, unpack_frames
from railhil.bus.ident import CtlIdent, Ident, PltIdent, Role, SupIdent, make_ident
from railhil.bus.layout import Telegram
from railhil.bus.lifesign import MAX_STEP
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame
from railhil.bus.own_frames import OwnFrames
from railhil.bus.responder import Reading, Responder
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent, SupCmd, TimeSync
from railhil.common.mypyc import mypyc_attr
from railhil.dbc import Contract
from railhil.record.framelog import LateLines, log_line, log_stamp, plain_line
from railhil.record.operator_commands import OperatorCommands
from railhil.record.packets import Packets
from railhil.record.senders import ForeignFrames
from railhil.record.truth_clock import TruthClock
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec


@mypyc_attr(allow_interpreted_subclasses=True)
class Session:
    """Records one run.

    :param write: called with each line of the log.
    :param on_progress: called at each SUP_CMD poll with the simulation time in s, of packets as far as it is known.
    :param operator: gives the orders of an operator; None: the orders of the run, if it has some. :param late: formats
        lines later, many of them at once; ``write`` is its own. None: each at once.
    :param contract: the contract of an earlier record that is recorded again; None: the contract of the scenario's
        system.
    """

    def __init__(
        self,
        scenario: AnyScenario,
        write: Callable[[str], object],
        run: RunSpec,
        *,
        fd: bool = False,
        on_progress: Callable[[float], None] | None = None,
        operator: OperatorCommands | None = None,
        late: LateLines | None = None,
        contract: Contract | None = None,
    ) -> None:
        system = scenario.installed_system
        contract = contract or system.contract
        self.ended: Event | None = None
        #: Disagreements between the nodes, one sentence each; the run is then not started.
        self.disagreements: list[str] = []
        #: Number and monotonic wall time of each new tick, for the file of arrivals.
        self.wall_ticks: array[int] = array("q")
        self.wall_ns: array[int] = array("q")
        self.first_frame_ns = 0
        self.last_poll_ns = 0
        self.frames = 0
        self.recording = False
        #: Wall time for which the recorder's interface was down during recording.
        self.unheard_ns = 0
        #: The end announced by the plant; the run has :attr:`ended` with the plant's last poll.
        self.ending: Event | None = None
        #: Newest handshake telegram of each other node.
        self._heard: dict[str, Ident] = {}
        self._write = write
        # Records a frame with its time.
        self._keep: Callable[[int, Frame], object] = self._write_line if late is None else late.frame
        self._on_progress = on_progress
        self._life = 0
        if operator is None and run.orders:
            operator = OperatorCommands(run.orders, None, not run.is_realtime)
        self.operator = operator
        # SUP_CMD sent in this run.
        self._answers = 0
        # Numbers of faults and the orders for them, not sent yet.
        self._orders: deque[tuple[int, FaultOrder]] = deque()
        self._ident = make_ident(Role.SUPERVISOR, scenario.sha256, **run.identity, contract=contract)
        clock_port = contract.clock_port
        sinks = [clock_port, *(contract.port(telegram.PORT) for telegram in (TimeSync, RunEvent, PltIdent, CtlIdent))]
        schedule = Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns, contract)
        # A fault may touch the clock port and TIME_SYNC, but not the truth.
        truth = system.truth if scenario.faults else None
        self._truth_clock = None if truth is None else TruthClock(contract, schedule, truth.port)
        # Without faults the fastest poll of any node advances the time while the clock port is missing.
        polled = [port for port in contract.ports if port.mode == "poll" and port.period_ns]
        self._pace_ticks, fastest = min(((schedule.ticks(port.name), port) for port in polled), key=itemgetter(0))
        self._pace: Frame | None = None
        if self._truth_clock is None and self._pace_ticks <= MAX_STEP:
            self._pace = master_frame(fastest.f_code, fastest.address)
        self._responder = Responder(
            Role.SUPERVISOR,
            schedule,
            sinks,
            {SupCmd.PORT: self._command, SupIdent.PORT: self._own_ident},
            fd=fd,
            contract=contract,
            paced=self._pace is None,
        )
        self._responder.on(PltIdent, self._take_ident)
        self._responder.on(CtlIdent, self._take_ident)
        self._responder.on(RunEvent, self._event)
        self._clock = self._responder.clock
        self._poll_id = contract.poll_id
        self._status_id = contract.device_status_id
        self._clock_ids = {clock_port.address, clock_port.fd_id}
        opening = contract.port(PltIdent.PORT)
        self._opening_ids = {opening.address, opening.fd_id}
        # Ticks were heard, and no scan since: PLT_IDENT is a repetition in another bench's run, not a handshake.
        self._is_others = False
        self._time = self._truth_clock or self._clock
        self._truth_ids = self._truth_clock.truth_ids if self._truth_clock is not None else set()
        # All other frames, which are the majority, are recorded without inspection.
        seen_ids = {self._status_id, self._poll_id, *self._truth_ids}
        seen_ids |= {can_id for port in sinks for can_id in (*port.can_ids, port.fd_id)}
        #: Frames under the supervisor's own identifiers that came from the bus, by port.
        self.foreign_frames = {port.name: ForeignFrames() for port in contract.ports if port.source == "supervisor"}
        self._own_ids = {
            can_id: self.foreign_frames[port.name]
            for port in contract.ports
            if port.name in self.foreign_frames
            for can_id in (*port.can_ids, port.fd_id)
        }
        # Their flags by identifier, for frames of the contract.
        own = OwnFrames(contract).flags
        self._seen = {can_id: own[can_id] for can_id in (*seen_ids, *self._own_ids)}
        self._packets: Packets | None = None
        self._may_wait = False
        if late is not None:
            pace = b"" if self._pace is None else self._pace.data
            self._packets = Packets(
                self._responder, contract, self._seen, pace, self._pace_ticks, self._truth_clock, late
            )
            # If the poll of SUP_CMD advances a time, it is handled like any other frame.
            paces = self._pace == self._packets.command_poll if self._pace else schedule.ticks(SupCmd.PORT) <= MAX_STEP
            self._may_wait = self.operator is None and not paces
        # Packets that are answered and not recorded yet, each with the answer; places of polls and answers.
        self._backlog: list[bytes] = []
        self._answered: list[int] = []
        self._backlog_frames = 0

    @property
    def sim_time_s(self) -> float:
        """Simulation time of the current tick."""
        return self.time_ns / 1e9

    @property
    def time_ns(self) -> int:
        """Simulation time of the current tick in ns."""
        return self._time.now_ns

    @property
    def heard_ns(self) -> int:
        """Monotonic wall time of the plant's last sign of life: its newest tick or poll, or the start of the record."""
        # In a pause it polls, and no tick comes.
        return max(self.first_frame_ns, self.last_poll_ns, self.wall_ns[-1] if self.wall_ns else 0)

    @property
    def rate(self) -> float:
        """Pace by TIME_SYNC, simulated seconds per wall second, in tenths; 0: lockstep, or not known."""
        return self._clock.rate

    def was_out(self, wall_ns: int) -> None:
        """The interface was down for ``wall_ns``: time continued, and the record has a gap."""
        if self.recording:
            self.unheard_ns += wall_ns
        self._clock.silence(wall_ns)
        if self._truth_clock is not None:
            self._truth_clock.silence(int(wall_ns * self._clock.rate))

    @property
    def counters(self) -> dict[str, int]:
        """Telegrams that the supervisor itself refused, by cause."""
        return dict(self._responder.store.counters)

    def handle(self, frame: Frame) -> list[Frame]:
        """Take one frame in bus order: record it, return the answer to a poll of the supervisor."""
        can_id, _, flags = frame
        if self._seen.get(can_id) == flags & ~BRS:
            if can_id in self._clock_ids:
                self._is_others = not self.recording
                # Needed under faults too: TIME_SYNC is judged by it.
                new = self._responder.opens_tick(frame)
                truth_clock = self._truth_clock
                if new if truth_clock is None else truth_clock.clock(frame):
                    # Written out as in _arrived: a call for each tick takes noticeable time.
                    self.wall_ticks.append(self._time.tick)
                    self.wall_ns.append(time.monotonic_ns())
            elif can_id == self._status_id:
                return []
            elif can_id in self._own_ids:
                if self.recording:
                    self._own_ids[can_id].add(self._time.now_ns)
            elif can_id in self._truth_ids:
                if self._truth_clock is not None and self._truth_clock.truth(frame):
                    self._arrived()
            else:
                return self._handle_own(frame)
        if self.recording:
            self.frames += 1
            self._keep(self._time.now_ns, frame)
        return []

    def _write_line(self, time_ns: int, frame: Frame) -> None:
        self._write(log_line(time_ns, frame))

    def take(self, frames: Sequence[Frame]) -> list[Frame]:
        """:meth:`handle` for frames in bus order; returns the answers to all polls of the supervisor among them."""
        answers: list[Frame] = []
        seen = self._seen
        lines: list[str] = []
        time_ns = -1
        stamp = ""
        for frame in frames:
            can_id, data, flags = frame
            if flags or can_id in seen or not self.recording:
                if lines:
                    self._write("".join(lines))
                    lines.clear()
                answers += self.handle(frame)
                continue
            # Most frames are recorded without inspection.
            if time_ns != self._time.now_ns:
                time_ns = self._time.now_ns
                stamp = log_stamp(time_ns)
            self.frames += 1
            lines.append(plain_line(stamp, can_id, data))
        if lines:
            self._write("".join(lines))
        return answers

    def take_packed(self, packet: bytes) -> list[Frame]:
        """:meth:`take` for classic frames as they are packed on pipes (:mod:`railhil.bus.hub.wire`).

        A packet that can wait is answered at once and recorded with :meth:`settle` or the next packet that cannot wait.
        Until then :attr:`sim_time_s` and :attr:`frames` keep their last values.
        """
        packets = self._packets
        may_wait = packets is not None and self._may_wait and self.recording and self.ending is None
        if packets is None or not may_wait or not packets.may_wait(packet):
            self.settle()
            return self._record(packet, [])
        answers = self._responder.handle(packets.command_poll)
        self._backlog += (packet, *pack_frames(answers))
        poll = self._backlog_frames + len(packet) // CLASSIC_SIZE - 1
        self._backlog_frames = poll + 1 + len(answers)
        self._answered += range(poll, self._backlog_frames)
        return answers

    def settle(self) -> None:
        """Record the packets that have been answered and not been read yet."""
        if self._backlog:
            packet, answered = b"".join(self._backlog), self._answered
            self._backlog, self._answered, self._backlog_frames = [], [], 0
            self._record(packet, answered)

    def _record(self, packet: bytes, known: list[int]) -> list[Frame]:
        if self._packets is None or not self.recording:
            return self.take(unpack_frames(packet))
        answers: list[Frame] = []
        for count, ticks, others in self._packets.take(packet, known):
            self.frames += count
            self.wall_ticks.extend(ticks)
            self.wall_ns.extend([time.monotonic_ns()] * len(ticks))
            if others:
                answers += self.take(others)
        return answers

    def _paced(self) -> None:
        """A frame of the second time base."""
        tick = self._clock.tick
        self._clock.polled(self._pace_ticks)
        if self._clock.tick > tick:
            self._arrived()

    def _arrived(self) -> None:
        """A new tick has arrived."""
        self.wall_ticks.append(self._time.tick)
        self.wall_ns.append(time.monotonic_ns())

    def _handle_own(self, frame: Frame) -> list[Frame]:
        """A poll, or a telegram that the supervisor reads itself."""
        scan = frame.can_id == self._poll_id and frame.data[:1] and frame.data[0] >> 4 == F_DEVICE_STATUS
        if frame == self._pace:
            self._paced()
        if scan:
            self._is_others = False
        if not self.recording and not self._is_others and frame.can_id in self._opening_ids:
            self.recording = True
            self.first_frame_ns = self.last_poll_ns = time.monotonic_ns()
        if not self.recording and not scan:
            # A run that began without this supervisor belongs to another one.
            return []
        # A TIME_SYNC that corrects the time gets the time of the other frames of its tick.
        time_ns = self._time.now_ns
        answers = self._responder.handle(frame)
        if answers:
            # The plant's last poll comes after its last event: only then is the record complete.
            self.ended = self.ending
        if self.recording and not scan:
            # The device status scan continues until all nodes have appeared: bus management, not part of the record.
            for item in (frame, *answers):
                self.frames += 1
                self._keep(time_ns, item)
        return answers

    def _event(self, reading: Reading[RunEvent]) -> None:
        code = reading.telegram.event
        if self.recording and ends_run(code):
            self.ending = Event(code)

    def _take_ident(self, reading: Reading[Ident]) -> None:
        """Take a handshake telegram, unless its role differs from that of its port's source."""
        ident = reading.telegram
        if not ident.is_own:
            self._responder.store.counters["wrong_role"] += 1
            return
        self._heard[ident.PORT] = ident
        if ident.PORT == CtlIdent.PORT:
            self._compare()

    def _compare(self) -> None:
        """Compare the nodes' handshakes; plant and controller do not know which controller was requested."""
        plant, controller = self._heard.get(PltIdent.PORT), self._heard.get(CtlIdent.PORT)
        if plant is not None and controller is not None:
            own = self._ident
            found = plant.differences(controller) + plant.differences(own)
            self.disagreements = found or controller.differences(own)

    def _command(self) -> Telegram:
        self.last_poll_ns = time.monotonic_ns()
        self._life = (self._life + 1) & 0xF
        if self._on_progress is not None:
            self._on_progress(self.sim_time_s)
        self._answers += 1
        command = SupCommand.STOP if self.disagreements else SupCommand.START
        number, order = self._orders.popleft() if self._orders else (0, FaultOrder.NONE)
        if self.operator is not None and self._answers > 1 and command is SupCommand.START:
            command, number, order = self.operator.answer(self._answers, self.sim_time_s)
        return SupCmd(command=command, fault_number=number, fault_order=order, life=self._life)

    def order(self, number: int, order: FaultOrder) -> None:
        """Send an order for a fault that is triggered by hand, with the next SUP_CMD that is free.

        It acts from the tick after that SUP_CMD on; the certificate then names this instant.

        :param number: place of the fault in the scenario's list, from 1.
        """
        self._orders.append((number, order))

    def _own_ident(self) -> Ident:
        return self._ident
