"""A throw-away virtual machine with kernel SocketCAN: ``railhil vcan --via user-mode [--share DIR] -- COMMAND ...``

Boots a kernel of Debian's whose root is this host's root, read-only under an overlay in memory; it has no network
card. The CAN interfaces are up; the command runs as root in the caller's directory with the caller's environment. Files
that it writes are gone afterwards, except below the shared folders. The command has no terminal and no input.

There are two kinds (:mod:`railhil.machines.vm_image`). The second is used where the first does not boot.
"""

from __future__ import annotations

import os
import selectors
import shlex
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import BinaryIO

from railhil.machines import debian
from railhil.machines.vm_image import KINDS, PURPOSE, Boot, Kind, VmImage, ensure_image

_EXIT_GRACE_S = 20.0
#: A machine that has not begun with the command after this time does not boot; the limit allows for a busy host.
_BOOT_S = 180.0
_LOOK_S = 1.0


class DoesNotBootError(debian.MachineError):
    """The machine has not begun with the command."""


def ensure_machine(kind: Kind) -> VmImage:
    """Install and download missing parts; only installing needs root.

    Raises:
        CapabilityError: not Debian on x86-64, not on this processor, or a package is missing and not available.
        MachineError: a package is not as expected.
    """
    debian.require_debian(PURPOSE)
    if reason := kind.unable():
        raise debian.CapabilityError(reason)
    if not all(debian.find_command(command) for command in kind.packages):
        debian.require_debian_root(PURPOSE)
        debian.install_commands(kind.packages, PURPOSE)
    return ensure_image(kind.recipe)


def _quoted_command(command: Sequence[str], cwd: Path, environment: Mapping[str, str]) -> str:
    """Shell text that runs ``command`` in ``cwd`` with exactly ``environment``."""
    words = ["env", "-i", *(f"{name}={value}" for name, value in environment.items()), *command]
    return f"cd {shlex.quote(str(cwd))} && exec {shlex.join(words)}\n"


def _copy_until_end(sources: Mapping[int, BinaryIO], began: Path, deadline_s: float) -> bool:
    """Copy each pipe to its sink until all are closed; ``False`` if the deadline passed first.

    Raises:
        DoesNotBootError: the machine has not made the file ``began`` in time.
    """
    boot_s = time.monotonic() + _BOOT_S
    with selectors.DefaultSelector() as selector:
        for pipe, sink in sources.items():
            selector.register(pipe, selectors.EVENT_READ, sink)
        while selector.get_map():
            now_s = time.monotonic()
            if now_s > deadline_s:
                return False
            if now_s > boot_s and not began.exists():
                raise DoesNotBootError(f"not booted after {_BOOT_S:g} s")
            for key, _ in selector.select(_LOOK_S):
                data = os.read(key.fd, 65536)
                if data:
                    key.data.write(data)
                    key.data.flush()
                else:
                    selector.unregister(key.fd)
    return True


def first_that_boots(action: Callable[[Kind], int], kinds: Sequence[Kind] = tuple(KINDS.values())) -> int:
    """Result of ``action`` with the first kind of machine that this host can have.

    Raises:
        CapabilityError: it can have none.
        MachineError: none boots, or the machine failed later.
    """
    failures: list[str] = []
    error_type: type[Exception] = debian.CapabilityError
    for kind in kinds:
        try:
            return action(kind)
        except (debian.CapabilityError, DoesNotBootError) as error:
            failures.append(f"{kind.said}: {error}" if len(kinds) > 1 else str(error))
            error_type = debian.MachineError if isinstance(error, DoesNotBootError) else error_type
    raise error_type("; ".join(dict.fromkeys(failures)))


