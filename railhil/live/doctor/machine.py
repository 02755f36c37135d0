"""The machine: clock, processors, and whether it is virtual."""

from __future__ import annotations

import itertools
import os
import time
from pathlib import Path

from railhil.live.doctor.finding import Finding, text_of

#: Clock sources that are read in the processor.
_FAST_CLOCKS = ("tsc", "kvm-clock", "arch_sys_counter", "hyperv_clocksource_tsc_page", "riscv_clocksource")
#: Above this, reading the clock costs more than a frame, ns.
_READ_MAX_NS = 1000
_CLOCK = "sys/devices/system/clocksource/clocksource0"


def machine(root: Path = Path("/")) -> list[Finding]:
    """Clock, processors, frequency, virtualisation."""
    return [clock(root), cores(root), *governor(root), *below(root)]


def clock(root: Path, read_ns: int | None = None) -> Finding:
    """Clock source of the kernel, resolution and read time of the monotonic clock.

    :param read_ns: the read time; None: measure it.
    """
    current, available = (text_of(root / _CLOCK / f"{which}_clocksource") for which in ("current", "available"))
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


def cores(root: Path) -> Finding:
    """Processors that this process may use."""
    allowed, present = sorted(os.sched_getaffinity(0)), os.cpu_count() or 1
    isolated = text_of(root / "sys/devices/system/cpu/isolated")
    words = f"{len(allowed)} of {present} may be used" if len(allowed) < present else f"{present}"
    words += f", isolated: {isolated}" if isolated else ", none isolated"
    if len(allowed) < 2:
        return Finding("processors", words, "two or more: plant and controller otherwise wait for the recorder")
    return Finding("processors", words)


def governor(root: Path) -> list[Finding]:
    """Frequency scaling; nothing if the machine does not report it."""
    paths = root.glob("sys/devices/system/cpu/cpu[0-9]*/cpufreq/scaling_governor")
    found = sorted({text_of(path) for path in paths} - {""})
    if not found:
        return []
    advice = "" if found == ["performance"] else "sudo cpupower frequency-set -g performance"
    return [Finding("frequency", f"governor {', '.join(found)}", advice)]


def is_virtual(root: Path) -> bool:
    """True if the processor reports a hypervisor."""
    return "hypervisor" in text_of(root / "proc/cpuinfo")


def below(root: Path) -> list[Finding]:
    """Virtual machine and container."""
    found = []
    if is_virtual(root):
        words = "yes: its host may stop it for milliseconds, and no permission in here changes that"
        found.append(
            Finding("virtual machine", words, "run realtime on the machine itself; lockstep is exact here too")
        )
    container = any((root / name).exists() for name in (".dockerenv", "run/.containerenv"))
    groups = text_of(root / "proc/1/cgroup")
    if container or any(word in groups for word in ("docker", "kubepods", "containerd", "lxc")):
        found.append(Finding("container", "yes: limits and capabilities are the container's"))
    return found
