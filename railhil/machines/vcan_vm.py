"""A throw-away virtual machine with kernel SocketCAN: ``railhil vcan --via machine [--share DIR] -- COMMAND ...``

Boots Debian's kernel in an emulated machine (QEMU, software translation, no network card) whose root is this host's
root, read-only under an overlay in memory. The CAN interfaces are up; the command runs as root in the caller's
directory with the caller's environment, some 25 times slower than on the host. What it writes is gone afterwards,
except below the shared folders. The command has no terminal and no input.
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
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import BinaryIO

from railhil.machines import debian
from railhil.machines.vm_image import VmImage, ensure_image

_PURPOSE = "a kernel with CAN in a virtual machine"
_PACKAGES = {"qemu-system-x86_64": "qemu-system-x86", "depmod": "kmod", "setpriv": "util-linux"}
_EXIT_GRACE_S = 20.0


def ensure_machine() -> VmImage:
    """Install and download what is missing; only installing needs root.

    Raises:
        CapabilityError: not Debian on x86-64, or a package is missing and not available.
        MachineError: a package is not as expected.
    """
    debian.require_debian(_PURPOSE)
    if not all(debian.find_command(command) for command in _PACKAGES):
        debian.require_debian_root(_PURPOSE)
        debian.install_commands(_PACKAGES, _PURPOSE)
    return ensure_image()


def _quoted_command(command: Sequence[str], cwd: Path, environment: Mapping[str, str]) -> str:
    """Shell text that runs ``command`` in ``cwd`` with exactly ``environment``."""
    words = ["env", "-i", *(f"{name}={value}" for name, value in environment.items()), *command]
    return f"cd {shlex.quote(str(cwd))} && exec {shlex.join(words)}\n"


def _export(tag: str, folder: Path, options: str) -> list[str]:
    """QEMU options that make a host folder visible in the machine under ``tag`` (a comma in a path is doubled)."""
    path = str(folder).replace(",", ",,")
    return [
        "-fsdev", f"local,id={tag},path={path},security_model=none,multidevs=remap{options}",
        "-device", f"virtio-9p-pci,fsdev={tag},mount_tag={tag}",
    ]  # fmt: skip


def _qemu_words(image: VmImage, control: Path, shares: Sequence[Path], disks: Sequence[Path], memory_mb: int,
                processors: int, pipes: tuple[int, int]) -> list[str]:  # fmt: skip
    """Command line of the machine; its two output ports write to the pipe ends ``pipes``."""
    # setpriv: the machine must not outlive this process, even if this process is killed.
    words = ["setpriv", "--pdeathsig", "KILL", "qemu-system-x86_64"]
    # No KVM: inside another virtual machine it was observed to abort or hang.
    words += ["-accel", "tcg,thread=multi", "-cpu", "max", "-smp", str(processors), "-m", str(memory_mb)]
    words += ["-nodefaults", "-no-user-config", "-nographic", "-no-reboot", "-nic", "none"]
    words += ["-kernel", str(image.kernel), "-initrd", str(image.initrd)]
    # random.trust_cpu: an idle machine has no other source of randomness, and Python would wait for one.
    # clocksource: the emulated processors share one cycle counter, which the kernel does not trust with two processors;
    # the timer that it would use instead leaves the emulation at each reading of the clock.
    words += [
        "-append",
        "console=ttyS0 quiet panic=-1 random.trust_cpu=on mitigations=off tsc=reliable clocksource=tsc",
    ]
    words += ["-serial", f"file:{control / 'console.log'}".replace(",", ",,")]
    words += ["-device", "virtio-serial-pci"]
    for number, pipe in enumerate(pipes, start=1):
        words += ["-add-fd", f"fd={pipe},set={number}"]
        words += ["-chardev", f"file,id=port{number},path=/dev/fdset/{number},append=on"]
        words += ["-device", f"virtserialport,nr={number},chardev=port{number},name=railhil{number}"]
    words += _export("root", Path("/"), ",readonly=on") + _export("control", control, "")
    for number, folder in enumerate(shares):
        words += _export(f"share{number}", folder, "")
    for disk in disks:
        words += ["-drive", f"if=virtio,format=raw,cache=unsafe,file={str(disk).replace(',', ',,')}"]
    return words


def _copy_until_end(sources: Mapping[int, BinaryIO], deadline_s: float) -> bool:
    """Copy each pipe to its sink until all are closed; ``False`` if the deadline passed first."""
    with selectors.DefaultSelector() as selector:
        for pipe, sink in sources.items():
            selector.register(pipe, selectors.EVENT_READ, sink)
        while selector.get_map():
            rest_s = deadline_s - time.monotonic()
            if rest_s <= 0:
                return False
            for key, _ in selector.select(rest_s):
                data = os.read(key.fd, 65536)
                if data:
                    key.data.write(data)
                    key.data.flush()
                else:
                    selector.unregister(key.fd)
    return True


def run(
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
        shares: host folders that the command may write to, at the same path.
        timeout_s: for everything from boot to power-off.
        memory_mb, processors: of the machine. If the host is also busy with other work, one processor is better: two
        wait for each other when the host does not have two to spare. disks: file with an ext4 file system -> folder
        where the machine mounts it, writable. stdout, stderr: where the command's output goes, this process's own by
        default.

    Returns:
        The exit code; 124 after ``timeout_s``.

    Raises:
        CapabilityError: the machine is not available on this host.
        MachineError: the machine ended without an exit code; the text has the end of its console.
    """
    image = ensure_machine()
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
        (control / "disks").write_text("".join(f"vd{chr(97 + n)} {path}\n" for n, (_, path) in enumerate(mounts)))
        out_read, out_write = os.pipe()
        err_read, err_write = os.pipe()
        try:
            images = [disk for disk, _ in mounts]
            words = _qemu_words(image, control, folders, images, memory_mb, processors, (out_write, err_write))
            with (control / "qemu.log").open("wb") as log:
                machine = subprocess.Popen(
                    words, stdin=subprocess.DEVNULL, stdout=log, stderr=log, pass_fds=(out_write, err_write),
                    start_new_session=True,
                )  # fmt: skip
            try:
                os.close(out_write)
                os.close(err_write)
                sinks = {out_read: stdout or sys.stdout.buffer, err_read: stderr or sys.stderr.buffer}
                if not _copy_until_end(sinks, deadline_s):
                    debian.say(f"vcan: stopped after {timeout_s:g} s")
                    return debian.EXIT_TIMEOUT
                machine.wait(timeout=_EXIT_GRACE_S)
            finally:
                machine.kill()
                machine.wait()
        finally:
            os.close(out_read)
            os.close(err_read)
        return _exit_code(control)


def _exit_code(control: Path) -> int:
    """Exit code that the machine left behind, after the machine's own complaints."""
    console = (control / "console.log").read_text(errors="replace") if (control / "console.log").exists() else ""
    for line in console.splitlines():
        if line.startswith("railhil-vm: "):
            debian.say(line.strip())
    left = control / "exit_code"
    if not left.exists():
        text = console + (control / "qemu.log").read_text(errors="replace")
        tail = " | ".join(deque((line.strip() for line in text.splitlines() if line.strip()), maxlen=3))
        raise debian.MachineError(f"the virtual machine ended without an exit code: {tail or 'no output'}")
    return int(left.read_text())
