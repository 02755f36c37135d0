"""Frames that are not of the wire contract although they have its identifiers."""

from __future__ import annotations

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.bus.mvb import master_frame
from railhil.dbc import wire_contract
from railhil.wire.ato import NotchCmd

CONTRACT = wire_contract()
_BUS = (CONTRACT.poll_id, CONTRACT.device_status_id)
CLASSIC = sorted({*_BUS, *(one for port in CONTRACT.ports for one in port.can_ids)})
FD_ONLY = sorted({port.fd_id for port in CONTRACT.ports})


def others() -> list[Frame]:
    """Every identifier of the contract in every form that it does not have there."""
    poll = master_frame(NotchCmd.port().f_code, NotchCmd.port().address).data
    strange = (EXTENDED, REMOTE, ERROR, EXTENDED | REMOTE, EXTENDED | FD)
    found = [Frame(one, poll, flags) for one in CLASSIC for flags in (*strange, FD, FD | BRS)]
    return found + [Frame(one, poll, flags) for one in FD_ONLY for flags in (*strange, 0)]


OTHERS = others()


OTHERS = others()
