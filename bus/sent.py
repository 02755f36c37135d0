"""What a node has put on the bus, kept by the node itself: the record is compared with it after the run.

A recorder on a shared bus cannot tell who has sent a frame. The sender can: a frame that it did not send was sent by
somebody else.
"""

from __future__ import annotations

import json
import sys
import zlib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from railhil.bus.frame import Frame
from railhil.common.exit_codes import finish_undisturbed
from railhil.common.whole_file import whole_file

#: Frames that are kept as they are before their data are put together: a node sends about 500 per simulated second.
_BATCH = 4096
#: Fast compression: the file is read once, and then removed.
_LEVEL = 1


class SentFrames:
    """Data of every frame that a node has sent, by CAN identifier. All frames of an identifier have the same length,
    except under a fault (truncated ones, no answer); those are counted by their content.

    :param path: the file for :meth:`write`.
    :param node: the node, for messages.
    """

    def __init__(self, path: Path, node: str) -> None:
        self._path = path
        self._node = node
        self._waiting: list[Frame] = []
        self._data: dict[int, bytearray] = {}
        self._length: dict[int, int] = {}
        self._irregular: dict[int, Counter[str]] = {}
        #: What the node has received (:mod:`railhil.bus.reception`); None: it does not say.
        self.received: dict[str, Any] | None = None

    def note(self, frames: Sequence[Frame]) -> None:
        """Take frames that are being sent."""
        self._waiting += frames
        if len(self._waiting) > _BATCH:
            self._sort()

    def _sort(self) -> None:
        for can_id, data, _ in self._waiting:
            if can_id not in self._data:
                self._data[can_id], self._length[can_id] = bytearray(), len(data)
            if len(data) == self._length[can_id]:
                self._data[can_id] += data
            else:
                self._irregular.setdefault(can_id, Counter())[data.hex()] += 1
        self._waiting = []

    def write(self) -> None:
        """Write the file whole or not at all, undisturbed by signals; if it cannot be written, one line on stderr says
        so."""
        finish_undisturbed()
        self._sort()
        frames = {str(can_id): [self._length[can_id], data.hex()] for can_id, data in self._data.items()}
        document = {"frames": frames, "irregular": self._irregular, "received": self.received}
        try:
            with whole_file(self._path) as draft:
                draft.write_bytes(zlib.compress(json.dumps(document).encode(), _LEVEL))
        except OSError as error:
            print(
                f"{self._node}: list of sent frames is lost: {(error.strerror or str(error)).lower()}", file=sys.stderr
            )


class Told(NamedTuple):
    """A node's file: length and data of the frames that it has sent, in order, by CAN identifier; how often it has sent
    which frames of another length; what it received."""

    frames: dict[int, tuple[int, bytes]]
    irregular: dict[int, Counter[bytes]]
    received: dict[str, Any] | None


def read_sent(path: Path) -> Told | None:
    """What a node has written; None without a readable file."""
    try:
        document = json.loads(zlib.decompress(path.read_bytes()))
    except (OSError, ValueError, zlib.error):
        return None
    frames = {int(can_id): (length, bytes.fromhex(data)) for can_id, (length, data) in document["frames"].items()}
    irregular = {
        int(can_id): Counter({bytes.fromhex(data): count for data, count in counts.items()})
        for can_id, counts in document["irregular"].items()
    }
    return Told(frames, irregular, document["received"])
