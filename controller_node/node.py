"""The controller process on the bus: mailboxes in, control law, answers to the bus administrator's polls."""

from __future__ import annotations

import time

from railhil.bus.errors import PeerSilent
from railhil.bus.ident import CtlIdent, Ident, Role, make_ident
from railhil.bus.layout import Telegram, flag
from railhil.bus.link import Link
from railhil.bus.responder import Responder
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import (
    HEADROOM_UNUSED,
    NO_QUANTITY,
    BalisePassed,
    ControllerFlag,
    CtlMode,
    CtlStat,
    Event,
    NotchCmd,
    PltStat,
    RunEvent,
    TimeSync,
    TrkInfo,
    TrnPos,
    TrnSpeed,
)
from railhil.common.errors import InputError
from railhil.common.patience import LATER_S, PATIENCE_S
from railhil.controller_node.balises import Balises
from railhil.controller_node.controller import Controller, ControlOutput
from railhil.controller_node.ecan import BitCounter, Mailbox, Receiver, mailbox_table
from railhil.controller_node.guard import Guard
from railhil.controller_node.laws import load
from railhil.controller_node.odometer import Odometer
from railhil.controller_node.watch import Level
from railhil.dbc import wire_contract
from railhil.scenarios.model import Scenario
from railhil.scenarios.run_spec import LawSpec

_MODES = {
    Level.NORMAL: CtlMode.RUNNING,
    Level.HOLD: CtlMode.HOLD,
    Level.TRACTION_CUT: CtlMode.TRACTION_CUT,
    Level.SERVICE_BRAKE: CtlMode.SERVICE_BRAKE,
    Level.EMERGENCY: CtlMode.EMERGENCY,
}
#: Ports with a receive mailbox. SIM_TRUTH is not among them: the controller must not see the truth.
MAILBOXES = (TrnSpeed, TrnPos, BalisePassed, TimeSync, PltStat, TrkInfo, RunEvent)
#: Ports with transmit mailboxes.
ANSWERS = (NotchCmd, CtlStat, CtlIdent)
_NS_PER_MS = 1_000_000
_UINT16_MAX = 0xFFFF
#: Realtime: a controller that hears nothing at all for this long on the wall clock ends.
SILENCE_S = 3.0
#: Before the first frame it waits longer: the other nodes may be started by hand, on a machine with a load of its own.
FIRST_FRAME_S = 300.0


def mailboxes() -> tuple[Mailbox, ...]:
    """The controller's eCAN mailboxes, made from the port table.

    :raises ContractError: the ports do not fit into the chip.
    """
    contract = wire_contract()
    received, sent = ([contract.port(telegram.PORT) for telegram in side] for side in (MAILBOXES, ANSWERS))
    return mailbox_table(contract, received, sent)


