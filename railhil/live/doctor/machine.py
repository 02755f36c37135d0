"""Equipment of this machine for a run: processors, kernel and its CAN, serial ports, Docker, virtual machines."""

from __future__ import annotations

import itertools
import json
import os
import platform
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from railhil.common.errors import describe_os_error

#: Longest time to wait for a tool.
TOOL_TIMEOUT_S = 5.0


@dataclass(frozen=True, slots=True)
class Finding:
    """One line: subject, finding, and the command or step that improves it (empty: nothing to do)."""

    subject: str
    found: str
    advice: str = ""


def read_text(path: Path) -> str:
    """Stripped content of a small kernel file; empty when it cannot be read."""
    try:
        return path.read_text(encoding="utf-8", errors="replace").strip()
    except OSError:
        # The file is not in this kernel, or not for this user.
        return ""


def run_tool(*command: str) -> str | None:
    """Standard output of a tool; None when it is missing, fails or does not answer."""
    if shutil.which(command[0]) is None:
        return None
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=TOOL_TIMEOUT_S, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout if done.returncode == 0 else None


def join_names(names: Sequence[str], shown: int = 4) -> str:
    """A list of names, truncated when it is long."""
    return ", ".join(names[:shown]) + (f" and {len(names) - shown} more" if len(names) > shown else "")


#: Clock sources that are read in the processor.
_FAST_CLOCKS = ("tsc", "kvm-clock", "arch_sys_counter", "hyperv_clocksource_tsc_page", "riscv_clocksource")
#: Above this, reading the clock costs more than a frame, ns.
_READ_MAX_NS = 1000
_CLOCK = "sys/devices/system/clocksource/clocksource0"


def machine(root: Path = Path("/")) -> list[Finding]:
    """Clock, processors, frequency, virtualisation."""
    return [clock(root), inspect_cores(root), *inspect_governor(root), *inspect_host(root)]


def clock(root: Path, read_ns: int | None = None) -> Finding:
    """Clock source of the kernel, resolution and read time of the monotonic clock.

    :param read_ns: the read time; None: measure it.
    """
    current, available = (read_text(root / _CLOCK / f"{which}_clocksource") for which in ("current", "available"))
    resolution_ns = time.get_clock_info("monotonic").resolution * 1e9
    if read_ns is None:
        read_ns = _read_ns()
    words = f"{current or 'clock source not known'}, resolution {resolution_ns:g} ns, a look at it costs {read_ns} ns"
    if current and current not in _FAST_CLOCKS:
        better = next((name for name in _FAST_CLOCKS if name in available.split()), "")
        if better:
            return Finding("clock", f"{words}: slow", f"echo {better} | sudo tee /{_CLOCK}/current_clocksource")
        return Finding("clock", f"{words}: slow", "kernel parameter tsc=reliable, if the processor's counter is steady")
    if read_ns > _READ_MAX_NS:
        return Finding("clock", f"{words}: slow", "another kernel: this one does not read the clock in user space")
    return Finding("clock", words)


def _read_ns() -> int:
    """Read time of the monotonic clock, including the interpreter: the shortest of many."""
    looks = [time.perf_counter_ns() for _ in range(1001)]
    return min(after - before for before, after in itertools.pairwise(looks))


def inspect_cores(root: Path) -> Finding:
    """Processors that this process may use."""
    allowed, present = sorted(os.sched_getaffinity(0)), os.cpu_count() or 1
    isolated = read_text(root / "sys/devices/system/cpu/isolated")
    words = f"{len(allowed)} of {present} may be used" if len(allowed) < present else f"{present}"
    words += f", isolated: {isolated}" if isolated else ", none isolated"
    if len(allowed) < 2:
        return Finding("processors", words, "two or more: plant and controller otherwise wait for the recorder")
    return Finding("processors", words)


