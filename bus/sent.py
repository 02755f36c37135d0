"""What a node has put on the bus, kept by the node itself: the record is compared with it after the run.

A recorder on a shared bus cannot tell who has sent a frame. The sender can: a frame that it did not send was sent by
somebody else.
"""

from __future__ import annotations

import json
import sys
import zlib
from collections.abc import Sequence
from pathlib import Path

from railhil.bus.frame import ERROR, EXTENDED, REMOTE, Frame
from railhil.common.exit_codes import finish_undisturbed
from railhil.common.whole_file import whole_file

#: Frames that are kept as they are before their data are put together: a node sends about 500 per simulated second.
_BATCH = 4096
#: Fast compression: the file is read once, and then removed.
_LEVEL = 1
#: Frames that carry no telegram; nothing is compared with them.
NO_TELEGRAM = ERROR | EXTENDED | REMOTE
#: Length that an identifier has in the list when its frames differ in length (faults cut and empty frames); no frame
#: is that long. Each is then its length in one byte and its data, filled up.
CODED_BYTES = 65


def coded(data: bytes) -> bytes:
    """A frame's data as :data:`CODED_BYTES` bytes."""
    return bytes([len(data)]) + data.ljust(CODED_BYTES - 1, b"\0")


class SentFrames:
    """Data of every frame that a node has sent, by CAN identifier.

    :param path: the file for :meth:`write`.
    :param node: the node, for messages.
    """

    def __init__(self, path: Path, node: str) -> None:
        self._path = path
        self._node = node
        self._waiting: list[Frame] = []
        self._data: dict[int, bytearray] = {}
        self._length: dict[int, int] = {}

    def note(self, frames: Sequence[Frame]) -> None:
        """Take frames that are being sent."""
        self._waiting += frames
        if len(self._waiting) > _BATCH:
            self._sort()

    def _sort(self) -> None:
        lengths = self._length
        for can_id, data, flags in self._waiting:
            if flags & NO_TELEGRAM:
                continue
            if can_id not in self._data:
                self._data[can_id], lengths[can_id] = bytearray(), len(data) or CODED_BYTES
            if lengths[can_id] != len(data):
                data = self._coded(can_id, data)
            self._data[can_id] += data
        self._waiting = []

    def _coded(self, can_id: int, data: bytes) -> bytes:
        """The coded data of a frame; those of the frames before it are coded too."""
        length, before = self._length[can_id], self._data[can_id]
        if length != CODED_BYTES:
            each = (bytes(before[at : at + length]) for at in range(0, len(before), length))
            self._data[can_id], self._length[can_id] = bytearray(b"".join(map(coded, each))), CODED_BYTES
        return coded(data)

    def write(self) -> None:
        """Write the file whole or not at all, undisturbed by signals; if it cannot be written, one line on stderr says
        so."""
        finish_undisturbed()
        self._sort()
        document = {str(can_id): [self._length[can_id], data.hex()] for can_id, data in self._data.items()}
        try:
            with whole_file(self._path) as draft:
                draft.write_bytes(zlib.compress(json.dumps(document).encode(), _LEVEL))
        except OSError as error:
            print(
                f"{self._node}: list of sent frames is lost: {(error.strerror or str(error)).lower()}", file=sys.stderr
            )


def read_sent(path: Path) -> dict[int, tuple[int, bytes]] | None:
    """Length and data of the frames that a node has sent, in order, by CAN identifier; None without a readable file.

    Where the length is :data:`CODED_BYTES`, each frame is coded.
    """
    try:
        document = json.loads(zlib.decompress(path.read_bytes()))
    except (OSError, ValueError, zlib.error):
        return None
    return {int(can_id): (length, bytes.fromhex(data)) for can_id, (length, data) in document.items()}
