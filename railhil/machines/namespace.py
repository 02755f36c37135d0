"""A fresh network namespace of the host's own kernel, with private CAN interfaces.

The command runs at full speed, with the host's files and without any network except the CAN interfaces and its own
loopback. The interfaces disappear with the last process in the namespace; the host's own, including a ``vcan0``, are
neither visible nor touched.
"""

from __future__ import annotations

import ctypes
import os
import shlex
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from railhil.common.python_process import WITH_PARENT
from railhil.machines import debian

_PURPOSE = "a network namespace"
_PACKAGES = {"ip": "iproute2", "unshare": "util-linux", "setpriv": "util-linux"}
_PROBE_S = 20.0
#: Time after SIGTERM until the command is killed.
_GRACE_S = 5.0
_LOOK_S = 0.2
_PR_SET_CHILD_SUBREAPER = 36
#: ``si_code`` of a signal sent by the kernel, as for a Ctrl-C, which reaches the whole foreground group.
_SI_KERNEL = 0x80
_PASSED_ON = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
_WATCHED = {*_PASSED_ON, signal.SIGCHLD}


def require_namespace(interfaces: Sequence[str]) -> str:
    """Make sure that a namespace with these interfaces can be created; returns how, in a few words.

    Raises:
        CapabilityError: it cannot; the text names the missing part and the remedy.
    """
    _require_can()
    if os.geteuid() == 0 and not all(debian.find_command(command) for command in _PACKAGES):
        debian.require_debian_root(_PURPOSE)
        debian.install_commands(_PACKAGES, _PURPOSE)
    for command, package in _PACKAGES.items():
        if debian.find_command(command) is None:
            raise debian.CapabilityError(f"no command {command} (apt install {package})")
    if reason := _failure(_prepared(interfaces, ["true"])):
        if bare := _failure(["true"]):
            hint = "CAP_SYS_ADMIN is missing, as in a container that is not privileged"
            if os.geteuid() != 0:
                hint = "run as root, or sysctl kernel.unprivileged_userns_clone=1"
            raise debian.CapabilityError(f"no network namespace: {bare} ({hint})")
        hint = "modprobe vcan, or apt install linux-modules-extra-$(uname -r)"
        raise debian.CapabilityError(f"no vcan interface in a namespace: {reason} ({hint})")
    return "this kernel has vcan" + ("" if os.geteuid() == 0 else ", as root of a user namespace")


def _require_can() -> None:
    """Refuse unless the kernel has raw CAN sockets; the check loads the module if it exists."""
    if not hasattr(socket, "AF_CAN"):
        raise debian.CapabilityError("this is not Linux")
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except OSError as error:
        hint = "modprobe can_raw vcan, or apt install linux-modules-extra-$(uname -r)"
        raise debian.CapabilityError(f"this kernel has no CAN sockets: {error.strerror} ({hint})") from error


def _prepared(interfaces: Sequence[str], command: Sequence[str]) -> list[str]:
    """Command that brings up loopback and interfaces in their namespace and then executes ``command``."""
    steps = ["ip link set lo up"]
    for name in map(shlex.quote, interfaces):
        steps += [f"ip link add {name} type vcan", f"ip link set {name} up"]
    # setpriv comes after unshare: gaining rights in the namespace would clear it again.
    return [*WITH_PARENT, "sh", "-c", " && ".join([*steps, 'exec "$@"']), "sh", *command]


def _in_namespace(command: Sequence[str]) -> list[str]:
    found = debian.find_command("unshare")
    assert found is not None
    return [found, "-n", *(["-r"] if os.geteuid() != 0 else []), "--", *command]


def _failure(command: Sequence[str]) -> str:
    """Last line of output of a command that failed in its own namespace; empty if it succeeded."""
    done = subprocess.run(
        _in_namespace(command), stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
        env={**debian.environment(), "LC_ALL": "C"}, timeout=_PROBE_S, check=False,
    )  # fmt: skip
    if done.returncode == 0:
        return ""
    return (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1].rstrip(".")


