"""A CAN frame as the bench passes it around: a plain tuple, cheap to make and to compare.

python-can's :class:`can.Message` appears only at the edge (transports and log files): it costs more than a
microsecond to build, and its equality is identity.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    import can

#: ``Frame.flags`` bits.
EXTENDED: Final = 1
REMOTE: Final = 2
ERROR: Final = 4
FD: Final = 8
BRS: Final = 16


class Frame(NamedTuple):
    """One CAN frame.

    ``can_id``: 11-bit identifier (29-bit when ``flags`` has EXTENDED). ``data``: 0..8 bytes, 0..64 with FD.
    ``flags``: 0 for the plain data frames that carry MVB telegrams. A remote frame has no data on the wire; here it
    holds as many zero bytes as its length code specifies.
    """

    can_id: int
    data: bytes
    flags: int = 0


#: Makes a :class:`Frame` from a tuple ``(can_id, data, flags)`` in half the time of ``Frame(...)``: for the hot path.
quick_frame: Final[Callable[[tuple[int, bytes, int]], Frame]] = partial(tuple.__new__, Frame)


def to_message(frame: Frame, timestamp_s: float = 0.0) -> can.Message:
    """python-can form of a frame; the identifier is standard unless the frame has the EXTENDED flag."""
    # Nodes on the hub never load python-can: it takes longer than all else that they load.
    from can import Message

    flags = frame.flags
    return Message(
        timestamp=timestamp_s,
        arbitration_id=frame.can_id,
        is_extended_id=bool(flags & EXTENDED),
        is_remote_frame=bool(flags & REMOTE),
        is_error_frame=bool(flags & ERROR),
        is_fd=bool(flags & FD),
        bitrate_switch=bool(flags & BRS),
        dlc=len(frame.data),
        data=b"" if flags & REMOTE else frame.data,
    )


def from_message(message: can.Message) -> Frame:
    """Frame of a python-can message (timestamp and channel are dropped)."""
    flags = 0
    if message.is_extended_id:
        flags |= EXTENDED
    if message.is_remote_frame:
        flags |= REMOTE
    if message.is_error_frame:
        flags |= ERROR
    if message.is_fd:
        flags |= FD
    if message.bitrate_switch:
        flags |= BRS
    data = bytes(message.dlc) if flags & REMOTE else bytes(message.data)
    return Frame(message.arbitration_id, data, flags)
