"""Before the run: the bus administrator finds the other nodes, compares the runs that they state, and waits for the
start."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from railhil.bus.administrator import Administrator
from railhil.bus.codes import SupCommand
from railhil.bus.errors import BusError, PeerSilent
from railhil.bus.ident import CtlIdent, Ident, Role, SupIdent, make_ident
from railhil.bus.telegrams import SupCmd
from railhil.common.digits import count_of
from railhil.dbc import Contract, Port
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

#: Polls for an answer that must come.
_DEMANDS_MAX = 200


def plant_ident(scenario: AnyScenario, run: RunSpec) -> Ident:
    """The plant's statement of the run."""
    contract = scenario.installed_system.contract
    return make_ident(
        Role.PLANT, scenario.sha256, seed=run.seed, perturbed=run.perturbed, pace=run.pace, contract=contract
    )


class Refused(BusError):
    """The nodes do not agree on the run; the text names both sides."""

    exit_code = 2


class Handshake:
    """Finds the other nodes and compares the runs that they state.

    :param own: the run that the plant is about to make.
    :param appear_s: how long the other nodes may take to appear, on the wall clock.
    """

    def __init__(self, administrator: Administrator, own: Ident, contract: Contract, appear_s: float) -> None:
        #: The run of the plant, repeated during it; :meth:`agree` completes it by the controller's statement.
        self.own = own
        self._administrator = administrator
        self._contract = contract
        self._appear_s = appear_s

    def agree(self) -> None:
        """Wait for controller and supervisor, compare the runs that the nodes state, wait for the start.

        :raises PeerSilent: a node did not appear.
        :raises Refused: the nodes disagree, or the supervisor does not start the run.
        """
        self._find_nodes()
        store, contract = self._administrator.store, self._contract
        self._administrator.queue.publish(self.own)
        differences: list[str] = []
        for telegram in (CtlIdent, SupIdent):
            self._demand(contract.port(telegram.PORT))
            other: Ident | None = store.read(telegram, 0)[0]
            if other is not None:
                differences += self.own.differences(other)
        if differences:
            raise Refused("; ".join(differences))
        self._demand(contract.port(SupCmd.PORT))
        order = store.read(SupCmd, 0)[0]
        if order is None or order.command != SupCommand.START:
            raise Refused("the supervisor did not start the run")
        controller = store.read(CtlIdent, 0)[0]
        if controller is not None:
            self.own = replace(
                self.own, law=controller.law, arithmetic=controller.arithmetic, indexing=controller.indexing
            )

    def _find_nodes(self) -> None:
        administrator = self._administrator
        missing = administrator.find_devices((Role.CONTROLLER, Role.SUPERVISOR), round(self._appear_s * 1e9))
        if missing:
            names = " and ".join(Role(device).name.lower() for device in sorted(missing))
            why = f"no answer within {self._appear_s:g} s"
            if refused := _counted(administrator.refused_status):
                can_id = f"{self._contract.device_status_id:03X}"
                why = f"no good answer within {self._appear_s:g} s, refused on identifier {can_id}: {refused}"
            raise PeerSilent(f"bus administrator waits for {names}: {why}")

    def _demand(self, port: Port) -> None:
        """A poll that must be answered, regardless of the pacing."""
        store = self._administrator.store
        before = Counter(store.counters)
        for _ in range(_DEMANDS_MAX):
            if self._administrator.poll(port):
                return
        refused = _counted(store.counters - before)
        if refused:
            raise PeerSilent(f"{port.source} does not answer the handshake ({port.name}) well: refused {refused}")
        raise PeerSilent(f"{port.source} does not answer the handshake ({port.name})")


def _counted(causes: Counter[str]) -> str:
    """Number of refusals by cause, in words."""
    return ", ".join(f"{count_of(count, 'time')} {cause.replace('_', ' ')}" for cause, count in sorted(causes.items()))
