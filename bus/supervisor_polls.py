"""The polls that the supervisor answers: a recorder that reads in bulk is woken for these alone."""

from __future__ import annotations

from railhil.bus.frame import Frame
from railhil.bus.ident import Role, SupIdent
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame
from railhil.bus.telegrams import SupCmd
from railhil.dbc import Contract


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