def run(
    kind: Kind,
    command: Sequence[str],
    *,
    interfaces: Sequence[str] = ("vcan0", "vcan1"),
    cwd: Path | None = None,
    environment: Mapping[str, str] | None = None,
    shares: Sequence[Path] = (),
    timeout_s: float = 600.0,
    memory_mb: int = 2048,
    processors: int = 2,
    disks: Mapping[Path, Path] | None = None,
    stdout: BinaryIO | None = None,
    stderr: BinaryIO | None = None,
) -> int:
    """Boot the machine, run ``command`` in it, and return the command's exit code.

    Args:
        command: words of the command, looked up in the host's file system.
        interfaces: virtual CAN interfaces that are up in the machine.
        cwd: directory it runs in, the caller's by default; ``environment`` likewise.
        shares: host folders that the command may write to, at the same path. If the kernel is a user-mode one, all
            files that it makes there belong to this user.
        timeout_s: for everything from boot to power-off.
        memory_mb: of the machine.
        processors: of an emulated machine. If the host is also busy with other work, one is better: two wait for each
            other when the host does not have two to spare.
        disks: file with an ext4 file system -> folder where the machine mounts it, writable.
        stdout, stderr: where the command's output goes, this process's own by default.

    Returns:
        The exit code; 124 after ``timeout_s``.

    Raises:
        CapabilityError: the machine is not available on this host.
        DoesNotBootError: the machine ended, or time passed, before it began with the command.
        MachineError: the machine ended without an exit code; the text has the end of its console.
    """
    image = ensure_machine(kind)
    deadline_s = time.monotonic() + timeout_s
    # Not below /run, where the machine has its own file system.
    with tempfile.TemporaryDirectory(prefix="railhil-vm-") as name:
        control = Path(name)
        where = (cwd or Path.cwd()).resolve()
        text = _quoted_command(command, where, os.environ if environment is None else environment)
        (control / "command").touch(mode=0o600)
        (control / "command").write_text(text, encoding="utf-8", errors="surrogateescape")
        (control / "interfaces").write_text("".join(f"{name}\n" for name in interfaces))
        folders = [folder.resolve() for folder in shares]
        (control / "shares").write_text("".join(f"share{n} {path}\n" for n, path in enumerate(folders)))
        mounts = list((disks or {}).items())
        (control / "disks").write_text("".join(f"{chr(97 + n)} {path}\n" for n, (_, path) in enumerate(mounts)))
        out_read, out_write = os.pipe()
        err_read, err_write = os.pipe()
        try:
            images = [disk for disk, _ in mounts]
            boot = Boot(image, control, folders, images, memory_mb, processors, (out_write, err_write))
            with (control / "machine.log").open("wb") as log:
                machine = subprocess.Popen(
                    kind.words(boot), stdin=subprocess.DEVNULL, stdout=log, stderr=log, pass_fds=(out_write, err_write),
                    start_new_session=True,
                )  # fmt: skip
            try:
                os.close(out_write)
                os.close(err_write)
                sinks = {out_read: stdout or sys.stdout.buffer, err_read: stderr or sys.stderr.buffer}
                if not _copy_until_end(sinks, control / "began", deadline_s):
                    debian.say(f"vcan: stopped after {timeout_s:g} s")
                    return debian.EXIT_TIMEOUT
                machine.wait(timeout=_EXIT_GRACE_S)
            finally:
                # To the command line that ends all of it.
                machine.terminate()
                machine.wait()
        finally:
            os.close(out_read)
            os.close(err_read)
        return _exit_code(control)


def _exit_code(control: Path) -> int:
    """Exit code that the machine left behind, after the machine's own complaints."""
    logs = (control / "console.log", control / "machine.log")
    text = "\n".join(path.read_text(errors="replace") for path in logs if path.exists())
    for line in text.splitlines():
        if line.startswith("railhil-vm: "):
            debian.say(line.strip())
    left = control / "exit_code"
    if not left.exists():
        tail = " | ".join(deque((line.strip() for line in text.splitlines() if line.strip()), maxlen=3))
        error = debian.MachineError if (control / "began").exists() else DoesNotBootError
        raise error(f"the virtual machine ended without an exit code: {tail or 'no output'}")
    return int(left.read_text())
