"""``candump`` beside a run, and lines of logs as frames."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path
from types import TracebackType

from hil_tests.support.cli import wait_for
from hil_tests.transport.vcan.bench import socketcan
from railhil.bus.frame import Frame
from railhil.bus.link import Link, open_link
from railhil.record.framelog import read_log

#: Frames of ours around a dump; no port, and lower in priority than any.
_FIRST, _LAST = Frame(0x7FE, b"first"), Frame(0x7FF, b"last")
_PATIENCE_S = 60.0


class Dump:
    """``candump -L`` on an interface, from its first frame to its last: a context manager.

    The socket of candump is given a buffer that no run here fills.
    """

    def __init__(self, file: Path, channel: str = "vcan0") -> None:
        self._file = file
        self._channel = channel

    def __enter__(self) -> Dump:
        with self._file.open("wb") as output:
            self._process = subprocess.Popen(
                ["candump", "-L", "-r", "16777216", self._channel], stdin=subprocess.DEVNULL, stdout=output
            )
        self._link: Link = open_link(socketcan(self._channel))
        # It hears nothing before it has bound its socket.
        wait_for(lambda: self._said(_FIRST), _PATIENCE_S)
        return self

    def _said(self, marker: Frame) -> bool:
        if marker == _FIRST:
            self._link.send([marker])
            time.sleep(0.1)
        return f"#{marker.data.hex().upper()}" in self._file.read_text()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        try:
            if kind is None:
                self._link.send([_LAST])
                wait_for(lambda: self._said(_LAST), _PATIENCE_S)
        finally:
            self._link.close()
            self._process.terminate()
            self._process.wait()

    def frames(self) -> list[Frame]:
        """What it has heard, without the frames around it."""
        return [frame for frame in frames_of(self._file) if frame not in (_FIRST, _LAST)]


def frames_of(log: Path) -> list[Frame]:
    """Frames of a candump log."""
    return [frame for _, frame in read_log(log)]
