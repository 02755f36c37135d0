"""Prepares once, and beside other work, what later parts of ``make test`` would each wait for:
``python -m hil_tests.prepared WHAT...``

``bytecode``: that of railhil, its libraries and its tests. ``batches``: the machine code of the batches of trains.
``machines``: Debian's packages, the kernel with CAN and the container image; needs no library. What fails here is tried
again, and reported, by the part that needs it.
"""

from __future__ import annotations

import argparse
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from hil_tests.machines import docker_vm, kinds, tools
from hil_tests.support.paths import ROOT
from railhil.machines import debian

#: A short scenario of each system with compiled loops, and a law that is quickly made.
BATCHES = {"yizhuang_05": "ipfc", "hst_short": "pid", "yizhuang_stop": "ilc_stop"}
_COLLECT = [sys.executable, "-m", "pytest", "--collect-only", "-qq"]


def bytecode() -> None:
    """Compile what the tests import, by collecting them."""
    subprocess.run(_COLLECT, cwd=ROOT, stdout=subprocess.DEVNULL, check=False)


def compile_batches(folder: Path) -> None:
    """One run of each batch, below a folder; the machine code stays in numba's cache."""
    from railhil.library import campaign

    for scenario, law in BATCHES.items():
        campaign(scenario, laws=[law], runs=1, out=folder / scenario)


def batches() -> None:
    """As :func:`compile_batches`, in a folder that is removed."""
    with tempfile.TemporaryDirectory(prefix="railhil-prepared-") as folder:
        compile_batches(Path(folder))


def machines() -> None:
    """Install, fetch and build, each once; what is there already costs a second."""
    # A shell lets what it starts in the background ignore Ctrl-C.
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda received, _: sys.exit(128 + received))
    steps: list[Callable[[], object]] = [
        tools.install_compilers,
        tools.install_emulation,
        tools.install_browser,
        lambda: docker_vm.build_image(ROOT),
        tools.install_can_tools,
        kinds.first_available,
    ]
    for step in steps:
        try:
            step()
        except (debian.CapabilityError, debian.MachineError, OSError, subprocess.TimeoutExpired) as error:
            print(f"not prepared: {error}", flush=True)


WHAT: dict[str, Callable[[], None]] = {"bytecode": bytecode, "batches": batches, "machines": machines}


def main() -> None:
    """Command line; see the module's docstring."""
    parser = argparse.ArgumentParser(prog="python -m hil_tests.prepared")
    parser.add_argument("what", choices=WHAT, nargs="+")
    for what in parser.parse_args().what:
        WHAT[what]()


if __name__ == "__main__":
    main()
