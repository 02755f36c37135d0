"""Slave frames as on a real MVB, which CAN does not carry: for its published examples and the diagrams of the pages."""

from __future__ import annotations

from railhil.bus.mvb import check_sequence


def slave_frame(data: bytes) -> bytes:
    """Each block followed by its check octet.

    :param data: 2, 4, 8, 16 or 32 bytes.
    """
    step = min(len(data), 8)
    blocks = (data[i : i + step] for i in range(0, len(data), step))
    return b"".join(block + bytes([check_sequence(block)]) for block in blocks)
