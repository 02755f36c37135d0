"""What a node has put on the bus, kept by the node itself: the record is compared with it after the run.

A recorder on a shared bus cannot tell who has sent a frame. The sender can: a frame that it did not send was sent by
somebody else.
"""

from __future__ import annotations

import json
import sys
import zlib
from array import array
from collections.abc import Sequence
from itertools import accumulate
from pathlib import Path
from typing import Any, Final, NamedTuple

from railhil.bus.frame import ERROR, EXTENDED, REMOTE, Frame
from railhil.bus.hub.wire import SFF_MASK
from railhil.common.exit_codes import finish_undisturbed
from railhil.common.whole_file import whole_file

#: Frames that are kept as they are before their data are put together: a node sends about 500 per simulated second.
_BATCH: Final = 4096
#: Fast compression: the file is read once, and then removed.
_LEVEL: Final = 1
#: Flags of frames that are no telegrams, whatever their identifier: they have no owner.
NO_TELEGRAM: Final = ERROR | EXTENDED | REMOTE


class SentFrames:
    """Data of every frame that a node has sent, by CAN identifier.

    The frames of an identifier have one length, except under faults: empty ones ("no answer"), truncated ones, those of
    another port.

    :param path: the file for :meth:`write`.
    :param node: the node, for messages.
    """

    def __init__(self, path: Path, node: str) -> None:
        self._path = path
        self._node = node
        self._waiting: list[Frame] = []
        # Frames put together: identifiers, data, lengths of the data, flags.
        self._ids = array("I")
        self._data = bytearray()
        self._lengths = bytearray()
        self._flags = bytearray()
        # Frames noted as they are packed.
        self._packed = bytearray()
        #: What the node has received (:mod:`railhil.bus.reception`); None: it does not say.
        self.received: dict[str, Any] | None = None

    def note(self, frames: Sequence[Frame]) -> None:
        """Take frames that are being sent."""
        self._waiting += frames
        if len(self._waiting) > _BATCH:
            self._put_together()

    def note_packed(self, packet: bytes) -> None:
        """:meth:`note` for packed classic frames (:mod:`railhil.bus.hub.wire`); a node notes all frames in one way."""
        self._packed += packet

    def _put_together(self) -> None:
        """Without a loop over the frames: a node does this in the middle of its run, and sorts them after it."""
        if not self._waiting:
            return
        ids, data, flags = zip(*self._waiting, strict=True)
        self._ids.extend(ids)
        self._data += b"".join(data)
        self._lengths += bytes(map(len, data))
        self._flags += bytes(flags)
        self._waiting = []

    def _sorted(self) -> dict[int, tuple[bytearray, bytearray]]:
        """Lengths and joined data of the telegrams' frames, by CAN identifier."""
        self._put_together()
        found: dict[int, tuple[bytearray, bytearray]] = {}
        for can_id, data, flags in zip(self._ids, _apart(self._lengths, self._data), self._flags, strict=True):
            if flags & NO_TELEGRAM:
                continue
            if can_id not in found:
                found[can_id] = bytearray(), bytearray()
            lengths, joined = found[can_id]
            lengths.append(len(data))
            joined += data
        if self._packed:
            found |= _by_id(self._packed)
        return found

    def write(self) -> None:
        """Write the file whole or not at all, undisturbed by signals; if it cannot be written, one line on stderr says
        so."""
        finish_undisturbed()
        frames = {str(can_id): [lengths.hex(), data.hex()] for can_id, (lengths, data) in self._sorted().items()}
        document = {"frames": frames, "received": self.received}
        try:
            with whole_file(self._path) as draft:
                draft.write_bytes(zlib.compress(json.dumps(document).encode(), _LEVEL))
        except OSError as error:
            print(
                f"{self._node}: list of sent frames is lost: {(error.strerror or str(error)).lower()}", file=sys.stderr
            )


class Told(NamedTuple):
    """A node's file: data of the frames that it has sent, in order, by CAN identifier; what it received."""

    frames: dict[int, list[bytes]]
    received: dict[str, Any] | None


def read_sent(path: Path) -> Told | None:
    """What a node has written; None without a readable file."""
    try:
        document = json.loads(zlib.decompress(path.read_bytes()))
    except (OSError, ValueError, zlib.error):
        return None
    frames = {
        int(can_id): _apart(bytes.fromhex(lengths), bytes.fromhex(data))
        for can_id, (lengths, data) in document["frames"].items()
    }
    return Told(frames, document["received"])


def _by_id(packed: bytearray) -> dict[int, tuple[bytearray, bytearray]]:
    """Lengths and joined data of packed telegrams, by CAN identifier."""
    # Who sends packed frames has loaded numpy.
    import numpy as np

    from railhil.bus.hub.columns import PACKED

    frames = np.frombuffer(packed, PACKED)
    frames = frames[frames["can_id"] <= SFF_MASK]
    frames = frames[np.argsort(frames["can_id"], kind="stable")]
    starts = np.flatnonzero(np.diff(frames["can_id"], prepend=-1))
    found: dict[int, tuple[bytearray, bytearray]] = {}
    for part in np.split(frames, starts[1:]):
        lengths, data = part["length"], part["data"]
        used = data[np.arange(data.shape[1]) < lengths[:, None]]
        found[int(part["can_id"][0])] = bytearray(lengths.tobytes()), bytearray(used.tobytes())
    return found


def _apart(lengths: bytes | bytearray, data: bytes | bytearray) -> list[bytes]:
    """Frames of these lengths, joined in ``data``."""
    return [bytes(data[end - length : end]) for length, end in zip(lengths, accumulate(lengths), strict=True)]
