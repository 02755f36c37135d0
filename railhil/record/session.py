"""The supervisor on the bus: records every frame, answers its polls, notices the end of the run.

The answer to the SUP_CMD poll is the flow control: it is sent only after all earlier frames have been received. Frames
that only need recording are not decoded here; the score reads them back from the log.
"""

from __future__ import annotations

import time
from array import array
from collections.abc import Callable, Sequence

from railhil.bus.codes import Event, ends_run
from railhil.bus.frame import BRS, Frame
from railhil.bus.ident import CtlIdent, PltIdent, Role, SupIdent, make_ident
from railhil.bus.lifesign import MAX_STEP
from railhil.bus.mvb import F_DEVICE_STATUS
from railhil.bus.own_frames import supervisor_polls
from railhil.bus.packing import unpack_frames
from railhil.bus.responder import Reading, Responder
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent, SupCmd, TimeSync
from railhil.dbc import Contract
from railhil.record.framelog import LateLines, log_line, log_stamp, plain_line
from railhil.record.operator_commands import OperatorCommands
from railhil.record.packets import Backlog, FrameKinds, Packets
from railhil.record.session_parts import Handshake, InspectedFrames, SupervisorCommands
from railhil.record.truth_clock import TimeBase
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec


class Session:
    """Records one run; :func:`make_session` makes it with its parts.

    :param responder: receives the ports of the supervisor and answers its polls.
    :param write: called with each line of the log.
    :param packets: takes packed frames, and formats their lines later; None: frames come one by one.
    :param keep: called with the time and each frame that is recorded by itself; None: its line is written.
    """

    def __init__(
        self,
        responder: Responder,
        time_base: TimeBase,
        handshake: Handshake,
        commands: SupervisorCommands,
        inspected: InspectedFrames,
        write: Callable[[str], object],
        packets: Packets | None = None,
        keep: Callable[[int, Frame], object] | None = None,
    ) -> None:
        self.ended: Event | None = None
        #: Number and monotonic wall time of each new tick, for the file of arrivals.
        self.wall_ticks: array[int] = array("q")
        self.wall_ns: array[int] = array("q")
        self.first_frame_ns = 0
        self.frames = 0
        self.recording = False
        #: Wall time for which the recorder's interface was down during recording.
        self.unheard_ns = 0
        #: The end announced by the plant; the run has :attr:`ended` with the plant's last poll.
        self.ending: Event | None = None
        self.handshake = handshake
        self.commands = commands
        self.foreign_frames = inspected.foreign_frames
        self.packets = packets
        self._responder = responder
        responder.on(RunEvent, self._event)
        self._clock = responder.clock
        self._truth_clock = time_base.truth
        self._time = time_base.truth or responder.clock
        self._pace, self._pace_ticks = time_base.pace, time_base.pace_ticks
        self._inspected = inspected
        self._flags = inspected.flags
        self._write = write
        self._keep = keep or self._write_line
        # Ticks were heard, and no scan since: PLT_IDENT is a repetition in another bench's run, not a handshake.
        self._is_others = False

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
        return max(self.first_frame_ns, self.commands.last_poll_ns, self.wall_ns[-1] if self.wall_ns else 0)

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
        wrong_roles = self.handshake.wrong_roles
        return {**self._responder.store.counters, **({"wrong_role": wrong_roles} if wrong_roles else {})}

    def handle(self, frame: Frame) -> list[Frame]:
        """Take one frame in bus order: record it, return the answer to a poll of the supervisor."""
        can_id, _, flags = frame
        if self._flags.get(can_id) == flags & ~BRS:
            inspected = self._inspected
            if can_id in inspected.clock_ids:
                self._is_others = not self.recording
                # Needed under faults too: TIME_SYNC is judged by it.
                new = self._responder.opens_tick(frame)
                truth_clock = self._truth_clock
                if new if truth_clock is None else truth_clock.clock(frame):
                    # Written out as in _arrived: a call for each tick takes noticeable time.
                    self.wall_ticks.append(self._time.tick)
                    self.wall_ns.append(time.monotonic_ns())
            elif can_id == inspected.status_id:
                return []
            elif can_id in inspected.foreign_by_id:
                if self.recording:
                    inspected.foreign_by_id[can_id].add(self._time.now_ns)
            elif can_id in inspected.truth_ids:
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
        seen = self._flags
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
        """:meth:`take` for classic frames as they are packed on pipes (:mod:`railhil.bus.packing`).

        A packet that can wait is answered at once and recorded with :meth:`settle` or the next packet that cannot wait.
        Until then :attr:`sim_time_s` and :attr:`frames` keep their last values.
        """
        packets = self.packets
        if packets is None or not self.recording or self.ending is not None or not packets.backlog.may_wait(packet):
            self.settle()
            return self._record(packet, [])
        answers = self._responder.handle(packets.backlog.command_poll)
        packets.backlog.hold(packet, answers)
        return answers

    def settle(self) -> None:
        """Record the packets that have been answered and not been read yet."""
        if self.packets is not None:
            packet, answered = self.packets.backlog.release()
            if packet:
                self._record(packet, answered)

    def _record(self, packet: bytes, known: list[int]) -> list[Frame]:
        if self.packets is None or not self.recording:
            return self.take(unpack_frames(packet))
        answers: list[Frame] = []
        for count, ticks, others in self.packets.take(packet, known):
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
        scan = frame.can_id == self._inspected.poll_id and frame.data[:1] and frame.data[0] >> 4 == F_DEVICE_STATUS
        if frame == self._pace:
            self._paced()
        if scan:
            self._is_others = False
        if not self.recording and not self._is_others and frame.can_id in self._inspected.opening_ids:
            self.recording = True
            self.first_frame_ns = time.monotonic_ns()
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


