"""Code of the user in a process of its own, which is asked once in a control period.

A crash, an endless loop or an exception of the code is then one line of the node, and the process ends with the node.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import select
import signal
import socket
import struct
import subprocess
import sys
import time
import weakref
from abc import abstractmethod
from collections.abc import Sequence
from importlib import import_module

from railhil.common.errors import InputError, Sentence, Words
from railhil.common.patience import APPEAR_S
from railhil.common.python_process import end_group, end_with_parent
from railhil.controller_node.given.computing import Computer, ComputingController, Terms
from railhil.scenarios.given import refuse_changed

#: First octet of an answer: values follow, or the line of an error.
_VALUES, _ERROR = b"v", b"e"
_LENGTH = struct.Struct("<cI")
#: Longest answer.
_LENGTH_MAX = 1_000_000
_END_S = 1.0
_STANDARD_ERROR = 2


class WorkerController(ComputingController):
    """A controller whose code runs in a process of its own."""

    #: For :meth:`load`.
    arguments: list[str]

    @staticmethod
    @abstractmethod
    def load(arguments: Sequence[str], terms: Terms) -> Computer:
        """The code, in its process.

        :raises InputError: as :meth:`start`.
        """

    def start(self, terms: Terms, patience_s: float) -> Computer:
        return Worker(self, terms, patience_s)


class Worker:
    """See :class:`~railhil.controller_node.given.computing.Computer`.

    :param patience_s: wall time for each answer; the start has at least half of :data:`APPEAR_S`.
    :raises InputError: the code cannot be loaded, or does not take the readings.
    """

    def __init__(self, given: WorkerController, terms: Terms, patience_s: float) -> None:
        # Loading libraries may take longer than an answer.
        self._text, self._patience_s = given.text, max(patience_s, APPEAR_S / 2)
        self._pack = struct.Struct(f"<{len(terms.readings)}d").pack
        self._values = struct.Struct(f"<{len(terms.commands)}d")
        kind = type(given)
        words = [f"{kind.__module__}:{kind.__qualname__}", *given.arguments]
        words += [json.dumps(given.hashes()), json.dumps(terms.as_json())]
        ours, theirs = socket.socketpair()
        with theirs:
            command = [sys.executable, "-P", "-m", __name__, str(theirs.fileno()), *words]
            # What the code prints must not stand among the results of a command.
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=_STANDARD_ERROR,
                pass_fds=[theirs.fileno()],
                start_new_session=True,
            )
        self._socket = ours
        self._ends = weakref.finalize(self, _end, self._process, ours)
        self._key = "start"
        self._ask(b"")
        self._patience_s = patience_s
        self._periods = 0

    def compute(self, readings: Sequence[float]) -> Sequence[float]:
        self._periods += 1
        self._key = f"control period {self._periods}"
        content = self._ask(self._pack(*readings))
        if len(content) != self._values.size or not all(map(math.isfinite, found := self._values.unpack(content))):
            raise self._garbled()
        return found

    def close(self) -> None:
        """End the process."""
        self._ends()

    def _ask(self, question: bytes) -> bytes:
        deadline_s = time.monotonic() + self._patience_s
        try:
            if question:
                self._socket.sendall(question)
            kind, length = _LENGTH.unpack(self._read(_LENGTH.size, deadline_s))
            if kind not in (_VALUES, _ERROR) or length > _LENGTH_MAX:
                raise self._garbled()
            content = self._read(length, deadline_s)
        except (EOFError, OSError):
            raise self._ended() from None
        if kind == _ERROR:
            self.close()
            try:
                file, key, line = map(str, json.loads(content))
            except (TypeError, ValueError):
                raise self._garbled() from None
            raise InputError(file, key or self._key, Words(), Sentence(line))
        return content

    def _garbled(self) -> InputError:
        """The error for octets that railhil's part of the process does not write: the code used its socket."""
        self.close()
        return InputError(self._text, self._key, Words(), Sentence("its process sends octets that are no answer"))

    def _read(self, length: int, deadline_s: float) -> bytes:
        content = b""
        while len(content) < length:
            left_s = deadline_s - time.monotonic()
            if left_s <= 0 or not select.select((self._socket,), (), (), left_s)[0]:
                self.close()
                said = Sentence(f"no answer within {self._patience_s:g} s")
                raise InputError(self._text, self._key, Words(), said)
            part = self._socket.recv(length - len(content))
            if not part:
                raise EOFError
            content += part
        return content

    def _ended(self) -> InputError:
        """The error for a process that ended by itself."""
        try:
            code = self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            code = 0
        self.close()
        how = f"killed by {signal.Signals(-code).name}" if code < 0 else f"ended with exit code {code}"
        return InputError(
            self._text, self._key, Words(), Sentence(f"its process was {how}" if code < 0 else f"its process {how}")
        )


def _end(process: subprocess.Popen[bytes], ours: socket.socket) -> None:
    ours.close()
    # With the processes that the code has started.
    end_group(process)


def _tell(theirs: socket.socket, kind: bytes, content: bytes) -> None:
    theirs.sendall(_LENGTH.pack(kind, len(content)) + content)


def _serve(theirs: socket.socket, computer: Computer, terms: Terms) -> None:
    question, answer = (struct.Struct(f"<{len(side)}d") for side in (terms.readings, terms.commands))
    while True:
        content = b""
        while len(content) < question.size:
            part = theirs.recv(question.size - len(content))
            if not part:
                return
            content += part
        _tell(theirs, _VALUES, answer.pack(*computer.compute(question.unpack(content))))


def main() -> int:
    """Serve the node at the other end of a socket, until it closes it."""
    end_with_parent()
    number, reference, *arguments, hashes_json, terms_json = sys.argv[1:]
    module, _, name = reference.partition(":")
    with socket.socket(fileno=int(number)) as theirs, contextlib.suppress(BrokenPipeError, ConnectionResetError):
        os.set_inheritable(theirs.fileno(), False)
        try:
            terms = Terms.from_json(json.loads(terms_json))
            kind: type[WorkerController] = getattr(import_module(module), name)
            hashes: dict[str, str] = json.loads(hashes_json)
            refuse_changed(hashes)
            computer = kind.load(arguments, terms)
            # It may have been saved while it was read.
            refuse_changed(hashes)
            try:
                _tell(theirs, _VALUES, b"")
                _serve(theirs, computer, terms)
            finally:
                computer.close()
        except InputError as error:
            _tell(theirs, _ERROR, json.dumps([error.file, error.key, _said(error)]).encode())
    return 0


def _said(error: InputError) -> str:
    hint = f" ({' '.join(error.hint.split())})" if error.hint else ""
    return f"{error.difference}{hint}"


if __name__ == "__main__":
    sys.exit(main())