def inspect_governor(root: Path) -> list[Finding]:
    """Frequency scaling; nothing if the machine does not report it."""
    paths = root.glob("sys/devices/system/cpu/cpu[0-9]*/cpufreq/scaling_governor")
    found = sorted({read_text(path) for path in paths} - {""})
    if not found:
        return []
    advice = "" if found == ["performance"] else "sudo cpupower frequency-set -g performance"
    return [Finding("frequency", f"governor {', '.join(found)}", advice)]


def is_virtual(root: Path) -> bool:
    """True if the processor reports a hypervisor."""
    return "hypervisor" in read_text(root / "proc/cpuinfo")


def inspect_host(root: Path) -> list[Finding]:
    """Virtual machine and container."""
    found = []
    if is_virtual(root):
        words = "yes: its host may stop it for milliseconds, and no permission in here changes that"
        found.append(
            Finding("virtual machine", words, "run realtime on the machine itself; lockstep is exact here too")
        )
    container = any((root / name).exists() for name in (".dockerenv", "run/.containerenv"))
    groups = read_text(root / "proc/1/cgroup")
    if container or any(word in groups for word in ("docker", "kubepods", "containerd", "lxc")):
        found.append(Finding("container", "yes: limits and capabilities are the container's"))
    return found


#: Tools that `railhil vcan` needs to fetch a user-mode kernel and to start it, and the Debian package of each.
_MACHINE_TOOLS = {"dpkg-deb": "dpkg", "setpriv": "util-linux"}
_SYSTEM_PATH = "/usr/local/sbin:/usr/sbin:/sbin"


def tools(root: Path = Path("/")) -> list[Finding]:
    """Serial ports, virtual machine, Docker."""
    return [*list_serial_ports(root), virtual_machine(), docker()]


def list_serial_ports(root: Path) -> list[Finding]:
    """Serial ports on which an slcan adapter may be."""
    patterns = ("dev/ttyACM*", "dev/ttyUSB*")
    ports = sorted(path for pattern in patterns for path in root.glob(pattern))
    if not ports:
        return [Finding("serial ports", "none of the kind that slcan adapters have (ttyACM, ttyUSB)")]
    names = join_names([f"/{path.relative_to(root)}" for path in ports])
    if all(os.access(path, os.R_OK | os.W_OK) for path in ports):
        return [Finding("serial ports", f"{names} (`-i slcan -c PORT -b 500000`)")]
    return [Finding("serial ports", f"{names}, not all readable", "sudo usermod -aG dialout $USER, then log in again")]


def virtual_machine(system_path: str = _SYSTEM_PATH) -> Finding:
    """Whether `railhil vcan` can start a kernel with vcan.

    :param system_path: directories with system tools that are not on a user's PATH.
    """
    path = os.pathsep.join((os.environ.get("PATH", ""), system_path))
    missing = [package for tool, package in _MACHINE_TOOLS.items() if shutil.which(tool, path=path) is None]
    if missing:
        return Finding("railhil vcan", f"tools missing: {', '.join(missing)}", f"sudo apt install {' '.join(missing)}")
    return Finding("railhil vcan", "its tools are there")


def docker() -> Finding:
    """Docker for the compose file and its test."""
    if shutil.which("docker") is None:
        return Finding("docker", "not installed", "sudo apt install docker.io docker-compose")
    engine = run_tool("docker", "version", "--format", "{{.Server.Version}}")
    if engine is None:
        return Finding(
            "docker", "installed, no engine answers", "sudo systemctl start docker, or join the group docker"
        )
    if run_tool("docker", "compose", "version") is None and shutil.which("docker-compose") is None:
        return Finding("docker", f"engine {engine.strip()}, no compose", "sudo apt install docker-compose")
    return Finding("docker", f"engine {engine.strip()} with compose")


