"""A bus inside one process: the bus administrator's endpoint, with responders called in turn.

The same telegrams in the same order, without sockets: for tests, in-process loops and comparing log hashes between
transports.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from railhil.bus.frame import Frame
from railhil.common.mypyc import mypyc_attr


@mypyc_attr(allow_interpreted_subclasses=True)
class AnsweredAtOnce:
    """Part of an :class:`railhil.bus.link.Endpoint` of the administrator: every answer is there as soon as a frame is
    sent, or never comes."""

    def __init__(self) -> None:
        self._inbox: list[Frame] = []
        self.lossless = True
        #: Nothing can fail here.
        self.is_down = False
        #: A test may put two controllers on this bus.
        self.is_private = False

    def receive(self, timeout_s: float | None) -> list[Frame]:
        """Answers since the last call; nothing can arrive later, so the time-out is not waited for."""
        del timeout_s
        frames, self._inbox = self._inbox, []
        return frames

    def has_ended(self, node: str) -> bool:
        """Always True: a node that has not answered at once never will."""
        del node
        return True

    def is_cut_off(self, node: str) -> bool:
        """Always False: here no fault separates two nodes."""
        del node
        return False

    def close(self) -> None:
        """Nothing to close."""


@mypyc_attr(allow_interpreted_subclasses=True)
class LocalBus(AnsweredAtOnce):
    """The bus administrator's endpoint beside other nodes.

    :param nodes: for each other node, the function that handles a frame and returns its answers.
    """

    def __init__(self, nodes: Sequence[Callable[[Frame], list[Frame]]]) -> None:
        super().__init__()
        self._nodes = list(nodes)

    def send(self, frames: Sequence[Frame]) -> None:
        """Deliver frames to every node; answers reach the administrator and the other nodes in bus order."""
        self._deliver(frames, None)

    def _deliver(self, frames: Sequence[Frame], sender: Callable[[Frame], list[Frame]] | None) -> None:
        nodes = [node for node in self._nodes if node is not sender]
        for frame in frames:
            if sender is not None:
                self._inbox.append(frame)
            answered = []
            for node in nodes:
                if answers := node(frame):
                    answered.append((answers, node))
            # As on a bus, a frame reaches every node before any answer to it does.
            for answers, node in answered:
                self._deliver(answers, node)
