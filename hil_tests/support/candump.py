"""The lines that ``candump`` shows on a terminal."""

from __future__ import annotations

from railhil.bus.frame import Frame


def candump_line(frame: Frame, channel: str) -> str:
    """A classic data frame as ``candump CHANNEL`` prints it, without end of line."""
    return f"  {channel}  {frame.can_id:03X}   [{len(frame.data)}]  {frame.data.hex(' ').upper()}"
