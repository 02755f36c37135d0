"""The adapter's serial port: a pseudo-terminal under a persistent name, which can be unplugged and plugged in again."""

from __future__ import annotations

import os
import termios
import tty
from pathlib import Path

_CHUNK_BYTES = 4096
#: Bits of a serial byte on the line: start bit, 8 data bits, stop bit.
_BITS_PER_BYTE = 10
#: Bytes moved at a time on a line with a limited rate.
_PACED_BYTES = 16


class SerialLine:
    """Rate limit of one direction of a serial line.

    :param rate_baud: bit/s on the line; 0: no limit (USB without a serial chip in between).
    """

    def __init__(self, rate_baud: int) -> None:
        self._rate_baud = rate_baud
        self._free_ns = 0

    def room_bytes(self, now_ns: int) -> int:
        """Bytes that may be moved at monotonic time ``now_ns``."""
        if not self._rate_baud:
            return _CHUNK_BYTES
        return _PACED_BYTES if now_ns >= self._free_ns else 0

    def moved(self, count_bytes: int, now_ns: int) -> None:
        """Note that bytes were moved."""
        if self._rate_baud:
            self._free_ns = max(now_ns, self._free_ns) + count_bytes * _BITS_PER_BYTE * 1_000_000_000 // self._rate_baud

    def wait_s(self, now_ns: int) -> float:
        """Time until the line is free."""
        return max(0.0, (self._free_ns - now_ns) / 1e9)


class Terminal:
    """A pseudo-terminal behind a symbolic link.

    :param link: path where the host finds the port; replaced at each :meth:`plug_in`, removed by :meth:`pull_out`.
    """

    def __init__(self, link: Path) -> None:
        self.link = link
        self._adapter_end = -1
        self._host_end = -1

    @property
    def is_plugged_in(self) -> bool:
        """True while the port exists."""
        return self._adapter_end >= 0

    def plug_in(self) -> None:
        """Make a new port and point the link to it."""
        if self.is_plugged_in:
            return
        self._adapter_end, self._host_end = os.openpty()
        # Held open, so that the port outlives the processes that use it, and set to raw mode before the first of them
        # does.
        tty.setraw(self._host_end)
        os.set_blocking(self._adapter_end, False)
        new = self.link.with_name(f"{self.link.name}.new")
        new.unlink(missing_ok=True)
        new.symlink_to(os.ttyname(self._host_end))
        new.replace(self.link)

    def pull_out(self) -> None:
        """Close the port: processes that have it open read end of file and get EIO."""
        if self.is_plugged_in:
            self.link.unlink(missing_ok=True)
            os.close(self._host_end)
            os.close(self._adapter_end)
            self._adapter_end = self._host_end = -1

    def fileno(self) -> int:
        """Descriptor of the adapter's end."""
        return self._adapter_end

    def read(self, most_bytes: int) -> bytes:
        """Data written by the host; may be empty."""
        try:
            return os.read(self._adapter_end, most_bytes)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> int:
        """Send bytes to the host; returns how many were accepted."""
        try:
            return os.write(self._adapter_end, data)
        except BlockingIOError:
            return 0

    def forget_unread(self) -> None:
        """Discard data that the host has not read yet."""
        termios.tcflush(self._host_end, termios.TCIFLUSH)
