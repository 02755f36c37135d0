"""Run a command with ``vcan0`` and ``vcan1`` up: ``railhil vcan -- COMMAND ...``

The first of these ways that the host supports is used; a line on standard error names it and the reason:

``namespace``
    a fresh network namespace of the host's kernel: full speed, the host's own interfaces are not touched;
``user-mode``, ``machine``
    a throw-away virtual machine with a kernel of Debian's (:mod:`railhil.machines.vcan_vm`): a user-mode kernel, or an
    emulated machine, which is slower.

Exit code: the command's own, 128 + number if a signal ended it; 77 when this host can have neither (one line gives the
reason); 124 after ``--timeout``; 125 when the machine itself failed; 2 for a wrong command line.
"""

from __future__ import annotations

import argparse
import os
import re
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from railhil.common.command_line import OneLineParser, accept_former_name, number, whole_number
from railhil.common.exit_codes import hear_interrupts
from railhil.machines import debian, namespace, vcan_vm
from railhil.machines.vm_image import KINDS, Kind

_WAYS = ("namespace", *KINDS)
#: Interface names accepted by the kernel, except those that a shell or ``ip`` could misinterpret.
_INTERFACE = re.compile(r"[A-Za-z][A-Za-z0-9_.]{0,14}")
_TIMEOUT_MAX_S = 86_400
_SECONDS = number(lambda value: 1 <= value <= _TIMEOUT_MAX_S, f"1 to {_TIMEOUT_MAX_S} s")
#: Folder in which ``railhil run`` leaves its results.
_RESULTS = "runs"


def arguments() -> argparse.ArgumentParser:
    """Command line."""
    parser = OneLineParser(
        prog="railhil vcan",
        examples=["railhil vcan -- railhil run -i socketcan -c vcan0"],
        description="Run a command where vcan0 and vcan1 are up: in a network namespace of this kernel, else in a "
        "virtual machine.",
        epilog="exit codes: the command's own, 128 + number of a signal; 77 when this host can have neither;\n"
        "124 after --timeout; 125 when the machine failed; 2 for a wrong command line",
    )
    parser.add_argument("--share", type=Path, action="append", metavar="DIR",
                        help="virtual machine: folder whose changes are kept, may be given again (default: ./runs); "
                        "what is written elsewhere is gone afterwards")  # fmt: skip
    parser.add_argument(
        "--timeout", type=_SECONDS, default=3600.0, metavar="S", help="for all of it (default: %(default)g s)"
    )
    parser.add_argument("--ram", type=whole_number(256, 1 << 20), default=2048, metavar="MB",
                        help="of the virtual machine (default: 2048)")  # fmt: skip
    accept_former_name(parser, "--memory", "--ram")
    parser.add_argument("--processors", type=whole_number(1, 16), default=2, metavar="N",
                        help="of an emulated machine; 1 on a busy host (default: %(default)s)")  # fmt: skip
    parser.add_argument("--interfaces", type=_interfaces, default=("vcan0", "vcan1"), metavar="NAMES",
                        help="CAN interfaces of the kernel (default: vcan0,vcan1)")  # fmt: skip
    parser.add_argument("--via", choices=_WAYS, help="this way or none")
    parser.add_argument("command", nargs="+", help="command and its arguments, after --")
    return parser


def _interfaces(text: str) -> tuple[str, ...]:
    names = tuple(text.split(","))
    if not all(map(_INTERFACE.fullmatch, names)) or len(set(names)) != len(names):
        raise argparse.ArgumentTypeError(f"found {text!r}, allowed: different interface names, separated by commas")
    return names


@contextmanager
def _kept_folders(given: Sequence[Path] | None) -> Iterator[list[Path]]:
    """Folders that the machine may write to: those given, else ``./runs``, which is removed if it stays empty."""
    if given is not None:
        yield list(given)
        return
    results = Path.cwd() / _RESULTS
    made = not results.exists() and os.access(Path.cwd(), os.W_OK)
    if made:
        results.mkdir()
    try:
        yield [results] if results.is_dir() else []
    finally:
        if made:
            # Not empty: it contains results.
            with suppress(OSError):
                results.rmdir()


def _environment() -> dict[str, str]:
    """The caller's environment, with the commands of this installation at the end of the search path."""
    commands = Path(sys.executable).parent
    return {**os.environ, "PATH": f"{os.environ.get('PATH', '/usr/bin:/bin')}:{commands}"}


def _in_namespace(options: argparse.Namespace) -> int:
    how = namespace.require_namespace(options.interfaces)
    debian.say(f"vcan: {', '.join(options.interfaces)} in a network namespace of its own ({how})")
    return namespace.run(options.command, options.interfaces, environment=_environment(), timeout_s=options.timeout)


def _in_machine(kind: Kind, options: argparse.Namespace, reason: str) -> int:
    vcan_vm.ensure_machine(kind)
    with _kept_folders(options.share) as folders:
        kept = ", ".join(map(str, folders)) or "no folder"
        debian.say(
            f"vcan: {', '.join(options.interfaces)} in {kind.said} ({reason}); "
            f"kept afterwards: {kept}, what is written elsewhere is gone"
        )
        return vcan_vm.run(
            kind,
            options.command,
            interfaces=options.interfaces,
            environment=_environment(),
            shares=folders,
            timeout_s=options.timeout,
            memory_mb=options.ram,
            processors=options.processors,
        )


def _run(options: argparse.Namespace) -> int:
    """Run the command in the first way that this host supports.

    Raises:
        CapabilityError: the host supports none; the text names the ways that were tried.
    """
    reason = "asked for"
    if options.via in (None, "namespace"):
        try:
            return _in_namespace(options)
        except debian.CapabilityError as error:
            if options.via is not None:
                raise
            reason = str(error)
    kinds = list(KINDS.values()) if options.via is None else [KINDS[options.via]]
    try:
        return vcan_vm.first_that_boots(lambda kind: _in_machine(kind, options, reason), kinds)
    except debian.CapabilityError as error:
        if options.via is not None:
            raise
        raise debian.CapabilityError(f"neither a namespace: {reason}; nor a virtual machine: {error}") from error


def main(words: Sequence[str] | None = None) -> int:
    """Command line; see the module's docstring for the exit codes."""
    try:
        hear_interrupts()
        parser = arguments()
        options = parser.parse_args(words)
        for folder in options.share or ():
            if not folder.is_dir():
                parser.error(f"--share: found {folder}, allowed: a folder that is there")
        for number in (signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda caught, _: sys.exit(128 + caught))
        return debian.guarded("vcan", lambda: _run(options))
    except KeyboardInterrupt:
        print("railhil vcan: stopped by Ctrl-C", file=sys.stderr)
        return 128 + signal.SIGINT


if __name__ == "__main__":
    sys.exit(main())
