"""Parts of the recorder (:mod:`railhil.record.session`): handshake, commands, and the frames that it inspects."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Collection, Iterable

from railhil.bus.codes import FaultOrder, SupCommand
from railhil.bus.ident import CtlIdent, Ident, PltIdent
from railhil.bus.own_frames import OwnFrames
from railhil.bus.responder import Reading
from railhil.bus.telegrams import SupCmd
from railhil.dbc import Contract, Port
from railhil.record.operator_commands import OperatorCommands
from railhil.record.senders import ForeignFrames


class Handshake:
    """Compares the nodes' handshakes; plant and controller do not know which controller was requested.

    :param own: the run as the supervisor states it.
    """

    def __init__(self, own: Ident) -> None:
        self._own = own
        #: Newest handshake telegram of each other node.
        self._heard: dict[str, Ident] = {}
        #: Disagreements between the nodes, one sentence each; the run is then not started.
        self.disagreements: list[str] = []
        #: Handshake telegrams whose role differs from the role of their port's source.
        self.wrong_roles = 0

    def own(self) -> Ident:
        """SUP_IDENT."""
        return self._own

    def take(self, reading: Reading[Ident]) -> None:
        """Take a handshake telegram, unless its role differs from the role of its port's source."""
        ident = reading.telegram
        if not ident.is_own:
            self.wrong_roles += 1
            return
        self._heard[ident.PORT] = ident
        plant, controller = self._heard.get(PltIdent.PORT), self._heard.get(CtlIdent.PORT)
        if ident.PORT == CtlIdent.PORT and plant is not None and controller is not None:
            found = plant.differences(controller) + plant.differences(self._own)
            self.disagreements = found or controller.differences(self._own)


class SupervisorCommands:
    """Makes SUP_CMD: start, stop, the orders of an operator and of a test.

    :param operator: gives the orders of an operator; None: there are none.
    :param on_progress: called at each SUP_CMD poll with the simulation time in s; None: nothing is called.
    :param now_s: the simulation time in s.
    """

    def __init__(
        self,
        handshake: Handshake,
        operator: OperatorCommands | None,
        on_progress: Callable[[float], None] | None,
        now_s: Callable[[], float],
    ) -> None:
        self.operator = operator
        #: Monotonic wall time of the last poll of SUP_CMD.
        self.last_poll_ns = 0
        self._handshake = handshake
        self._on_progress = on_progress
        self._now_s = now_s
        self._life = 0
        # SUP_CMD sent in this run.
        self._answers = 0
        # Numbers of faults and the orders for them, not sent yet.
        self._orders: deque[tuple[int, FaultOrder]] = deque()

    def make(self) -> SupCmd:
        """The answer to a poll of SUP_CMD."""
        self.last_poll_ns = time.monotonic_ns()
        self._life = (self._life + 1) & 0xF
        if self._on_progress is not None:
            self._on_progress(self._now_s())
        self._answers += 1
        command = SupCommand.STOP if self._handshake.disagreements else SupCommand.START
        number, order = self._orders.popleft() if self._orders else (0, FaultOrder.NONE)
        if self.operator is not None and self._answers > 1 and command is SupCommand.START:
            command, number, order = self.operator.answer(self._answers, self._now_s())
        return SupCmd(command=command, fault_number=number, fault_order=order, life=self._life)

    def order(self, number: int, order: FaultOrder) -> None:
        """Send an order for a fault that is triggered by hand, with the next SUP_CMD that is free.

        It acts from the tick after that SUP_CMD on; the certificate then names this instant.

        :param number: place of the fault in the scenario's list, from 1.
        """
        self._orders.append((number, order))


class InspectedFrames:
    """The frames that a recorder inspects, by identifier; all others, the majority, are only recorded.

    :param sinks: ports that the supervisor receives.
    :param truth_ids: identifiers of the truth, if it keeps the time of the record.
    """

    def __init__(self, contract: Contract, sinks: Iterable[Port], truth_ids: Collection[int]) -> None:
        clock_port, opening = contract.clock_port, contract.port(PltIdent.PORT)
        self.poll_id = contract.poll_id
        self.status_id = contract.device_status_id
        self.clock_ids = {clock_port.address, clock_port.fd_id}
        self.opening_ids = {opening.address, opening.fd_id}
        self.truth_ids = set(truth_ids)
        supervised = [port for port in contract.ports if port.source == "supervisor"]
        #: Frames under the supervisor's own identifiers that came from the bus, by port.
        self.foreign_frames = {port.name: ForeignFrames() for port in supervised}
        #: The same by identifier.
        self.foreign_by_id = {
            can_id: self.foreign_frames[port.name] for port in supervised for can_id in (*port.can_ids, port.fd_id)
        }
        received = {can_id for port in sinks for can_id in (*port.can_ids, port.fd_id)}
        own = OwnFrames(contract).flags
        #: Flags of all of them, for frames of the contract.
        self.flags = {
            can_id: own[can_id]
            for can_id in (self.status_id, self.poll_id, *self.truth_ids, *received, *self.foreign_by_id)
        }