class ControllerNode:
    """Reacts to frames; holds no socket, so it runs in a process or in memory alike.

    :param law: with a task period, the mailboxes are read by a task of that period; else each at once, by interrupt.
    :param controller: what computes the notch; None: the law.
    :param bit_rate: of the bus in bit/s, clocks the time stamps; None: that of the port table.
    :raises InputError: an option that the chip cannot have.
    """

    def __init__(
        self,
        scenario: Scenario,
        law: LawSpec,
        controller: Controller | None = None,
        *,
        fd: bool = False,
        bit_rate: int | None = None,
    ) -> None:
        contract = wire_contract()
        self.controller = controller or Controller(scenario, law)
        self.law = law
        self.ended: Event | None = None
        bit_rate = contract.bit_rate if bit_rate is None else bit_rate
        if bit_rate <= 0:
            raise InputError("command line", "--bitrate", bit_rate, "above 0")
        if fd and law.task_period_ms:
            raise InputError("command line", "--task-period-ms", law.task_period_ms, "0 with CAN FD")
        counter = BitCounter(bit_rate)
        needed = load(law.controller).track or law.over_distance
        self._odometer = Odometer(scenario, law.task_period_ms * _NS_PER_MS, needed=needed)
        self.guard = Guard(scenario, counter, self._odometer)
        self._balises = Balises()
        self._control_ns = scenario.timing.control_period_ns
        self._ident = make_ident(Role.CONTROLLER, scenario.sha256, **law.identity)
        self._output: ControlOutput | None = None
        self._last_k = -1
        self._steps = 0
        self._overruns = 0
        self._notch_life = 0
        self._stat_life = 0
        # Twice the quantity of the law that the next CTL_STAT is about, plus one when its maximum is shown.
        self._shown = 0
        self.responder = Responder(
            Role.CONTROLLER,
            Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns),
            [contract.port(telegram.PORT) for telegram in MAILBOXES],
            {NotchCmd.PORT: self._notch, CtlStat.PORT: self._status, CtlIdent.PORT: self._own_ident},
            fd=fd,
            on_commit=self._committed,
        )
        self._clock = self.responder.clock
        self._store = self.responder.store
        table = None if fd else mailboxes()
        self.receiver = Receiver(self.responder, table, counter, law.task_period_ms * _NS_PER_MS)
        #: Takes one frame in bus order; returns the answer to a poll of the controller.
        self.handle = self.receiver.handle

    @property
    def lost_messages(self) -> int:
        """Frames overwritten in their mailbox before they were read."""
        return self.receiver.lost_messages

    @property
    def lost_by_mailbox(self) -> dict[str, int]:
        """Frames lost in each receive mailbox, by its name; none with CAN FD."""
        ecan = self.receiver.ecan
        return {} if ecan is None else {box.name: ecan.lost[box.number] for box in mailboxes() if not box.transmit}

    @property
    def counters(self) -> dict[str, int]:
        """What was refused or lost, by cause."""
        watched = (self._store, self.guard, self._odometer, self._balises, self.receiver)
        return {cause: count for part in watched for cause, count in part.counters.items()}

    @property
    def lockstep(self) -> bool:
        """True while nothing says that time goes on by the wall clock."""
        return not self._clock.rate

    def was_out(self, wall_ns: int) -> None:
        """The interface was out for ``wall_ns``, now frames come again: the watch must see how old the speed is."""
        self._clock.silence(wall_ns)
        self.guard.look(self._clock.now_ns)

    def _committed(self, port: str) -> None:
        if port == TrnSpeed.PORT:
            speed, _ = self._store.read(TrnSpeed, self._clock.now_ns)
            if speed is not None:
                self.guard.speed(speed, self._clock.now_ns, self.receiver.stamp)
        elif port == TrkInfo.PORT:
            track, _ = self._store.read(TrkInfo, self._clock.now_ns)
            if track is not None:
                self.guard.limit(track)
        elif port == TrnPos.PORT:
            position, age_ns = self._store.read(TrnPos, self._clock.now_ns)
            if position is not None:
                self._odometer.position(position, self._clock.now_ns - age_ns)
        elif port == BalisePassed.PORT:
            passed, _ = self._store.read(BalisePassed, self._clock.now_ns)
            if passed is not None:
                self._balises.take(passed, *self._odometer.reckoned(self._clock.now_ns))
        elif port == RunEvent.PORT:
            telegram, _ = self._store.read(RunEvent, self._clock.now_ns)
            if telegram is not None and telegram.event in Event._value2member_map_ and Event(telegram.event).ends_run:
                self.ended = Event(telegram.event)

    def _control(self) -> None:
        """Run the law when a control period has begun since the last step."""
        now_ns = self._clock.now_ns
        k = now_ns // self._control_ns
        if not self._clock.running or k == self._last_k:
            return
        speed_01mmps = self.guard.speed_01mmps
        if speed_01mmps is None:
            return
        if k > self._last_k + 1 and self._last_k >= 0:
            self._overruns += 1
        self._output = self.controller.step(k, speed_01mmps, self._odometer.at(now_ns), self._balises.last)
        self._last_k = k
        self._steps += 1

    def _notch(self) -> Telegram:
        # The poll itself may have opened the tick, when the clock's own frame is missing.
        self.receiver.read_when_due()
        self._control()
        self._notch_life = (self._notch_life + 1) & 0xF
        if self._output is None:
            return NotchCmd(0, CtlMode.INITIALISING, emergency=flag(False), life=self._notch_life)
        code, emergency = self.guard.notch(self._output.notch_code, self._clock.now_ns)
        self.controller.sent(code)
        return NotchCmd(code, _MODES[self.guard.level], emergency=flag(emergency), life=self._notch_life)

    def _status(self) -> Telegram:
        self._stat_life = (self._stat_life + 1) & 0xF
        output = self._output
        if output is None:
            return CtlStat(overflow_flags=self._lost_flag(), ready=flag(False), life=self._stat_life)
        telemetry = self.controller.telemetry
        index, maximum = divmod(self._shown, 2)
        self._shown = (self._shown + 1) % (2 * min(len(telemetry.quantities), NO_QUANTITY))
        quantity = telemetry.row(index)
        headroom_bits = HEADROOM_UNUSED if quantity.headroom_bits is None else quantity.headroom_bits
        extreme_raw = (quantity.maximum_raw if maximum else quantity.minimum_raw) or 0
        return CtlStat(
            basis=output.basis,
            ladder_level=self.guard.level,
            overflow_flags=output.overflow_flags | self._lost_flag(),
            softening_unipolar2=output.softening_raw,
            satisfaction_unipolar2=output.satisfaction_raw,
            step_count=self._steps & 0xFFFF,
            step_cycles=min(output.cycles, _UINT16_MAX),
            # Shifted left by the headroom, the larger extreme fills an int32.
            telemetry_extreme=(extreme_raw << headroom_bits) >> 16,
            telemetry_index=index,
            telemetry_maximum=maximum,
            telemetry_headroom_bits=headroom_bits,
            telemetry_wrapped=int(quantity.wraps > 0),
            telemetry_saturated=int(quantity.saturations > 0),
            telemetry_zero_division=int(quantity.zero_divisions > 0),
            overruns=min(self._overruns, 255),
            life=self._stat_life,
        )

    def _lost_flag(self) -> int:
        return ControllerFlag.MESSAGE_LOST if self.lost_messages else 0

    def _own_ident(self) -> Ident:
        return self._ident


