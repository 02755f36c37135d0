"""The frames that a node has sent, kept by the node itself: the record is compared with them after the run.

A recorder on a shared bus cannot tell the sender of a frame. The nodes can: a frame that none of them has sent is
foreign.
"""

from __future__ import annotations

import json
import sys
from array import array
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from railhil.bus.frame import Frame
from railhil.bus.packing import CLASSIC_SIZE
from railhil.common.errors import describe_os_error
from railhil.common.exit_codes import ignore_ending_signals
from railhil.common.user_files import whole_file

#: Frames that are kept as they are before their data are put together: a node sends about 500 per simulated second.
_BATCH: Final = 4096


class SentFrames:
    """Every frame that a node has sent, in order.

    The reader sorts the file (:mod:`railhil.record.senders`), since all processes wait for the end of a node. It has a
    line of JSON with the numbers of frames and the telegrams received, then the packed frames
    (:mod:`railhil.bus.packing`), then of the other frames the identifiers (32 bits each, in the byte order of this
    machine), lengths of the data, flags (8 bits each), and the data. A node notes all its frames in one of the two
    ways.

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
        #: Telegrams that the node has received (:mod:`railhil.bus.reception`); None: it does not count them.
        self.received: dict[str, Any] | None = None

    def note(self, frames: Sequence[Frame]) -> None:
        """Take frames that are being sent."""
        self._waiting += frames
        if len(self._waiting) > _BATCH:
            self._put_together()

    def note_packed(self, packet: bytes) -> None:
        """:meth:`note` for packed classic frames."""
        self._packed += packet

    def _put_together(self) -> None:
        """No loop over the frames here: a node does this in the middle of its run."""
        if not self._waiting:
            return
        ids, data, flags = zip(*self._waiting, strict=True)
        self._ids.extend(ids)
        self._data += b"".join(data)
        self._lengths += bytes(map(len, data))
        self._flags += bytes(flags)
        self._waiting = []

    def write(self) -> None:
        """Write the file whole or not at all, undisturbed by signals; if it cannot be written, one line on stderr says
        so."""
        ignore_ending_signals()
        self._put_together()
        packed = len(self._packed) // CLASSIC_SIZE
        head = {"packed": packed, "frames": len(self._ids), "received": self.received}
        try:
            with whole_file(self._path) as draft, draft.open("wb") as file:
                file.write(json.dumps(head).encode() + b"\n")
                for column in (self._packed, self._ids, self._lengths, self._flags, self._data):
                    file.write(column)
        except OSError as error:
            print(f"{self._node}: list of sent frames is lost: {describe_os_error(error)}", file=sys.stderr)
