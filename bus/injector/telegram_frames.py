"""Telegrams as lists of frames: their process data, and the same telegram with other data or other check sequences."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from railhil.bus.frame import FD, Frame
from railhil.bus.mvb import check_sequence
from railhil.dbc import Port, Signal

#: The frames of one telegram, in the order of sending.
Telegram = list[Frame]


def is_whole(port: Port, frames: Sequence[Frame]) -> bool:
    """Whether frames are one telegram of a port in either form, as its source makes them."""
    if len(frames) == 1 and frames[0].can_id == port.fd_id:
        return True
    return tuple(frame.can_id for frame in frames) == port.can_ids


def data_of(port: Port, frames: Sequence[Frame]) -> bytes:
    """Process data of a telegram."""
    if frames[0].flags & FD or port.single_frame:
        return frames[0].data[: port.data_bytes]
    return b"".join(frame.data for frame in frames[: port.blocks])


def _blocks(port: Port, data: bytes) -> list[bytes]:
    return [data] if port.single_frame else [data[start : start + 8] for start in range(0, len(data), 8)]


def with_data(port: Port, frames: Sequence[Frame], data: bytes) -> Telegram:
    """The telegram with other process data and the check sequences that go with them."""
    checks = bytes(map(check_sequence, _blocks(port, data)))
    return _made(port, frames, data, checks)


def with_checks(port: Port, frames: Sequence[Frame], change: Callable[[bytes], bytes]) -> Telegram:
    """The telegram with other check sequences.

    :param change: the check octets -> as many others.
    """
    return _made(port, frames, data_of(port, frames), change(checks_of(port, frames)))


def checks_of(port: Port, frames: Sequence[Frame]) -> bytes:
    """Check octets of a telegram, one for each block."""
    if port.single_frame:
        return frames[0].data[4:5]
    if frames[0].flags & FD:
        return frames[0].data[port.data_bytes : port.data_bytes + port.blocks]
    return frames[-1].data[: port.blocks]


def _made(port: Port, frames: Sequence[Frame], data: bytes, checks: bytes) -> Telegram:
    first = frames[0]
    if port.single_frame:
        return [first._replace(data=data.ljust(4, b"\0") + checks + first.data[5:])]
    if first.flags & FD:
        size = port.data_bytes
        return [first._replace(data=data + checks + first.data[size + port.blocks :])]
    blocks = [frame._replace(data=block) for frame, block in zip(frames, _blocks(port, data), strict=False)]
    trailer = frames[-1]
    return [*blocks, trailer._replace(data=checks + trailer.data[port.blocks :])]


def with_signal(data: bytes, signal: Signal, raw: int) -> bytes:
    """Process data with another raw value of a signal; it wraps if it does not fit."""
    bits = len(data) * 8
    shift = bits - signal.first_bit - signal.length
    mask = ((1 << signal.length) - 1) << shift
    word = int.from_bytes(data) & ~mask | (raw % (1 << signal.length)) << shift
    return word.to_bytes(len(data))


def shown(frames: Sequence[Frame]) -> str:
    """A telegram as text for the log: identifiers and bytes in hex."""
    return " ".join(f"{frame.can_id:03X}#{frame.data.hex().upper()}" for frame in frames)