def serve(
    node: ControllerNode, endpoint: Link, *, appear_s: float = FIRST_FRAME_S, patience_s: float = PATIENCE_S
) -> None:
    """Answer the bus administrator until the run has ended, also over outages of the interface.

    :param appear_s: wall time for its first frame.
    :param patience_s: its own with the other nodes, in lockstep.
    :raises BusLost: the bus is gone.
    :raises PeerSilent: nothing came for too long.
    """
    heard_s = time.monotonic()
    limit_s = appear_s
    while node.ended is None:
        frames = endpoint.receive(0.5)
        if gap_ns := endpoint.take_gap_ns():
            node.was_out(gap_ns)
        for frame in frames:
            answers = node.handle(frame)
            if answers:
                endpoint.lossless = node.lockstep
                endpoint.send(answers)
        now_s = time.monotonic()
        if frames:
            heard_s, limit_s = now_s, patience_s + LATER_S if node.lockstep else SILENCE_S
        elif endpoint.is_down:
            # The link itself gives up after a time.
            heard_s = now_s
        elif now_s - heard_s > limit_s:
            raise PeerSilent(f"controller waits for the bus administrator: no frame for {limit_s:g} s")


def run_controller(
    node: ControllerNode, endpoint: Link, *, appear_s: float = FIRST_FRAME_S, patience_s: float = PATIENCE_S
) -> int:
    """As :func:`serve`, then leave the bus; returns an exit code."""
    try:
        serve(node, endpoint, appear_s=appear_s, patience_s=patience_s)
    finally:
        endpoint.close()
        endpoint.tell_trouble()
    return 0
