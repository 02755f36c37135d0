"""Packets of frames: exchanged between a client and the hub, on the pipes of a run, kept in lists of frames.

Every packet is one of the following (a packet is one AF_UNIX SEQPACKET record; on TCP it is a big-endian u16 length
followed by that many bytes):

1. *hello*, JSON in UTF-8, the first packet in each direction::

       client -> hub   {"railhil_hub": 1, "name": "plant", "receive_own": false}
       hub -> client   {"railhil_hub": 1, "bitrate_model": false, "arbitration": false, "bitrate_bps": null,
                        "data_bitrate_bps": null, "queue_limit_bytes": 67108864}
                or     {"railhil_hub": 1, "error": "one line that says why not"}

2. *batch* of 1..256 classic frames, each one ``struct can_frame`` of Linux in native byte order::

        0       4   5      8               16
       +-------+---+------+---------------+
       |  id   |len| pad  |     data      |     id bits: 31 EFF, 30 RTR, 29 ERR, 28..0 identifier
       +-------+---+------+---------------+

3. one CAN FD frame, ``struct canfd_frame``::

        0       4   5     6    8                          72
       +-------+---+-----+----+--- ... ------------------+
       |  id   |len|flags|pad |     data                 |     flags: 1 BRS, 2 ESI
       +-------+---+-----+----+--- ... ------------------+

4. *roles*, to clients that asked for it in their hello (``"hears_roles": true``): which nodes of a bench are connected,
   sent whenever that changes, after all packets from a client that has left. A client states with ``"role"`` that it is
   a node. JSON in UTF-8, with a blank at its end if needed for an odd length, which no packet of frames has::

       hub -> client   {"roles": ["controller", "plant"]}

5. on a hub with ``--faults``, *orders* (:mod:`railhil.bus.hub.disturbances`) and, to clients that asked for it
   (``"hears_faults": true``), *notices*: the client's own state when it has changed; an order that found no client;
   nodes that did not get the client's packet of that number (counted from 1), or whose packet did not get to the
   client. JSON in UTF-8 of odd length, as 4; beside them such clients get error frames::

       client -> hub   {"order": {"what": "errors", "who": "controller", "count": 5}}
       hub -> client   {"host": {"state": "error-passive", "tec": 136, "rec": 0, "line": "A", "switch_overs": 0,
                        "full": false}}
                or     {"missed": "bus_off controller"}
                or     {"cut_off": ["controller"], "packet": 4711}    or    {"cut_off": ["controller"]}

A client that asked for its own frames (``receive_own``) gets them at their place in the total order, as the
packet it sent followed by the four bytes :data:`OWN_MARK`; bit 2 of the packet length distinguishes them.
Source of the structs and flag bits: ``linux/can.h``.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from struct import Struct
from typing import TYPE_CHECKING, Any, Final

from railhil.bus.frame import BRS, ERROR, EXTENDED, FD, REMOTE, Frame, quick_frame

if TYPE_CHECKING:
    import can

PROTOCOL_VERSION: Final = 1
CLASSIC_SIZE: Final = 16
FD_SIZE: Final = 72
MAX_BATCH_FRAMES: Final = 256
MAX_PACKET_SIZE: Final = MAX_BATCH_FRAMES * CLASSIC_SIZE
OWN_MARK = b"own\x00"
OWN_LENGTH_BIT = 4
NOTICE_LENGTH_BIT: Final = 1
#: Node names used in the hello.
ROLES: Final = ("plant", "controller", "supervisor")

EFF_FLAG: Final = 0x8000_0000
RTR_FLAG: Final = 0x4000_0000
ERR_FLAG: Final = 0x2000_0000
EFF_MASK: Final = 0x1FFF_FFFF
SFF_MASK: Final = 0x7FF
FD_BRS: Final = 1
FD_ESI: Final = 2

#: The payload lengths that a CAN FD data length code can express.
FD_LENGTHS: Final = frozenset((*range(9), 12, 16, 20, 24, 32, 48, 64))

_CLASSIC: Final = Struct("=IB3x8s")
_FD: Final = Struct("=IBB2x64s")


def fault_of(packet: bytes) -> str | None:
    """The fault of a frame packet, or ``None``. Checks only lengths, all of a batch in one step."""
    size = len(packet)
    if size == FD_SIZE:
        if packet[4] in FD_LENGTHS:
            return None
        return f"CAN FD frame with payload length {packet[4]}, allowed: 0..8, 12, 16, 20, 24, 32, 48, 64"
    if size == 0 or size % CLASSIC_SIZE or size > MAX_PACKET_SIZE:
        shown = f"more than {MAX_PACKET_SIZE}" if size > MAX_PACKET_SIZE else str(size)
        return f"packet of {shown} bytes, allowed: 16 to {MAX_PACKET_SIZE} in steps of 16, or {FD_SIZE}"
    longest = max(packet[4::CLASSIC_SIZE])
    if longest > 8:
        return f"classic frame with payload length {longest}, allowed: 0..8"
    return None


# --- hello ------------------------------------------------------------------------------------------------


def encode_hello(**properties: object) -> bytes:
    """Hello packet with the protocol version and ``properties`` (JSON values)."""
    return json.dumps({"railhil_hub": PROTOCOL_VERSION, **properties}).encode()


def decode_hello(packet: bytes) -> dict[str, Any]:
    """Properties of a hello packet.

    Raises ValueError with one line if it is not a hello or has another protocol version.
    """
    try:
        hello = json.loads(packet.decode())
    except (ValueError, RecursionError):
        hello = None
    if not isinstance(hello, dict) or "railhil_hub" not in hello:
        raise ValueError(f"no hello as first packet: found {packet[:24]!r}, expected JSON with the key 'railhil_hub'")
    if hello["railhil_hub"] != PROTOCOL_VERSION:
        found = hello["railhil_hub"]
        raise ValueError(f"hello: key 'railhil_hub': found {found!r}, allowed: {PROTOCOL_VERSION}")
    return hello


def role_of(hello: dict[str, Any]) -> str | None:
    """The role of a client in a bench; None: it is not a node. Raises ValueError with one line."""
    role = hello.get("role")
    if role is None or role in ROLES:
        return role
    raise ValueError(f"hello: key 'role': found {role!r:.60}, allowed: {', '.join(ROLES)}")


def encode_roles(roles: Sequence[str]) -> bytes:
    """Packet that lists the connected nodes; of odd length."""
    return encode_notice(roles=sorted(set(roles)))


def encode_notice(**content: object) -> bytes:
    """A packet of JSON, made odd in length to tell it from packets of frames."""
    packet = json.dumps(content).encode()
    return packet if len(packet) & NOTICE_LENGTH_BIT else packet + b" "


def decode_notice(packet: bytes) -> dict[str, Any]:
    """The content of a packet of odd length. Raises ValueError with one line if it is not a JSON object."""
    try:
        content = json.loads(packet)
    except (ValueError, RecursionError):
        content = None
    if not isinstance(content, dict):
        raise ValueError(f"packet of odd length: found {packet[:24]!r}, allowed: a JSON object")
    return content


# --- frames -----------------------------------------------------------------------------------------------


def _wire_id(can_id: int, extended: bool, remote: bool, error: bool) -> int:
    limit = EFF_MASK if extended or error else SFF_MASK
    if not 0 <= can_id <= limit:
        raise ValueError(f"CAN identifier 0x{can_id:X}, allowed: 0..0x{limit:X}")
    return can_id | (EFF_FLAG if extended else 0) | (RTR_FLAG if remote else 0) | (ERR_FLAG if error else 0)


def _pack(wire_id: int, length: int, data: bytes | bytearray, fd_flags: int | None) -> bytes:
    if fd_flags is None:
        if length > 8:
            raise ValueError(f"frame 0x{wire_id & EFF_MASK:X}: payload of {length} bytes, allowed: 0..8 (64 with FD)")
        return _CLASSIC.pack(wire_id, length, data)
    if length not in FD_LENGTHS:
        allowed = "0..8, 12, 16, 20, 24, 32, 48, 64"
        raise ValueError(f"FD frame 0x{wire_id & EFF_MASK:X}: payload of {length} bytes, allowed: {allowed}")
    if wire_id & RTR_FLAG:
        raise ValueError(f"FD frame 0x{wire_id & EFF_MASK:X}: CAN FD has no remote frames")
    return _FD.pack(wire_id, length, fd_flags, data)


def pack_frame(frame: Frame) -> bytes:
    """One frame as 16 bytes, or 72 with FD. Raises ValueError for values that no CAN frame can hold.

    A remote frame requests ``len(frame.data)`` bytes; the bytes themselves are not sent.
    """
    can_id, data, flags = frame
    if not flags and 0 <= can_id <= SFF_MASK and len(data) <= 8:
        return _CLASSIC.pack(can_id, len(data), data)
    remote = bool(flags & REMOTE)
    wire_id = _wire_id(can_id, bool(flags & EXTENDED), remote, bool(flags & ERROR))
    fd_flags = (FD_BRS if flags & BRS else 0) if flags & FD else None
    return _pack(wire_id, len(data), b"" if remote else data, fd_flags)


def _pack_plain(frames: Sequence[Frame]) -> bytes | None:
    """Frames without flags as one batch (the bench's own traffic); None: some have flags. Raises ValueError as
    :func:`pack_frame`."""
    pack = _CLASSIC.pack
    parts = []
    for can_id, data, flags in frames:
        if flags:
            return None
        size = len(data)
        if size > 8 or not 0 <= can_id <= SFF_MASK:
            raise ValueError(f"CAN identifier 0x{can_id:X} with {size} bytes, allowed: 0..0x{SFF_MASK:X}, 0..8")
        parts.append(pack(can_id, size, data))
    return b"".join(parts)


def pack_frames(frames: Sequence[Frame]) -> list[bytes]:
    """Frames packed in order: up to 256 classic frames per packet, every CAN FD frame in its own.

    Raises ValueError as :func:`pack_frame`.
    """
    if len(frames) <= MAX_BATCH_FRAMES:
        plain = _pack_plain(frames)
        if plain is not None:
            return [plain] if plain else []
    packets: list[bytes] = []
    batch: list[bytes] = []
    for frame in frames:
        packed = pack_frame(frame)
        if batch and (frame.flags & FD or len(batch) == MAX_BATCH_FRAMES):
            packets.append(b"".join(batch))
            batch = []
        if frame.flags & FD:
            packets.append(packed)
        else:
            batch.append(packed)
    if batch:
        packets.append(b"".join(batch))
    return packets


def pack_message(message: can.Message) -> bytes:
    """One python-can message as 16 bytes, or 72 with FD. Raises ValueError for values that no CAN frame can hold."""
    remote = message.is_remote_frame
    wire_id = _wire_id(message.arbitration_id, message.is_extended_id, remote, message.is_error_frame)
    if not remote and message.dlc != len(message.data):
        found = f"dlc {message.dlc} with {len(message.data)} data bytes"
        raise ValueError(f"frame 0x{message.arbitration_id:X}: {found}, allowed: equal")
    fd_flags = None
    if message.is_fd:
        fd_flags = (FD_BRS if message.bitrate_switch else 0) | (FD_ESI if message.error_state_indicator else 0)
    return _pack(wire_id, message.dlc, b"" if remote else message.data, fd_flags)


def _frame(wire_id: int, length: int, data: bytes, flags: int) -> Frame:
    if wire_id & EFF_FLAG:
        flags |= EXTENDED
    if wire_id & RTR_FLAG:
        flags |= REMOTE
    if wire_id & ERR_FLAG:
        flags |= ERROR
    return Frame(wire_id & EFF_MASK, data[:length], flags)


def unpack_frames(packet: bytes, offset: int = 0) -> list[Frame]:
    """Frames of a packet (own mark already removed) from byte ``offset`` on; a remote frame is returned with
    zeros of its length.
    """
    if len(packet) == FD_SIZE:
        wire_id, length, fd_flags, data = _FD.unpack(packet)
        return [_frame(wire_id, length, data, FD | (BRS if fd_flags & FD_BRS else 0))]
    return [
        quick_frame((wire_id, data[:length], 0)) if wire_id <= SFF_MASK else _frame(wire_id, length, data, 0)
        for wire_id, length, data in _CLASSIC.iter_unpack(packet[offset:] if offset else packet)
    ]


def unpack_message(packet: bytes, offset: int, timestamp_s: float, channel: str, own: bool) -> can.Message:
    """The python-can message at byte ``offset`` of a packet; ``own`` says that this client sent it."""
    from can import Message

    is_fd = len(packet) == FD_SIZE
    fd_flags = 0
    if is_fd:
        wire_id, length, fd_flags, data = _FD.unpack(packet)
    else:
        wire_id, length, data = _CLASSIC.unpack_from(packet, offset)
    remote = bool(wire_id & RTR_FLAG)
    return Message(
        timestamp=timestamp_s,
        arbitration_id=wire_id & EFF_MASK,
        is_extended_id=bool(wire_id & EFF_FLAG),
        is_remote_frame=remote,
        is_error_frame=bool(wire_id & ERR_FLAG),
        channel=channel,
        dlc=length,
        data=b"" if remote else data[:length],
        is_fd=is_fd,
        is_rx=not own,
        bitrate_switch=bool(fd_flags & FD_BRS),
        error_state_indicator=bool(fd_flags & FD_ESI),
    )
