"""Programs for aarch64 that this kernel starts like its own: binfmt_misc with Debian's static qemu-user.

The emulator is registered with flag F (the kernel holds it open), so that it also serves a container or a chroot in
which its file does not exist.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from railhil.machines import debian

_PURPOSE = "programs for aarch64"
_EMULATOR = "qemu-aarch64-static"
#: The line of Debian's package, as systemd would register it: magic and mask of an ELF file for aarch64, flags OPF.
_RULE = Path("/usr/lib/binfmt.d/qemu-aarch64.conf")
#: Of the entry that is made here; no other tool has it.
_NAME = "railhil-aarch64"
#: How an ELF file for aarch64 begins, as the kernel prints it: 64 bits, little-endian, EM_AARCH64 (elf.h).
_MAGIC = "7f454c460201010000000000000000000200b700"


def serves_containers(entry: str) -> bool:
    """Whether what the kernel says of an entry of binfmt_misc is a working emulator of aarch64, with flag F."""
    lines = entry.splitlines()
    flags = re.search(r"^flags: (\w*)$", entry, re.MULTILINE)
    return lines[:1] == ["enabled"] and f"magic {_MAGIC}" in lines and flags is not None and "F" in flags.group(1)


def own_entry(rule: str) -> str:
    """The line of a binfmt.d file under the name of the entry that is made here.

    Raises:
        MachineError: it is not for aarch64, or its flags lack F.
    """
    match = re.fullmatch(r":qemu-aarch64(:M:.*:\w*F\w*)", rule.strip())
    if match is None:
        raise debian.MachineError(f"{_RULE}: no rule qemu-aarch64 with flag F")
    return f":{_NAME}{match.group(1)}"


@contextmanager
def aarch64_programs() -> Iterator[None]:
    """For its duration this kernel starts programs for aarch64. An emulator that the host has registered is used.

    One process at a time. The file system is mounted on a folder of its own: it is the same one wherever it is mounted,
    and what the host has mounted is left alone.

    Raises:
        CapabilityError: no root on an x86-64 Debian, no emulator, or a kernel without binfmt_misc.
        MachineError: the kernel refuses the entry.
    """
    debian.require_debian_root(_PURPOSE)
    debian.install_commands({_EMULATOR: "qemu-user-static"}, _PURPOSE)
    with debian.cache_lock("binfmt"), tempfile.TemporaryDirectory(prefix="railhil-binfmt-") as name:
        try:
            debian.run_tool(["mount", "-t", "binfmt_misc", "none", name])
        except debian.MachineError as error:
            raise debian.CapabilityError(f"{_PURPOSE}: this kernel has no binfmt_misc ({error})") from error
        try:
            with registered(Path(name), _RULE):
                yield
        finally:
            debian.run_tool(["umount", name])


@contextmanager
def registered(binfmt: Path, rule: Path) -> Iterator[None]:
    """Register the emulator in the mounted file system unless there is one, and take it out afterwards.

    Raises:
        CapabilityError: the host has switched binfmt_misc off.
        MachineError: the kernel refuses the entry.
    """
    if (binfmt / "status").read_text().strip() != "enabled":
        raise debian.CapabilityError(f"{_PURPOSE}: binfmt_misc is switched off on this host")
    own = binfmt / _NAME
    if own.exists():
        # Of a process that was killed.
        own.write_text("-1")
    entries = [path for path in binfmt.iterdir() if path.name not in ("register", "status")]
    if any(serves_containers(path.read_text()) for path in entries):
        yield
        return
    try:
        (binfmt / "register").write_text(own_entry(rule.read_text()))
    except OSError as error:
        raise debian.MachineError(f"{_PURPOSE}: the kernel refuses the emulator ({error})") from error
    try:
        yield
    finally:
        own.write_text("-1")
