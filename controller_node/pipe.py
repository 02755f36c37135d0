"""Frames to and from a controller that is another program or an emulated board, over two streams of octets.

The records of the streams are described in ``controller_node/export/c/railhil_pipe.h``, the other end in C.
"""

from __future__ import annotations

import os
import select
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from railhil.bus.frame import Frame
from railhil.common.errors import InputError, Words

FRAME, END, TEXT, FAILURE = 1, 2, 3, 4
#: Octets of the content of an END of the controller: two numbers of 32 bits.
_END_OCTETS: Final = 8
_FRAME_OCTETS_MAX: Final = 8
_CAN_ID_MAX: Final = 0x7FF
#: Most frames of one answer; a telegram has five, an answer is one telegram for each poll.
_FRAMES_MAX: Final = 256
#: Most lines of the console that are kept, the last ones.
LINES_MAX: Final = 1000
_READ_OCTETS: Final = 4096


class ControllerFailed(InputError):
    """The controller at the other end has ended, does not answer, answers what no controller sends, or has said itself
    that it cannot go on."""

    #: The frames that it sent before.
    frames: Sequence[Frame] = ()
    #: Whether its streams have ended.
    has_ended = False


@dataclass(frozen=True, slots=True)
class Answer:
    """What the controller sent in one exchange.

    :param ticks: of its counter of time, of the control period that it computed; 0: it computed none.
    :param free_stack: octets of its stack that it has never used so far; 0: unknown.
    """

    frames: list[Frame]
    ticks: int
    free_stack: int


def encode(frames: Sequence[Frame]) -> bytes:
    """The stream of one exchange, with its end. Frames that are no classic data frames with a standard identifier are
    left out: no mailbox takes them."""
    records = [
        bytes((FRAME, frame.can_id >> 8, frame.can_id & 0xFF, len(frame.data))) + frame.data
        for frame in frames
        if not frame.flags
    ]
    return b"".join([*records, bytes((END,))])


class Decoder:
    """The records of a stream that arrives in pieces of any length."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, octets: bytes) -> Iterator[tuple[int, Frame | bytes]]:
        """The records that are complete: tag, and a frame or the content.

        :raises ValueError: octets that no record has; the message is one line.
        """
        stream = self._rest + octets
        at = 0
        try:
            while at < len(stream):
                tag, head = stream[at], at + 1
                if tag == FRAME:
                    head += 3
                    if len(stream) < head:
                        return
                    can_id, length = stream[at + 1] << 8 | stream[at + 2], stream[at + 3]
                    if can_id > _CAN_ID_MAX or length > _FRAME_OCTETS_MAX:
                        raise ValueError(f"a frame with identifier {can_id:#x} and {length} octets")
                elif tag in (TEXT, FAILURE):
                    head += 1
                    if len(stream) < head:
                        return
                    length = stream[at + 1]
                elif tag == END:
                    length = _END_OCTETS
                else:
                    raise ValueError(f"a record with tag {tag:#04x}")
                if len(stream) < head + length:
                    return
                content = stream[head : head + length]
                at = head + length
                yield tag, Frame(can_id, content) if tag == FRAME else content
        finally:
            self._rest = stream[at:]


class Pipe:
    """Both streams of one controller.

    :param name: of the controller, for errors.
    :param from_controller, to_controller: descriptors; the latter becomes non-blocking. The caller closes them.
    :param patience_s: wall time for one answer.
    """

    def __init__(self, name: str, from_controller: int, to_controller: int, patience_s: float) -> None:
        os.set_blocking(to_controller, False)
        self._name = name
        self._input, self._output = from_controller, to_controller
        self._patience_s = patience_s
        self._decoder = Decoder()
        self._arrives, self._leaves = select.poll(), select.poll()
        self._arrives.register(from_controller, select.POLLIN)
        self._leaves.register(to_controller, select.POLLOUT)
        #: Lines of the controller's console.
        self.console: list[str] = []

    def exchange(self, frames: Sequence[Frame]) -> Answer:
        """Send frames, and wait for the answer to them.

        :raises ControllerFailed: see there.
        """
        answers: list[Frame] = []
        try:
            return self._exchange(frames, answers)
        except ControllerFailed as error:
            error.frames = answers
            raise

    def _exchange(self, frames: Sequence[Frame], answers: list[Frame]) -> Answer:
        until_s = time.monotonic() + self._patience_s
        self._send(encode(frames), until_s)
        while True:
            self._wait(self._arrives, until_s)
            octets = os.read(self._input, _READ_OCTETS)
            if not octets:
                error = self._failed("has ended", "an answer")
                error.has_ended = True
                raise error
            try:
                for tag, content in self._decoder.feed(octets):
                    if isinstance(content, Frame):
                        answers.append(content)
                        if len(answers) > _FRAMES_MAX:
                            raise ValueError(f"more than {_FRAMES_MAX} frames")
                    elif tag == END:
                        return Answer(answers, *(int.from_bytes(content[i : i + 4], "little") for i in (0, 4)))
                    else:
                        line = content.decode("utf-8", "replace")
                        self.console = [*self.console, line][-LINES_MAX:]
                        if tag == FAILURE:
                            raise self._failed(f"has failed: {line}", "an answer")
            except ValueError as error:
                raise self._failed(f"sends {error}", "records of railhil_pipe.h") from None

    def _send(self, octets: bytes, until_s: float) -> None:
        while octets:
            self._wait(self._leaves, until_s)
            try:
                octets = octets[os.write(self._output, octets) :]
            except BrokenPipeError:
                # What it has said before its end is read; then comes the end of the stream.
                return

    def _wait(self, poll: select.poll, until_s: float) -> None:
        if not poll.poll(max(0.0, until_s - time.monotonic()) * 1e3):
            raise self._failed(f"has not answered for {self._patience_s:g} s", "an answer")

    def _failed(self, words: str, allowed: str) -> ControllerFailed:
        return ControllerFailed(self._name, "", Words(words), allowed)
