"""Which frames are of the wire contract: its identifiers, in the form that each of them has there."""

from __future__ import annotations

from typing import Final

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame
from railhil.dbc import Contract

#: Flags of frames that are no telegrams, whatever their identifier: they have no owner.
NO_TELEGRAM: Final = ERROR | EXTENDED | REMOTE


class OwnFrames:
    """The frames of a contract, as a container; all others on the bus are somebody else's.

    An extended frame whose number is that of a standard identifier is another frame, and so is a remote or an error
    frame, and one of CAN FD where the contract has a classic one. Length and content are not looked at: a damaged
    telegram is one nevertheless.
    """

    __slots__ = ("flags",)

    def __init__(self, contract: Contract) -> None:
        #: By identifier: the flags that a frame has there, beside BRS.
        self.flags = {can_id: 0 for port in contract.ports for can_id in port.can_ids}
        self.flags |= {port.fd_id: FD for port in contract.ports}
        self.flags |= dict.fromkeys((contract.poll_id, contract.device_status_id), 0)

    def __contains__(self, frame: Frame) -> bool:
        can_id, _, flags = frame
        return self.flags.get(can_id) == flags & ~BRS
