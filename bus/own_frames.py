"""The frames of the wire contract, each identifier in the form that it has there, and the polls of the supervisor."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.ident import Role, SupIdent
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame
from railhil.bus.telegrams import SupCmd
from railhil.dbc import Contract

#: Flags of frames that are no telegrams, whatever their identifier: they have no owner.
NO_TELEGRAM: Final = ERROR | EXTENDED | REMOTE


class OwnFrames:
    """The frames of a contract, as a container; all other frames on the bus are foreign.

    An extended frame with the number of a standard identifier is foreign, and so are a remote frame, an error frame,
    and a CAN FD frame where the contract has a classic one. Length and content do not matter: a damaged telegram
    belongs to the contract, too.
    """

    __slots__ = ("flags",)

    def __init__(self, contract: Contract) -> None:
        #: Flags of a frame by its identifier, without BRS.
        self.flags = {can_id: 0 for port in contract.ports for can_id in port.can_ids}
        self.flags |= {port.fd_id: FD for port in contract.ports}
        self.flags |= dict.fromkeys((contract.poll_id, contract.device_status_id), 0)

    def __contains__(self, frame: Frame) -> bool:
        can_id, _, flags = frame
        return self.flags.get(can_id) == flags & ~BRS


def supervisor_polls(contract: Contract) -> tuple[Frame, Frame, Frame]:
    """The polls of SUP_CMD, of SUP_IDENT, and of its device status.

    :param contract: of the run's system.
    """
    command, ident = (contract.port(name) for name in (SupCmd.PORT, SupIdent.PORT))
    return (
        master_frame(command.f_code, command.address),
        master_frame(ident.f_code, ident.address),
        master_frame(F_DEVICE_STATUS, Role.SUPERVISOR),
    )


def answer_ids(contract: Contract, role: Role) -> Mapping[tuple[int, int], tuple[int, ...]]:
    """Identifiers of the classic frames of each answer of a node, by F code and address of the poll; also of its device
    status."""
    own = (port for port in contract.ports if port.source == role.name.lower())
    found = {(port.f_code, port.address): port.can_ids for port in own}
    return {**found, (F_DEVICE_STATUS, role.value): (contract.device_status_id,)}


def no_answer(can_ids: Sequence[int]) -> Frame:
    """The frame that means "no answer" in lockstep: an empty one on the last identifier of the answer."""
    return Frame(can_ids[-1], b"")