def run(
    command: Sequence[str], interfaces: Sequence[str], *, environment: Mapping[str, str], timeout_s: float = 600.0
) -> int:
    """Run ``command`` in a fresh namespace in which ``interfaces`` are up; call :func:`require_namespace` first.

    Signals sent to this process are passed on. Processes that the command leaves running in the namespace are killed at
    its end, because they would keep the namespace alive. Other children of this process are not touched.

    Returns:
        The command's exit code, 128 + number for a signal; 124 after ``timeout_s``.

    Raises:
        MachineError: the command does not exist.
    """
    if debian.find_command(command[0]) is None and not Path(command[0]).exists():
        raise debian.MachineError(f"no command {command[0]}")
    with tempfile.NamedTemporaryFile(prefix="railhil-vcan-") as told, _orphans_come_here(), _signals_wait() as mask:
        says_which = ["sh", "-c", 'readlink /proc/self/ns/net >"$0" && exec "$@"', told.name]
        process = subprocess.Popen(
            _in_namespace([*says_which, *_prepared(interfaces, command)]),
            env={**environment, "PATH": _path(environment)}, preexec_fn=lambda: _give_back(mask),
        )  # fmt: skip
        try:
            return _until_ended(process, time.monotonic() + timeout_s, timeout_s)
        finally:
            _kill_left_in(told.read().decode().strip())


def _path(environment: Mapping[str, str]) -> str:
    return f"{environment.get('PATH', '/usr/bin:/bin')}:{debian.environment()['PATH']}"


def _until_ended(process: subprocess.Popen[bytes], deadline_s: float, timeout_s: float) -> int:
    """Pass signals on until the process has ended; returns its exit code."""
    killed = False
    while True:
        code = process.poll()
        now_s = time.monotonic()
        if code is not None:
            return code if code >= 0 else 128 - code
        if now_s >= deadline_s:
            if not killed:
                debian.say(f"vcan: stopped after {timeout_s:g} s")
            process.kill()
            process.wait()
            return 128 + signal.SIGKILL if killed else debian.EXIT_TIMEOUT
        caught = signal.sigtimedwait(_WATCHED, min(_LOOK_S, deadline_s - now_s))
        if caught is None or caught.si_signo == signal.SIGCHLD:
            continue
        if caught.si_code != _SI_KERNEL:
            process.send_signal(caught.si_signo)
        if caught.si_signo == signal.SIGTERM:
            deadline_s, killed = min(deadline_s, now_s + _GRACE_S), True


@contextmanager
def _signals_wait() -> Iterator[set[signal.Signals | int]]:
    """Block the signals for ``sigtimedwait``; returns the signal mask for the command."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _WATCHED)
    try:
        yield before
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _give_back(mask: set[signal.Signals | int]) -> None:
    signal.pthread_sigmask(signal.SIG_SETMASK, mask)
    for number in _PASSED_ON:
        signal.signal(number, signal.SIG_DFL)


@contextmanager
def _orphans_come_here() -> Iterator[None]:
    """Become the parent of processes that the command leaves behind, so that they can be found and ended."""
    prctl: Callable[..., int] = ctypes.CDLL(None, use_errno=True).prctl
    prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    try:
        yield
    finally:
        prctl(_PR_SET_CHILD_SUBREAPER, 0, 0, 0, 0)


def _kill_left_in(namespace: str) -> None:
    """Kill and reap the children of this process that are in a network namespace, until none is left.

    The children of a killed process become children of this one in turn.

    :param namespace: as named by ``/proc/PID/ns/net``; empty if the namespace was never made.
    """
    deadline_s = time.monotonic() + _GRACE_S
    while namespace and (left := _children_in(namespace)):
        for pid in left:
            # It has ended and was reaped by other code that waits for the children of this process.
            with suppress(ProcessLookupError, ChildProcessError):
                os.kill(pid, signal.SIGKILL)
                os.waitpid(pid, 0)
        if time.monotonic() > deadline_s:
            raise debian.MachineError(f"what the command has left behind does not end: processes {left}")


def _children_in(namespace: str) -> list[int]:
    """Process numbers of this process's running children in a network namespace."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        # It has ended meanwhile, or belongs to another user.
        with suppress(FileNotFoundError, ProcessLookupError, PermissionError):
            fields = (entry / "stat").read_text(errors="replace").rpartition(")")[2].split()
            if int(fields[1]) == os.getpid() and os.readlink(entry / "ns" / "net") == namespace:
                found.append(int(entry.name))
    return found
