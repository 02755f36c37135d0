"""User-mode Linux: a kernel that is a process of this host. It computes at the host's speed; its system calls, which it
sees by ptrace, are what takes time. One processor, and no root."""

from __future__ import annotations

from pathlib import Path

from railhil.machines.vm_image import CAN_MODULES, Recipe
from railhil.machines.vm_kind import Boot, Kind

_PACKAGE = "user-mode-linux"
#: The kernel has helpers, processes that would outlive it. It makes a group of them, which ends with the kernel, and
#: with this process, however that ends.
_WHOLE_GROUP = '"$@" & trap "kill -KILL -$!" TERM; wait; kill -KILL -$!'


_CPU_INFO = Path("/proc/cpuinfo")


def too_large_for(cpu_info: str) -> str:
    """Why Debian 12's user-mode kernel cannot boot on a processor; empty if it can.

    The kernel has room for the registers of a process up to AVX-512, 2696 bytes. Tiles (AMX) make them 11 008 bytes,
    and ptrace sets all of them or none (``userspace - ptrace set fp regs failed, errno = 14``, then a panic).

    :param cpu_info: what ``/proc/cpuinfo`` says.
    """
    flags = next((line for line in cpu_info.splitlines() if line.startswith("flags")), "")
    return "a user-mode kernel cannot hold the registers of this processor (AMX)" if " amx_tile" in flags else ""


def _unable() -> str:
    return too_large_for(_CPU_INFO.read_text(encoding="ascii", errors="replace")) if _CPU_INFO.exists() else ""


def _words(boot: Boot) -> list[str]:
    out, err = boot.outputs
    words = [str(boot.image.kernel), f"initrd={boot.image.initrd}", f"mem={boot.memory_mb}M", f"railhil={boot.control}"]
    # Where it keeps the socket of its management console.
    words += [f"uml_dir={boot.control}", "umid=uml", "quiet", "panic=-1"]
    words += ["con=null", "con0=null,fd:2", f"con1=null,fd:{out}", f"con2=null,fd:{err}"]
    words += [f"ubd{number}={disk}" for number, disk in enumerate(boot.disks)]
    return ["setpriv", "--pdeathsig", "TERM", "sh", "-c", _WHOLE_GROUP, "sh", *words]


USER_MODE = Kind(
    "a user-mode kernel",
    Recipe("user_mode", lambda: _PACKAGE, "usr/bin/linux.uml", "usr/lib/uml/modules/*", CAN_MODULES),
    {"setpriv": "util-linux"},
    _words,
    _unable,
)
