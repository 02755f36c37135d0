"""Exit codes of every railhil command."""

from __future__ import annotations

import contextlib
import errno
import io
import os
import signal
import stat
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, NoReturn

from railhil.common.extras import without_asammdf
from railhil.common.streams import discard_output, escape_controls

if TYPE_CHECKING:
    from typing_extensions import Buffer

PASS = 0
#: The run is valid, limits of the scenario are missed.
FAIL = 1
#: Usage or bad input.
USAGE = 2
#: The run is not trustworthy (a node was lost, deadlines were missed); it says nothing about the controller.
INVALID = 3
#: A defect of the bench itself, or the record could not be written (disk full).
TOOL_ERROR = 4

#: Errors for a file without room: on the disk, for this user, or for its size.
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def provide_streams() -> None:
    """Replace a standard stream that the caller has closed (``>&-``) by the null device.

    Otherwise the next file opened, such as a log, would get its number, and every process started would write into it.
    Standard output cannot be written then: a command that prints a result fails, as on a full device.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            null = os.open(os.devnull, os.O_RDONLY if name == "stdout" else os.O_RDWR)
            # The lowest free number is this one, unless something was opened before.
            if null == number:
                os.set_inheritable(null, True)
            mode = "r" if name == "stdin" else "w"
            setattr(sys, name, os.fdopen(null, mode, encoding="utf-8", closefd=False))


def exit_code_of(error: BaseException) -> int:
    """Exit code of an exception: the ``exit_code`` of its class; an exception without one is a defect."""
    return int(getattr(error, "exit_code", TOOL_ERROR))


def ending_signals() -> tuple[signal.Signals, ...]:
    """Signals that end a command in an orderly way: Ctrl-C, SIGTERM, and SIGHUP unless nohup ignores it."""
    found = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    return found if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN else found[:2]


def leave_terminal() -> None:
    """After SIGHUP: discard further output to the closed terminal instead of failing with EIO."""
    for descriptor in (1, 2):
        try:
            mode = os.fstat(descriptor).st_mode
        except OSError:
            # Closed already.
            continue
        if stat.S_ISCHR(mode) and not os.isatty(descriptor):
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, descriptor)
            os.close(null)


class _Terminal(io.FileIO):
    """A terminal that may go away: later output is discarded."""

    def write(self, content: Buffer, /) -> int:
        try:
            return super().write(content)
        except OSError as error:
            if error.errno != errno.EIO:
                raise
            leave_terminal()
            return memoryview(content).nbytes


def outlive_terminal() -> None:
    """Used by a command that ignores SIGHUP: it continues when its terminal is gone, of which no signal informs it."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if isinstance(stream, io.TextIOWrapper) and stream.isatty():
            stream.flush()
            raw = io.BufferedWriter(_Terminal(stream.fileno(), "wb", closefd=False))
            setattr(sys, name, io.TextIOWrapper(raw, stream.encoding, stream.errors, line_buffering=True))


def ignore_ending_signals() -> None:
    """Ignore signals that would end this process from here on: it only writes its results and ends.

    When a node is lost the supervisor ends the others, and Ctrl-C at a terminal reaches all of them, perhaps twice.
    """
    for number in ending_signals():
        signal.signal(number, signal.SIG_IGN)


class Signalled(SystemExit):
    """A signal ends this process in an orderly way. Code that plugs in may raise a plain SystemExit."""


def _end(number: int, _: object) -> NoReturn:
    if number == signal.SIGHUP:
        leave_terminal()
    raise Signalled(128 + number)


def hold_back_interrupts() -> None:
    """Hold Ctrl-C back: this process is about to become another program, which can end in an orderly way only after it
    has loaded.

    That program calls :func:`run_guarded`, or :func:`hear_interrupts` itself.
    """
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])


def hear_interrupts() -> None:
    """End :func:`hold_back_interrupts`; a Ctrl-C that has come since raises KeyboardInterrupt here."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])


def _is_of_output(error: OSError) -> bool:
    """Whether this reason, which names no file, is a failure of standard output: the next line then fails as well.

    If standard output works, the line written for the check is the last one of a failed command.
    """
    if error.filename is not None or error.errno not in (*_FULL, errno.EBADF):
        return False
    try:
        print(flush=True)
    except OSError as again:
        return again.errno == error.errno
    return False


def _multiply_in_one_thread() -> None:
    """Numpy, if it is loaded from here on, multiplies matrices in one thread, in this process and in those it starts.

    All matrices here are small; threads for them would cost every process 40 ms at its start, and sums could depend on
    the number of processors. Settings of the user stay.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def run_guarded(name: str, main: Callable[[], int]) -> int:
    """Run a command; an exception becomes one line on stderr and its exit code.

    ``RAILHIL_TRACEBACK=1`` lets the exception through, for debugging. SIGTERM and SIGHUP end the process
    like Ctrl-C, so that sockets and files are closed.
    """
    try:
        provide_streams()
        for number in ending_signals()[1:]:
            signal.signal(number, _end)
        if signal.SIGHUP not in ending_signals():
            outlive_terminal()
        hear_interrupts()
        _multiply_in_one_thread()
        with without_asammdf():
            return main()
    except KeyboardInterrupt as stop:
        # A second Ctrl-C must not interrupt this line.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        print(f"{name}: {str(stop) or 'stopped by Ctrl-C'}", file=sys.stderr)
        return 128 + signal.SIGINT
    except BrokenPipeError:
        # The reader of our output is gone (`railhil ports | head`): write nothing more.
        discard_output()
        return PASS
    except Exception as error:
        # Report an unexpected exception: one line and an exit code, no traceback.
        if os.environ.get("RAILHIL_TRACEBACK"):
            raise
        if isinstance(error, PermissionError) and error.filename is not None:
            # An error about a path that the user names, or about the user's home, is no defect of the bench.
            path = os.fsdecode(error.filename) if not isinstance(error.filename, int) else str(error.filename)
            from railhil.common.errors import InputError, Words

            error = InputError(path, "", Words("permission denied"), "a path that this user may use")
        text = " ".join(str(error).split()) or type(error).__name__
        code = exit_code_of(error)
        expected = code != TOOL_ERROR or hasattr(error, "exit_code")
        kind = "" if expected else f"{type(error).__name__}: "
        if isinstance(error, OSError) and _is_of_output(error):
            kind, text = "standard output: ", "closed" if error.errno == errno.EBADF else str(error.strerror).lower()
            # The end of the interpreter flushes it again.
            discard_output()
        # An import error of the command itself names the missing library.
        is_named = f"{getattr(error, 'file', '')} ".startswith(f"{name} ")
        line = text if is_named else f"{name}: {kind}{text}"
        # If standard error is full or closed, the exit code still tells.
        with contextlib.suppress(OSError):
            print(escape_controls(line), file=sys.stderr, flush=True)
        return code
