"""Exit codes of every railhil command."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable

from railhil.bus.errors import BusLost, BusUnavailable, PeerSilent

PASS = 0
#: The run is good, the limits of the scenario are missed.
FAIL = 1
#: Usage or bad input.
USAGE = 2
#: The bench cannot be trusted (a node was lost, timing broken); says nothing about the controller.
INVALID = 3
#: A defect of the bench itself, or the record could not be written (disk full).
TOOL_ERROR = 4


def exit_code_of(error: BaseException) -> int:
    """Exit code of an exception; exceptions may carry their own as ``exit_code``."""
    # Here, because this module is what every command loads before it can end in good order.
    from railhil.dbc import ContractError

    if isinstance(error, (BusUnavailable, ContractError)):
        return USAGE
    if isinstance(error, (BusLost, PeerSilent)):
        return INVALID
    return int(getattr(error, "exit_code", TOOL_ERROR))


def hold_back_interrupts() -> None:
    """Ctrl-C waits: this process is about to become another program, which has to load before it can end in good order.

    That program calls :func:`guarded`, or :func:`hear_interrupts` itself.
    """
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])


def hear_interrupts() -> None:
    """The end of :func:`hold_back_interrupts`; what came meanwhile is a KeyboardInterrupt here."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])


def guarded(name: str, main: Callable[[], int]) -> int:
    """Run a command; an exception becomes one line on stderr and its exit code.

    ``RAILHIL_TRACEBACK=1`` lets the exception through, for the one who mends it. SIGTERM ends the process like
    Ctrl-C, so that sockets and files are closed.
    """
    try:
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
        hear_interrupts()
        return main()
    except KeyboardInterrupt as stop:
        # A second Ctrl-C must not find this line half written.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        print(f"{name}: {str(stop) or 'stopped by Ctrl-C'}", file=sys.stderr)
        return 128 + signal.SIGINT
    except BrokenPipeError:
        # The reader of our output is gone (`railhil ports | head`): nothing more to say.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return PASS
    except Exception as error:
        if os.environ.get("RAILHIL_TRACEBACK"):
            raise
        text = " ".join(str(error).split()) or type(error).__name__
        code = exit_code_of(error)
        kind = f"{type(error).__name__}: " if code == TOOL_ERROR else ""
        print(f"{name}: {kind}{text}", file=sys.stderr)
        return code
