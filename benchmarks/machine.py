"""Description of the machine on which the figures are measured, without which they are meaningless."""

from __future__ import annotations

import os
import platform
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from time import perf_counter

import numpy as np
import psutil

from railhil.common.build import python_build, railhil_build

_LIBRARIES = ("python-can", "cantools", "numpy", "scipy", "psutil", "fxpmath", "apytypes", "do-mpc")
#: A machine counts as busy if other processes use more than this share of it.
_BUSY_SHARE = 0.5
_LOOK_S = 0.5
#: Numbers of a list: with their objects 8 MB, more than a core has as its own cache; and few enough for any cache.
_FAR, _NEAR = 250_000, 256
_READS = 200_000
#: Parts of the CPU's name: emulated by QEMU; the host's, where a user-mode kernel makes the system calls.
_EMULATORS = ("QEMU TCG", "UML")


@dataclass(frozen=True, slots=True)
class Machine:
    """Description of the machine and its state before the first benchmark.

    ``build``: how this CPython was compiled; ``railhil_build``: ``pure`` or ``compiled``. ``load_1min``: runnable
    processes, mean over a minute. ``cpu_used``: share of all cores in use, 0..1. ``far_read_ns``: see
    :func:`far_read_ns`.
    """

    cpu: str
    cores: int
    memory_gb: float
    kernel: str
    python: str
    build: str
    railhil_build: str
    libraries: dict[str, str]
    load_1min: float
    cpu_used: float
    far_read_ns: float

    @property
    def busy(self) -> bool:
        """True if other processes use the machine, so that the figures are worse than it can achieve."""
        return self.load_1min > _BUSY_SHARE * self.cores or self.cpu_used > _BUSY_SHARE

    @property
    def emulated(self) -> bool:
        """True in a machine that is emulated by software, such as the machine of ``railhil vcan``."""
        return _is_emulators(self.cpu)

    @property
    def warning(self) -> str:
        """One line for the reader of the figures; empty on an idle machine."""
        if not self.busy:
            return ""
        return (
            f"machine is busy (load {self.load_1min:.2f} on {self.cores} cores, {self.cpu_used:.0%} of the CPU used): "
            "wall times and p99 below are worse than this machine can do"
        )

    def lines(self) -> list[tuple[str, str]]:
        """``(key, text)`` for printing."""
        emulated = [("EMULATED", "software translates this machine's instructions: only its ratios say something")]
        return [
            *(emulated if self.emulated else []),
            ("CPU", f"{self.cpu}, {self.cores} cores usable, {self.memory_gb:.1f} GB"),
            ("system", self.kernel),
            ("Python", f"{self.python} ({self.build})"),
            ("railhil", self.railhil_build),
            ("libraries", ", ".join(f"{name} {number}" for name, number in self.libraries.items())),
            ("at start", f"load average {self.load_1min:.2f} (1 min), {self.cpu_used:.0%} of the CPU in use"),
            ("latency", f"a read that depends on the one before, anywhere in 8 MB: {self.far_read_ns:.0f} ns"),
        ]


def cpu_model(cpuinfo: Path = Path("/proc/cpuinfo")) -> str:
    """Name of the CPU according to the kernel, with the numbers of its family and model. A virtual machine often names
    only the maker, and generations differ by a factor. Without a name, the architecture."""
    found: dict[str, str] = {}
    if cpuinfo.is_file():
        for line in cpuinfo.read_text(encoding="utf-8", errors="replace").splitlines():
            key, _, value = line.partition(":")
            found.setdefault(key.strip(), value.strip())
    name = found.get("model name")
    if name is None:
        return platform.processor() or platform.machine()
    numbers = [f"{word} {found[key]}" for word, key in (("family", "cpu family"), ("model", "model")) if key in found]
    return f"{name} ({' '.join(numbers)})" if numbers else name


def _is_emulators(cpu: str) -> bool:
    return any(name in cpu for name in _EMULATORS)


def is_emulated() -> bool:
    """See :attr:`Machine.emulated`."""
    return _is_emulators(cpu_model())


def far_read_ns() -> float:
    """Time of a read from memory whose address is known only after the read before, anywhere in 8 MB; best of three.

    Other guests of a shared host can make it slow without any load on this machine, and a loop of few instructions does
    not show it.
    """
    near_s, far_s = _read_s(_NEAR), _read_s(_FAR)
    # A number of a list is two reads: the list's entry, and the number.
    return (far_s - near_s) / 2 * 1e9


def chain_of(numbers: int) -> list[int]:
    """Place -> the next place: one round through all of them, in an order that no processor can foresee."""
    order = np.random.default_rng(1).permutation(numbers)
    following = np.empty(numbers, dtype=np.int64)
    following[order] = np.roll(order, -1)
    return [int(place) for place in following]


def _read_s(numbers: int) -> float:
    chain, at, taken_s = chain_of(numbers), 0, []
    for _ in range(3):
        start_s = perf_counter()
        for _ in range(_READS):
            at = chain[at]
        taken_s.append((perf_counter() - start_s) / _READS)
    return min(taken_s)


def this_machine() -> Machine:
    """Description of this machine; observes its load for half a second."""
    return Machine(
        cpu=cpu_model(),
        cores=len(os.sched_getaffinity(0)),
        memory_gb=psutil.virtual_memory().total / 1e9,
        kernel=f"{platform.system()} {platform.release()} {platform.machine()}",
        python=f"{platform.python_implementation()} {platform.python_version()}",
        build=python_build(),
        railhil_build=railhil_build(),
        libraries={name: version(name) for name in _LIBRARIES},
        load_1min=os.getloadavg()[0],
        cpu_used=psutil.cpu_percent(interval=_LOOK_S) / 100,
        far_read_ns=far_read_ns(),
    )
