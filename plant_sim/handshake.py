"""Before the run: the bus administrator finds the other nodes, compares the runs that they state, and waits for the
start."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from railhil.bus.administrator import Administrator
from railhil.bus.codes import SupCommand
from railhil.bus.errors import BusError, PeerSilent
from railhil.bus.ident import CtlIdent, Ident, Role, SupIdent
from railhil.bus.store import TrafficStore
from railhil.bus.telegrams import SupCmd
from railhil.common.digits import count_of
from railhil.dbc import Contract, Port

#: Polls for an answer that must come.
_DEMANDS_MAX = 200


class Refused(BusError):
    """The nodes do not agree on the run; the text names both sides."""

    exit_code = 2


def agree(administrator: Administrator, store: TrafficStore, own: Ident, contract: Contract, appear_s: float) -> Ident:
    """Wait for controller and supervisor, compare the runs that the nodes state, wait for the start.

    :param own: the run that the plant is about to make. :param appear_s: how long the other nodes may take to appear,
        on the wall clock.
    :returns: the same, completed by the controller's statement; it is repeated during the run.
    :raises PeerSilent: a node did not appear.
    :raises Refused: the nodes disagree, or the supervisor does not start the run.
    """
    missing = administrator.find_devices((Role.CONTROLLER, Role.SUPERVISOR), round(appear_s * 1e9))
    if missing:
        names = " and ".join(Role(device).name.lower() for device in sorted(missing))
        refused = _counted(administrator.refused_status)
        if refused:
            can_id = f"{contract.device_status_id:03X}"
            raise PeerSilent(
                f"bus administrator waits for {names}: no good answer within {appear_s:g} s, "
                f"refused on identifier {can_id}: {refused}"
            )
        raise PeerSilent(f"bus administrator waits for {names}: no answer within {appear_s:g} s")
    administrator.publish(own)
    differences: list[str] = []
    for telegram in (CtlIdent, SupIdent):
        _demand(administrator, store, contract.port(telegram.PORT))
        other: Ident | None = store.read(telegram, 0)[0]
        if other is not None:
            differences += own.differences(other)
    if differences:
        raise Refused("; ".join(differences))
    _demand(administrator, store, contract.port(SupCmd.PORT))
    order = store.read(SupCmd, 0)[0]
    if order is None or order.command != SupCommand.START:
        raise Refused("the supervisor did not start the run")
    controller = store.read(CtlIdent, 0)[0]
    if controller is None:
        return own
    return replace(own, law=controller.law, arithmetic=controller.arithmetic, indexing=controller.indexing)


def _counted(causes: Counter[str]) -> str:
    """Number of refusals by cause, in words."""
    return ", ".join(f"{count_of(count, 'time')} {cause.replace('_', ' ')}" for cause, count in sorted(causes.items()))


def _demand(administrator: Administrator, store: TrafficStore, port: Port) -> None:
    """A poll that must be answered, regardless of the pacing."""
    before = Counter(store.counters)
    for _ in range(_DEMANDS_MAX):
        if administrator.poll(port):
            return
    refused = _counted(store.counters - before)
    if refused:
        raise PeerSilent(f"{port.source} does not answer the handshake ({port.name}) well: refused {refused}")
    raise PeerSilent(f"{port.source} does not answer the handshake ({port.name})")