def make_session(
    scenario: AnyScenario,
    write: Callable[[str], object],
    run: RunSpec,
    *,
    fd: bool = False,
    on_progress: Callable[[float], None] | None = None,
    operator: OperatorCommands | None = None,
    late: LateLines | None = None,
    contract: Contract | None = None,
    keep: Callable[[int, Frame], object] | None = None,
    branches: bool = False,
) -> Session:
    """The recorder of a run.

    :param write: called with each line of the log.
    :param on_progress: called at each SUP_CMD poll with the simulation time in s, of packets as far as it is known.
    :param operator: gives the orders of an operator; None: the orders of the run, if it has some.
    :param late: formats lines later, many of them at once; ``write`` is its own. None: each at once.
    :param contract: the contract of an earlier record that is recorded again; None: the contract of the scenario's
        system.
    :param keep: called with the time and each frame that is recorded by itself; None: its line is written.
    :param branches: the run may be given faults.
    """
    system = scenario.installed_system
    contract = contract or system.contract
    if operator is None and run.orders:
        operator = OperatorCommands(run.orders, None, not run.is_realtime)
    handshake = Handshake(make_ident(Role.SUPERVISOR, scenario.sha256, **run.identity, contract=contract))
    schedule = Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns, contract)
    # A fault may touch the clock port and TIME_SYNC, but not the truth.
    truth = system.truth if scenario.faults or branches else None
    base = TimeBase.of(contract, schedule, "" if truth is None else truth.port)

    def now_s() -> float:
        return (base.truth or responder.clock).now_ns / 1e9

    commands = SupervisorCommands(handshake, operator, on_progress, now_s)
    received = (TimeSync, RunEvent, PltIdent, CtlIdent)
    sinks = [contract.clock_port, *(contract.port(telegram.PORT) for telegram in received)]
    responder = Responder(
        Role.SUPERVISOR,
        schedule,
        sinks,
        {SupCmd.PORT: commands.make, SupIdent.PORT: handshake.own},
        fd=fd,
        contract=contract,
        paced=base.pace is None,
    )
    responder.on(PltIdent, handshake.take)
    responder.on(CtlIdent, handshake.take)
    truth_ids = base.truth.truth_ids if base.truth is not None else ()
    inspected = InspectedFrames(contract, sinks, truth_ids)
    packets = None
    if late is not None:
        keep = late.frame
        # If the poll of SUP_CMD advances a time, it is handled like any other frame.
        command_poll, *_ = supervisor_polls(contract)
        advances = base.pace == command_poll if base.pace else schedule.ticks(SupCmd.PORT) <= MAX_STEP
        backlog = Backlog(contract, waits=operator is None and not advances)
        kinds = FrameKinds(contract, inspected.flags, truth_ids)
        packets = Packets(responder, contract.clock_port, kinds, base, late, backlog)
    return Session(responder, base, handshake, commands, inspected, write, packets, keep)
