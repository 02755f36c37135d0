"""The end of a process that has read rows: its own exit code and nothing on standard error.

Threads of pyarrow that still hold what was read abort the process at its end, if the machine gives them no time before.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT
from hil_tests.support.toy_study import TOY, Plan, Request
from railhil.study.table import file_bytes

PLAN = Plan(Request(runs=60, chunk=20))
CHUNK = PLAN.chunks()[1]

#: Reads a file again and again, then ends with code 7. A thread other than the first one that gives back the content
#: waits, as it would on a busy machine.
READER = """
import io, pathlib, sys, threading, time

class Held:
    def __del__(self):
        if threading.current_thread() is not threading.main_thread():
            time.sleep(0.2)

class HeldBytes(Held, bytes):
    pass

class HeldFile(Held, io.BytesIO):
    pass

def threads():
    return len(list(pathlib.Path("/proc/self/task").iterdir()))

io.BytesIO = HeldFile
from hil_tests.support.toy_study import SCHEMA
from railhil.study.table import read_table

pathlib.Path.read_bytes = lambda path: HeldBytes(path.open("rb").read())
before = threads()
for _ in range(10):
    table = read_table(pathlib.Path(sys.argv[1]), SCHEMA)
print(table.num_rows, "rows,", threads() - before, "new threads")
sys.exit(7)
"""


def end_of_a_reader(folder: Path) -> tuple[int, str, str]:
    """Exit code, output and standard error of a process that reads a part."""
    part = folder / "part.parquet"
    part.write_bytes(file_bytes(TOY.work(PLAN, CHUNK).rows(), PLAN.origin(CHUNK)))
    done = subprocess.run(
        [sys.executable, "-c", READER, str(part)], cwd=ROOT, capture_output=True, text=True, timeout=60, check=False
    )
    return done.returncode, done.stdout, done.stderr


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="threads of a process are listed in /proc")
def test_rows_are_read_in_the_thread_that_asks(tmp_path: Path) -> None:
    assert end_of_a_reader(tmp_path) == (7, "20 rows, 0 new threads\n", "")


@pytest.mark.long
@pytest.mark.skipif(sys.platform != "linux", reason="threads of a process are listed in /proc")
def test_a_process_that_has_read_rows_ends_with_its_own_code(tmp_path: Path) -> None:
    """Of such processes in which pyarrow's threads read, half were aborted."""
    assert {end_of_a_reader(tmp_path) for _ in range(8)} == {(7, "20 rows, 0 new threads\n", "")}
