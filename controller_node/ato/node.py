"""The controller on the bus: telegrams in, control law, answers to the bus administrator's polls."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, Final

from railhil.bus.codes import ControllerFlag
from railhil.bus.ident import CtlIdent
from railhil.bus.layout import FLAG_FALSE, FLAG_TRUE, Telegram, flag
from railhil.bus.reception import Document, reception
from railhil.bus.responder import Reading
from railhil.bus.sdt import SAFE_DATA_VERSION, SafeSource, safe_tick_fields, source_identity
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.common.errors import InputError
from railhil.common.mypyc import mypyc_attr
from railhil.controller_node.ato.balises import Balises
from railhil.controller_node.ato.controller import Controller, ControlOutput
from railhil.controller_node.ato.guard import Guard
from railhil.controller_node.ato.odometer import Odometer
from railhil.controller_node.ato.status import StatusReports
from railhil.controller_node.ato.track_info import TrackInfo
from railhil.controller_node.ecan import BitCounter, Ecan, Mailbox, Receiver, mailbox_table
from railhil.controller_node.laws import law_class
from railhil.controller_node.laws.base import Law
from railhil.controller_node.node import LawNode
from railhil.dbc import Contract, wire_contract
from railhil.scenarios.run_spec import LawSpec
from railhil.systems.ato.scenario.model import Scenario
from railhil.wire.ato import (
    BalisePassed,
    CtlMode,
    CtlStat,
    NotchCmd,
    NotchSdt,
    PltStat,
    SpeedSdt,
    TrkInfo,
    TrnPos,
    TrnSpeed,
)

#: Mode sent at each level of the watch, by its number.
_MODES: Final = (CtlMode.RUNNING, CtlMode.HOLD, CtlMode.TRACTION_CUT, CtlMode.SERVICE_BRAKE, CtlMode.EMERGENCY)
#: Ports with a receive mailbox. SIM_TRUTH is not among them: the controller must not see the truth.
MAILBOXES: Final = (TrnSpeed, TrnPos, BalisePassed, TimeSync, PltStat, TrkInfo, RunEvent)
#: Ports with transmit mailboxes.
ANSWERS: Final = (NotchCmd, CtlStat, CtlIdent)
#: The ports in scenarios with a safe channel.
SAFE_MAILBOXES, SAFE_ANSWERS = (*MAILBOXES, SpeedSdt), (*ANSWERS, NotchSdt)
_NS_PER_MS: Final = 1_000_000
_UINT16_MAX: Final = 0xFFFF


def mailboxes(safe: bool = False) -> tuple[Mailbox, ...]:
    """The controller's eCAN mailboxes, made from the port table.

    :param safe: with the mailboxes of the safe channel.
    :raises ContractError: the ports do not fit into the chip.
    """
    return _mailboxes_of(wire_contract(), *((SAFE_MAILBOXES, SAFE_ANSWERS) if safe else (MAILBOXES, ANSWERS)))


def _mailboxes_of(contract: Contract, *sides: Sequence[type[Telegram]]) -> tuple[Mailbox, ...]:
    received, sent = ([contract.port(telegram.PORT) for telegram in side] for side in sides)
    return mailbox_table(contract, received, sent)


def end_of_authority_01mm(scenario: Scenario) -> int:
    """Point that the train must not pass, 0.1 mm from the start of the run."""
    return round((scenario.plan.distance_m + scenario.watch.end_of_authority_margin_m) * 1e4)


def _supported_bit_rate(law: LawSpec, bit_rate: int | None, *, safe: bool, fd: bool) -> int:
    """Bit rate of the bus in bit/s.

    :param bit_rate: None: the port table's.
    :raises InputError: it is not above 0, or the chip cannot read its mailboxes by a task.
    """
    bit_rate = wire_contract().bit_rate if bit_rate is None else bit_rate
    if bit_rate <= 0:
        raise InputError("command line", "--bitrate", bit_rate, "above 0")
    if fd and law.task_period_ms:
        raise InputError("command line", "--task-period-ms", law.task_period_ms, "0 with CAN FD")
    if safe and law.task_period_ms:
        raise InputError("command line", "--task-period-ms", law.task_period_ms, "0 with safety.sdt")
    return bit_rate


@mypyc_attr(allow_interpreted_subclasses=True)
class ControllerNode(LawNode):
    """A law behind a guard: mailboxes of the CAN module, checks of their telegrams, and a watch that limits the notch.

    :param law: with a task period, the mailboxes are read by a task of that period; else each at once, by interrupt.
    :param controller: computes the notch instead of the law; None: the law.
    :param bit_rate: of the bus in bit/s, for the time stamps; None: the port table's. :raises InputError: an option
        that the chip does not support.
    """

    #: The controller that computes the notch.
    computes: ClassVar[type[Any]] = Controller
    polls_begin: ClassVar[bool] = True

    def __init__(
        self,
        scenario: Scenario,
        law: LawSpec,
        controller: Any = None,
        *,
        fd: bool = False,
        bit_rate: int | None = None,
    ) -> None:
        super().__init__(scenario, law, law_class(law, scenario, Law), controller)
        safe, task_ns = scenario.safety.sdt, law.task_period_ms * _NS_PER_MS
        counter = BitCounter(_supported_bit_rate(law, bit_rate, safe=safe, fd=fd))
        needed = self.law_type.track or law.over_distance
        self._odometer = Odometer(scenario, task_ns, needed=needed)
        self._track_info = TrackInfo(scenario)
        self.guard = Guard(scenario, counter, self._odometer, self._track_info)
        self._balises = Balises()
        # Balises can contradict the position only of a law that gets them.
        self._end_01mm = end_of_authority_01mm(scenario) if self.law_type.track else None
        self._reports = StatusReports(self.controller)
        self._output: ControlOutput | None = None
        self._overruns = 0
        self._notch_life = 0
        # The last answer to NOTCH_CMD, and the object that repeats it as a safe telegram.
        self._notch_cmd = NotchCmd()
        self._safe = SafeSource(source_identity(NotchSdt.port().address), SAFE_DATA_VERSION)
        kinds, sent = self.mailbox_telegrams(safe)
        self._mailboxes = _mailboxes_of(self._contract, kinds, sent)
        module = None if fd else Receiver(self._mailboxes, counter, task_ns)
        #: The CAN module with its mailboxes; None with CAN FD, which the chip does not support.
        self.ecan: Ecan | None = None if module is None else module.ecan
        received = [self._contract.port(telegram.PORT) for telegram in kinds]
        responder = self.attach(received, self.answers(safe), fd=fd, module=module)
        responder.on(TrnSpeed, self._speed)
        if safe:
            responder.on(SpeedSdt, self._safe_speed)
        responder.on(TrnPos, self._position)
        responder.on(BalisePassed, self._balise)
        responder.on(TrkInfo, self._track)
        # More time may have passed than the telegrams since the last poll tell, and the watch must see it.
        for kind in (TimeSync, PltStat):
            responder.on(kind, self._look)

    def mailbox_telegrams(self, safe: bool) -> tuple[Sequence[type[Telegram]], Sequence[type[Telegram]]]:
        """Telegrams with receive mailboxes, most urgent first, and those with transmit mailboxes.

        :param safe: with the safe channel.
        """
        return (SAFE_MAILBOXES, SAFE_ANSWERS) if safe else (MAILBOXES, ANSWERS)

    def answers(self, safe: bool) -> dict[str, Callable[[], Telegram]]:
        """For each port of which it is the source, besides CTL_IDENT, what makes its telegram."""
        answers: dict[str, Callable[[], Telegram]] = {NotchCmd.PORT: self._notch, CtlStat.PORT: self._status}
        return answers | ({NotchSdt.PORT: self._safe_notch} if safe else {})

    @property
    def lost_messages(self) -> int:
        """Frames overwritten in their mailbox before they were read."""
        return 0 if self.ecan is None else self.ecan.lost_messages

    @property
    def lost_by_mailbox(self) -> dict[str, int]:
        """Frames lost in each receive mailbox, by its name; none with CAN FD."""
        ecan = self.ecan
        return {} if ecan is None else {box.name: ecan.lost[box.number] for box in self._mailboxes if not box.transmit}

    @property
    def counters(self) -> dict[str, int]:
        """Counters of refused and lost frames, by cause."""
        watched = (self.responder.store, self.guard, self.guard.safe, self._odometer, self._balises, self.ecan)
        return {cause: count for part in watched if part is not None for cause, count in part.counters.items()}

    @property
    def received(self) -> Document:
        """Telegrams that it has received (:mod:`railhil.bus.reception`)."""
        odometer, guard = self._odometer, self.guard
        position = {cause.removeprefix("position_"): count for cause, count in odometer.counters.items()}
        if "check" in position:
            position["check_variable"] = position.pop("check")
        judged: dict[str, tuple[int, Mapping[str, int]]] = {
            TrnSpeed.PORT: (guard.accepted, guard.counters),
            TrnPos.PORT: (odometer.accepted, position),
        }
        if guard.safe is not None:
            judged[SpeedSdt.PORT] = (guard.safe.accepted, guard.safe.counters)
        found = reception(self.responder.store, judged)
        for name, lost in self.lost_by_mailbox.items():
            port = found["ports"].get(name.partition(".")[0])
            if port is not None:
                port["lost"] = port.get("lost", 0) + lost
        return {**found, "by_task": bool(self.law.task_period_ms)}

    def was_out(self, wall_ns: int) -> None:
        """The interface was down for ``wall_ns`` and now delivers frames again: the watch must see how old the speed
        is."""
        super().was_out(wall_ns)
        self.guard.look(self._clock.own_ns)

    def was_stopped(self, sim_ns: int) -> None:
        """It was stopped for ``sim_ns`` of simulation time: the watch must see how old the speed is."""
        super().was_stopped(sim_ns)
        self.guard.look(self._clock.own_ns)

    def _speed(self, reading: Reading[TrnSpeed]) -> None:
        self.guard.speed(reading.telegram, self._clock.own_ns, reading.stamp)

    def _safe_speed(self, reading: Reading[SpeedSdt]) -> None:
        clock = self._clock
        self.guard.confirm(reading.telegram, clock.own_ns, clock.tick if clock.is_set else None)

    def _position(self, reading: Reading[TrnPos]) -> None:
        self._odometer.position(reading.telegram, reading.received_ns)

    def _balise(self, reading: Reading[BalisePassed]) -> None:
        self._balises.take(reading.telegram, *self._odometer.reckoned(self._clock.own_ns))

    def _look(self, reading: Reading[Any]) -> None:
        self.guard.look(self._clock.own_ns)

    def _track(self, reading: Reading[TrkInfo]) -> None:
        self.guard.limit(reading.telegram, self._clock.own_ns)

    def _control(self) -> None:
        """Run the law when a control period has begun since the last step; it needs the time of the run."""
        clock = self._clock
        k = clock.now_ns // self._control_ns
        if not clock.is_set or k == self._last_k:
            return
        speed_01mmps = self.guard.speed_01mmps
        if speed_01mmps is None:
            return
        if self._output is None:
            self.guard.wait(False)
        is_late = k > self._last_k + 1 and self._last_k >= 0
        self._overruns += is_late
        self.guard.period(is_late)
        position_01mm = self._odometer.at(clock.own_ns)
        if self._end_01mm is not None:
            self.guard.overrun(self._balises.is_beyond(position_01mm, self._end_01mm))
        self._output = self.controller.step(k, speed_01mmps, position_01mm, self._balises.last)
        self._last_k = k
        self._steps += 1

    def _notch(self) -> Telegram:
        self._control()
        self._notch_life = (self._notch_life + 1) & 0xF
        output, guard = self._output, self.guard
        if output is None and guard.may_move(self._clock.own_ns):
            guard.wait(True)
        if output is None and not guard.waits:
            self._notch_cmd = NotchCmd(0, CtlMode.INITIALISING, emergency=flag(False), life=self._notch_life)
            return self._notch_cmd
        code, emergency = guard.notch(output.notch_code if output else 0, self._clock.own_ns)
        if output:
            self.controller.sent(code)
        mode = _MODES[guard.level]
        self._notch_cmd = NotchCmd(
            code, mode, guard.cause, emergency=FLAG_TRUE if emergency else FLAG_FALSE, life=self._notch_life
        )
        return self._notch_cmd

    def _safe_notch(self) -> Telegram:
        told, clock, safe = self._notch_cmd, self._clock, self.guard.safe
        tick = clock.tick if clock.is_set or safe is None else safe.told_tick
        telegram = NotchSdt(told.notch_256th, emergency=told.emergency, **safe_tick_fields(tick))
        return NotchSdt.decode(self._safe.secured(telegram.encode()))

    def _status(self) -> Telegram:
        lost_flag = ControllerFlag.MESSAGE_LOST if self.lost_messages else 0
        return self._reports.make(self._output, self.guard.level, lost_flag, self._steps, self._overruns)