#: Type of a CAN interface in /sys/class/net (ARPHRD_CAN of linux/if_arp.h).
_CAN_TYPE = "280"
#: IFF_UP of linux/if.h.
_UP = 1
#: Holds the burst of one tick many times; the kernel's default of 10 is too small for a pause of the recorder.
_QUEUE_MIN = 100
_SUBJECT = "kernel CAN"
_WITHOUT = "use the hub, or `railhil vcan -- COMMAND`"
_MAKE_VCAN = "sudo ip link add dev vcan0 type vcan && sudo ip link set vcan0 up"


def kernel_can(
    root: Path = Path("/"), release: str | None = None, refusal: Callable[[], str] | None = None
) -> list[Finding]:
    """Whether the kernel has CAN, and the state of each interface.

    :param refusal: reason for which no CAN socket can be opened, empty if one can; None: try it.
    """
    reason = (refusal or _refusal)()
    if reason:
        return [_without(reason, _module(root, release or platform.release()))]
    names = can_interfaces(root)
    found = [Finding(_SUBJECT, "yes", "" if names else f"no interface: {_MAKE_VCAN}")]
    return found + [interface(root, name) for name in names]


def can_interfaces(root: Path) -> list[str]:
    """Names of the CAN interfaces, including vcan."""
    return sorted(path.parent.name for path in root.glob("sys/class/net/*/type") if read_text(path) == _CAN_TYPE)


def interface(root: Path, name: str, details: Callable[[str], dict[str, Any]] | None = None) -> Finding:
    """State, bit rate and queue of one interface.

    :param details: returns the output of ``ip -details -json`` for an interface; replaced in the tests.
    """
    folder = root / "sys/class/net" / name
    is_up = int(read_text(folder / "flags") or "0", 16) & _UP
    queue = int(read_text(folder / "tx_queue_len") or "0")
    info = (details or _details)(name)
    kind, data = info.get("info_kind", ""), info.get("info_data") or {}
    bit_rate = (data.get("bittiming") or {}).get("bitrate")
    words = [kind or "CAN", "up" if is_up else "down"]
    words += [f"{bit_rate} bit/s"] if bit_rate else []
    words += [str(data["state"])] if is_up and "state" in data else []
    words.append(f"txqueuelen {queue}")
    advice = ""
    if not is_up:
        rate = "" if kind in ("vcan", "vxcan", "slcan") or bit_rate else " type can bitrate 500000"
        advice = f"sudo ip link set {name}{rate} up"
    elif data.get("state") == "BUS-OFF":
        advice = f"sudo ip link set {name} type can restart"
    elif kind == "can" and not data.get("restart_ms"):
        words.append("no restart after bus-off")
        advice = f"sudo ip link set {name} down && sudo ip link set {name} type can restart-ms 100 && " + (
            f"sudo ip link set {name} up"
        )
    elif queue < _QUEUE_MIN:
        advice = f"sudo ip link set {name} txqueuelen 1000"
    return Finding(f"interface {name}", ", ".join(words), advice)


def _details(name: str) -> dict[str, Any]:
    """``linkinfo`` of an interface; empty without the tool."""
    said = run_tool("ip", "-details", "-json", "link", "show", "dev", name)
    try:
        links = json.loads(said or "[]")
    except ValueError:
        return {}
    return dict(links[0].get("linkinfo") or {}) if links else {}


def _refusal() -> str:
    """Reason for which no CAN socket can be opened; empty if one can."""
    if not hasattr(socket, "AF_CAN"):
        return "this Python has no AF_CAN"
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except OSError as error:
        return describe_os_error(error)
    return ""


def _without(reason: str, module: bool) -> Finding:
    if module:
        return Finding(_SUBJECT, f"no ({reason}), its module vcan is there", f"sudo modprobe vcan && {_MAKE_VCAN}")
    return Finding(_SUBJECT, f"no ({reason}), and no module vcan for this kernel", _WITHOUT)


def _module(root: Path, release: str) -> bool:
    """Whether the module is installed for the running kernel."""
    folder = root / "lib/modules" / release
    return any("/vcan.ko" in read_text(folder / name) for name in ("modules.dep", "modules.builtin"))
