"""The record of a run that is being made, read as it grows: the bus of a panel where the run has none to join.

Nobody is written to and nobody waits: the run writes its log as ever, and a panel that is slow, stopped or gone leaves
no trace in it.
"""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path

from railhil.bus.errors import BusLost, BusUnavailable
from railhil.bus.frame import Frame
from railhil.record.framelog import LOG_NAME, frames_of

#: Read at one look: about 8000 classic frames.
LOOK_BYTES = 360_000
#: What may wait to be read, about 350 000 frames; of more the oldest lines are left out.
BACKLOG_BYTES = 16 << 20
_SKIP_BYTES = 1 << 20


class FollowedRun:
    """The frames of ``frames.log`` in a run folder, in the order of the bus.

    ``counters["rx_lost"]``: lines left out because there were too many.

    :raises BusUnavailable: the run has not begun, or its log cannot be read.
    """

    def __init__(self, folder: Path) -> None:
        self._path = path = folder / LOG_NAME
        try:
            self._stream = path.open("rb", buffering=0)
        except FileNotFoundError:
            raise BusUnavailable(f"run {folder} has not begun") from None
        except OSError as error:
            raise BusUnavailable(f"{path}: {(error.strerror or str(error)).lower()}") from None
        self.counters: Counter[str] = Counter()
        #: Beginning of a line whose end is not written yet.
        self._begun = b""

    def receive(self, timeout_s: float | None = 0.0) -> list[Frame]:
        """The next frames, oldest first, at most :data:`LOOK_BYTES` of lines; never waits.

        :raises BusLost: it is no log of a run.
        """
        self._skip()
        text = self._begun + self._stream.read(LOOK_BYTES)
        whole = text.rfind(b"\n") + 1
        self._begun = text[whole:]
        try:
            return frames_of(text[:whole])
        except (ValueError, IndexError):
            raise BusLost(f"{self._path}: found lines that are no frames, allowed: the log of a run") from None

    def _skip(self) -> None:
        """Count the lines that are too many, without reading what they say."""
        unread = os.fstat(self._stream.fileno()).st_size - self._stream.tell() - BACKLOG_BYTES
        if unread <= 0:
            return
        while unread > 0 and (part := self._stream.read(min(unread, _SKIP_BYTES))):
            unread -= len(part)
            self.counters["rx_lost"] += part.count(b"\n")
        # Where it stops is inside a line, as a rule.
        rest = self._stream.read(LOOK_BYTES)
        self.counters["rx_lost"] += 1
        self._begun = b""
        self._stream.seek(rest.find(b"\n") + 1 - len(rest), os.SEEK_CUR)

    def close(self) -> None:
        """Close the file."""
        self._stream.close()
