"""Independent pieces of work, done by this process and by one that is forked for them, on the other processor.

What the forked process has not brought to an end is done here: whatever ends it (an error, the kernel), the result is
that of this process alone, and errors are raised here as if there were no other.
"""

from __future__ import annotations

import gc
import os
import pickle
import signal
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import Any, NoReturn

from railhil.common.exit_codes import finish_undisturbed
from railhil.common.orphans import end_with_parent
from railhil.common.python_process import can_fork

#: Pieces are numbered by a byte.
_PIECES_MAX = 256


def shared_out(pieces: Sequence[Callable[[], Any]], meanwhile: Callable[[], object] | None = None) -> list[Any]:
    """Do pieces of work whose order does not matter; returns their results in the given order.

    Whoever is free takes the next one. A piece may be done twice, so what it writes it must write from the beginning;
    its result is pickled.

    :param meanwhile: done in this process, whatever others do: before its first piece.
    :raises Exception: that of a piece.
    """
    helper = _helper(pieces) if _is_worth_it(len(pieces) + (meanwhile is not None)) else None
    if helper is None:
        if meanwhile is not None:
            meanwhile()
        return [piece() for piece in pieces]
    with helper:
        if meanwhile is not None:
            meanwhile()
        results = _taken(pieces, helper.queue) | helper.results()
    return [results[number] if number in results else piece() for number, piece in enumerate(pieces)]


def _is_worth_it(count: int) -> bool:
    return 2 <= count <= _PIECES_MAX and can_fork() and len(os.sched_getaffinity(0)) > 1


def _helper(pieces: Sequence[Callable[[], Any]]) -> _Helper | None:
    """A process that takes pieces; None: there are no resources for it."""
    try:
        return _Helper(pieces)
    except OSError:
        return None


class _Helper:
    """The forked process; a context manager that leaves nothing of it behind.

    :raises OSError: there cannot be one.
    """

    def __init__(self, pieces: Sequence[Callable[[], Any]]) -> None:
        with ExitStack() as made:
            #: Numbers of the pieces that nobody has taken.
            self.queue, filling = os.pipe()
            made.callback(os.close, self.queue)
            os.write(filling, bytes(range(len(pieces))))
            os.close(filling)
            self._answer = os.memfd_create("railhil-pieces")
            made.callback(os.close, self._answer)
            # In the new process this one's handlers would raise in this one's code, which would go on there.
            before = signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals())
            try:
                self._pid = os.fork()
                if not self._pid:
                    _help(pieces, self.queue, self._answer)
            finally:
                signal.pthread_sigmask(signal.SIG_SETMASK, before)
            self._made = made.pop_all()

    def results(self) -> dict[int, Any]:
        """Wait for the end: results of the pieces that it has taken, by number; none if one of them has failed."""
        pid, self._pid = self._pid, 0
        _, status = os.waitpid(pid, 0)
        document = b"" if status else os.pread(self._answer, os.fstat(self._answer).st_size, 0)
        return dict(pickle.loads(document)) if document else {}

    def __enter__(self) -> _Helper:
        return self

    def __exit__(self, *_: object) -> None:
        with self._made:
            if self._pid:
                os.kill(self._pid, signal.SIGKILL)
                os.waitpid(self._pid, 0)


def _taken(pieces: Sequence[Callable[[], Any]], queue: int) -> dict[int, Any]:
    """Results of the pieces that this process takes, by number."""
    results = {}
    while number := os.read(queue, 1):
        results[number[0]] = pieces[number[0]]()
    return results


def _help(pieces: Sequence[Callable[[], Any]], queue: int, answer: int) -> NoReturn:
    """In the new process; it says nothing, and never goes back into the code of the other."""
    code = 1
    try:
        gc.disable()
        end_with_parent()
        finish_undisturbed()
        signal.pthread_sigmask(signal.SIG_SETMASK, ())
        document = pickle.dumps(_taken(pieces, queue))
        with open(answer, "wb", closefd=False) as stream:
            stream.write(document)
        code = 0
    finally:
        os._exit(code)
