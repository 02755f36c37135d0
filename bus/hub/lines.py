"""A client's two redundant lines, A and B, as the MVB has them.

Every frame is sent on both lines at once. A receiver takes it from its trusted line and watches the other one. A frame
that comes on the other line alone makes the receiver switch over and is taken from there, unless the last switch-over
was less than :data:`GUARD_FRAMES` frames ago: then it is lost. A client whose lines are both dead is cut off.

What fails is a client's own connection to a line: it then neither sends nor hears there. Not modelled: a break in the
middle of a line, the frame that a real receiver may lose at the switch-over itself, lines that disturb each other, and
the master's order to switch over. The length of the guard is ours.
"""

from __future__ import annotations

NAMES = ("A", "B")
#: Frames for which a receiver stays on the line to which it has switched.
GUARD_FRAMES = 16


class Lines:
    """The lines of one client.

    :ivar dead: names of its dead lines.
    :ivar trusted: the line from which it takes frames.
    :ivar switch_overs: how often it has changed that line.
    :ivar guard_frames: frames until it may do so again.
    """

    def __init__(self) -> None:
        self.dead: set[str] = set()
        self.trusted = NAMES[0]
        self.switch_overs = 0
        self.guard_frames = 0

    def shared(self, other: Lines) -> list[str]:
        """Names of the lines that are alive at both clients."""
        return [name for name in NAMES if name not in self.dead and name not in other.dead]

    def hears(self, sender: Lines, frames: int) -> bool:
        """Whether frames of ``sender`` arrive here; may switch over."""
        alive = self.shared(sender)
        if not alive:
            return False
        guarded = self.guard_frames > 0
        self.guard_frames = max(self.guard_frames - frames, 0)
        if self.trusted in alive:
            return True
        if guarded:
            return False
        self.trusted = alive[0]
        self.switch_overs += 1
        self.guard_frames = GUARD_FRAMES
        return True
