"""The tests on kernel SocketCAN, where there is one: ``python -m hil_tests.transport.vcan [OPTION OF PYTEST ...]``

Exit code: as of :mod:`railhil.machines.vcan`; that of pytest when the tests cannot even be collected.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from hil_tests.support.paths import ROOT
from railhil.machines import vcan
from railhil.machines.compiled import compile_by

#: Named by folder, and without the plugins that these tests do not use: what is imported takes its time there.
_TESTS = ["-m", "needs_socketcan", "hil_tests/transport/vcan"]
_UNUSED = ("cacheprovider", "hypothesispytest", "benchmark", "xdist", "xdist.looponfail")
_TIMEOUT_S = "1500"


def main(options: Sequence[str]) -> int:
    """Collect here, so that all is compiled, then run the tests with more options of pytest; returns the exit code."""
    os.chdir(ROOT)
    words = [sys.executable, "-m", "pytest", "-q", *(word for name in _UNUSED for word in ("-p", f"no:{name}"))]
    words += [*_TESTS, *options]
    collected = compile_by([*words, "--collect-only"])
    if collected.returncode != 0:
        print(collected.stdout, collected.stderr, sep="", end="")
        return collected.returncode
    # One: the tests of Docker may run beside these.
    return vcan.main(["--timeout", _TIMEOUT_S, "--processors", "1", "--", *words])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
