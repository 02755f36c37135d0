"""A controller that is no code of ours: a program or a board that takes the frames of the bus and answers its polls.

:class:`ForeignNode` stands for it in a run, so it runs on every bus of the bench and under the faults of a controller.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, Protocol

from railhil.bus.codes import Event, ends_run
from railhil.bus.frame import Frame
from railhil.bus.ident import CtlIdent, Role
from railhil.bus.mvb import check_sequence, parse_master_frame
from railhil.bus.own_frames import answer_ids, no_answer
from railhil.bus.responder import Reading, Responder
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.common.errors import InputError, Words
from railhil.controller_node.laws import law_class
from railhil.scenarios.given import GivenController
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.scenario_documents import nominal_sha256


class Outside(Protocol):
    """The controller at the other end, at the start of a run."""

    def exchange(self, frames: Sequence[Frame], /) -> Sequence[Frame]:
        """Hand it frames in bus order, of which the last one is a poll of it; returns the frames of its answer.

        :raises InputError: it has ended, does not answer, or says that it cannot go on.
        """

    def figures(self) -> dict[str, Any] | None:
        """What was measured on it, for :data:`railhil.scenarios.given.TARGET`; None: nothing."""

    def close(self) -> None:
        """End it."""


class ForeignNode:
    """See :class:`railhil.controller_node.controller.AnyController`. Frames wait here until a poll of the controller:
    no other frame is answered.

    :raises InputError: the law that it is an export of is not installed.
    """

    #: Its node states nothing of its own: it has no telemetry, and no counters.
    controller = None
    lost_messages = 0

    def __init__(self, scenario: AnyScenario, law: LawSpec, outside: Outside) -> None:
        contract = scenario.installed_system.contract
        schedule = Schedule.from_contract(scenario.timing.base_tick_ns, scenario.timing.port_period_ns, contract)
        ports = dict.fromkeys((contract.clock_port.name, TimeSync.PORT, RunEvent.PORT))
        sinks = [contract.port(name) for name in ports]
        # Only for the time and the end of the run.
        self._responder = Responder(Role.CONTROLLER, schedule, sinks, {}, contract=contract, paced=False)
        self._responder.on(RunEvent, self._event)
        self._poll_id = contract.poll_id
        self._own = answer_ids(contract, Role.CONTROLLER)
        ident = contract.port(CtlIdent.PORT)
        self._ident_polled = (ident.f_code, ident.address)
        self._stated = self._nominal = bytes.fromhex(scenario.sha256[:8])
        if scenario.faults:
            self._nominal = bytes.fromhex(nominal_sha256(scenario)[:8])
        self._outside = outside
        self._waiting: list[Frame] = []
        self.law = law
        self.law_type: Any = law_class(law, scenario)
        self.ended: Event | None = None
        self.counters: dict[str, int] = {}
        self.lost_by_mailbox: dict[str, int] = {}

    def handle(self, frame: Frame) -> list[Frame]:
        """Take one frame in bus order; returns the answer to a poll of the controller."""
        self._waiting.append(frame)
        if frame.can_id != self._poll_id:
            self._responder.handle(frame)
            if self.ended is not None:
                # It hears the end of the run.
                self._hand_over()
            return []
        polled = parse_master_frame(frame.data)
        if polled is None or polled not in self._own:
            return []
        answer = self._hand_over()
        if polled == self._ident_polled:
            return self._state_run(answer)
        nothing = no_answer(self._own[polled])
        if not self.lockstep or any(one.can_id == nothing.can_id for one in answer):
            return answer
        # The bus administrator does not wait for an answer, or the end of one, that never comes.
        return [*answer, nothing]

    def _state_run(self, answer: list[Frame]) -> list[Frame]:
        """Its CTL_IDENT, of the run with its faults: they are the bench's, and an export knows only its scenario."""
        if len(answer) < 2 or answer[0].data[:4] != self._nominal or self._nominal == self._stated:
            return answer
        first = Frame(answer[0].can_id, self._stated + answer[0].data[4:])
        last = Frame(answer[-1].can_id, bytes((check_sequence(first.data),)) + answer[-1].data[1:])
        return [first, *answer[1:-1], last]

    def _hand_over(self) -> list[Frame]:
        frames, self._waiting = self._waiting, []
        return list(self._outside.exchange(frames))

    def _event(self, reading: Reading[RunEvent]) -> None:
        if ends_run(reading.telegram.event):
            self.ended = Event(reading.telegram.event)

    @property
    def lockstep(self) -> bool:
        """True unless the pace is known to follow the wall clock."""
        return not self._responder.clock.rate

    def was_out(self, wall_ns: int) -> None:
        """It has a time of its own."""

    def was_stopped(self, sim_ns: int) -> None:
        """It has a time of its own."""

    def figures(self) -> dict[str, Any] | None:
        """See :class:`Outside`."""
        return self._outside.figures()

    def close(self) -> None:
        """End it."""
        self._outside.close()


class OutsideController(GivenController):
    """A controller that gets frames."""

    @abstractmethod
    def start(self, scenario: AnyScenario, run: RunSpec) -> Outside:
        """The controller at the start of a run.

        :raises InputError: it cannot be built or started.
        """

    def make_node(self, scenario: AnyScenario, run: RunSpec, *, fd: bool, bit_rate: int | None) -> Any:
        if fd:
            raise InputError("command line", "--fd", Words("CAN FD"), f"classic CAN with {self.text}")
        outside = self.start(scenario, run)
        try:
            return ForeignNode(scenario, run.law, outside)
        except BaseException:
            outside.close()
            raise
