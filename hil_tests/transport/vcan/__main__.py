"""The tests on kernel SocketCAN, where there is one: ``python -m hil_tests.transport.vcan [--long] [OPTION ...]``

Where that is a virtual machine's, which is slow, the long tests are left out; ``--long`` makes them and no others.
The host's own kernel makes all of them.

Exit code: as of :mod:`railhil.machines.vcan`; that of pytest when the tests cannot even be collected.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from hil_tests.machines.bytecode import compile_by
from hil_tests.support.paths import ROOT
from railhil.machines import debian, namespace, vcan

#: Named by folder, and without the plugins that these tests do not use: what is imported takes its time there.
_TESTS = "hil_tests/transport/vcan"
_UNUSED = ("cacheprovider", "hypothesispytest", "benchmark", "xdist", "xdist.looponfail")
_TIMEOUT_S = "1500"
_INTERFACES = ("vcan0", "vcan1")


def _has_kernel() -> bool:
    """Whether the kernel of this host has vcan, at full speed."""
    try:
        namespace.require_namespace(_INTERFACES)
    except debian.CapabilityError:
        return False
    return True


def main(options: Sequence[str]) -> int:
    """Collect here, so that all is compiled, then run the tests with the options; returns the exit code."""
    os.chdir(ROOT)
    which = "needs_socketcan"
    if "--long" in options:
        which += " and long"
    elif not _has_kernel():
        which += " and not long"
    words = [sys.executable, "-m", "pytest", "-q", *(word for name in _UNUSED for word in ("-p", f"no:{name}"))]
    words += ["-m", which, _TESTS, *(option for option in options if option != "--long")]
    collected = compile_by([*words, "--collect-only"])
    if collected.returncode != 0:
        print(collected.stdout, collected.stderr, sep="", end="")
        return collected.returncode
    # One: the tests of Docker may run beside these.
    return vcan.main(["--timeout", _TIMEOUT_S, "--processors", "1", "--", *words])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
