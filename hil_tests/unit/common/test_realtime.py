"""What a node requests from the kernel: granted or refused, reported, limited, and restored."""

from __future__ import annotations

import ast
import ctypes
import gc
import itertools
import json
import os
import re
import resource
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace

import pytest

from hil_tests.support.paths import ROOT
from railhil.bus.codes import ends_run
from railhil.bus.local import LocalBus
from railhil.common import scheduling as realtime
from railhil.common.scheduling import HUB_PRIORITY, NODE_PRIORITY, RECORDER_PRIORITY, cycle, permitted_priority, said_in
from railhil.controller_node.ato.node import ControllerNode
from railhil.plant_sim.node import make_plant_node
from railhil.record.session import make_session
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.systems.ato.scenario.model import Scenario

PERMITTED = permitted_priority()[0] == NODE_PRIORITY
GET_TIMERSLACK = 30


def slack_ns() -> int:
    return int(ctypes.CDLL(None).prctl(GET_TIMERSLACK, 0, 0, 0, 0))


def policy() -> int:
    """Of this process; the flag that stays when SCHED_FIFO was given back is of no account."""
    return os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK


@dataclass
class Kernel:
    """One that knows no CAP_SYS_NICE: its rtprio limit, and the priorities it was asked for."""

    limit: int = 33
    asked: list[int] = field(default_factory=list)


@pytest.fixture
def kernel(monkeypatch: pytest.MonkeyPatch) -> Kernel:
    found = Kernel()
    before = resource.getrlimit

    def set_scheduler(_: int, policy: int, parameter: os.sched_param) -> None:
        if policy & ~os.SCHED_RESET_ON_FORK == os.SCHED_OTHER:
            return
        found.asked.append(parameter.sched_priority)
        if parameter.sched_priority > found.limit:
            raise PermissionError(1, "Operation not permitted")

    def get_limit(which: int) -> tuple[int, int]:
        return (found.limit, found.limit) if which == resource.RLIMIT_RTPRIO else before(which)

    monkeypatch.setattr(os, "sched_setscheduler", set_scheduler)
    monkeypatch.setattr(resource, "getrlimit", get_limit)
    return found


def test_the_hub_comes_first_and_the_recorder_last_below_the_interrupt_threads() -> None:
    assert 50 > HUB_PRIORITY > NODE_PRIORITY > RECORDER_PRIORITY > 0


def test_a_cycle_without_a_priority_says_nothing_and_keeps_collector_and_slack_away(capfd) -> None:
    before = slack_ns()
    assert gc.isenabled()
    with cycle("plant", 0) as scheduling:
        assert (gc.isenabled(), slack_ns(), policy()) == (False, 1, os.SCHED_OTHER)
        assert scheduling.sentence == "normal scheduling"
    assert (gc.isenabled(), slack_ns()) == (True, before)
    assert capfd.readouterr().err == ""


#: In a process of its own: to lock the memory of all tests takes seconds.
_SAID = f"""
import json, os, resource
from railhil.common.scheduling import cycle
def policy():
    return os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK
with cycle("plant", {NODE_PRIORITY}) as scheduling:
    granted = policy(), os.sched_getparam(0).sched_priority
    limits_us = resource.getrlimit(resource.RLIMIT_RTTIME)
print(json.dumps([granted, limits_us, policy(), scheduling.priority, scheduling.sentence]))
"""


def test_what_is_granted_is_said_and_given_back() -> None:
    done = subprocess.run([sys.executable, "-c", _SAID], cwd=ROOT, capture_output=True, text=True, timeout=60)
    granted, (soft_us, hard_us), after, priority, sentence = json.loads(done.stdout)
    assert granted == ([os.SCHED_FIFO, NODE_PRIORITY] if PERMITTED else [os.SCHED_OTHER, 0])
    assert 0 < soft_us <= 500_000
    assert 0 < hard_us <= 2_000_000
    assert (after, priority) == (os.SCHED_OTHER, 0)
    assert done.stderr == f"plant: scheduling: {sentence}\n"
    assert said_in(f"plant: hub (given)\n{done.stderr}plant: later\n", "plant") == sentence
    begin = rf"SCHED_FIFO {NODE_PRIORITY}, " if PERMITTED else r"not permitted \(.+\); normal scheduling, "
    assert re.match(rf"{begin}memory (locked|not locked \(.+ KiB\))", sentence)


def test_a_node_that_was_not_asked_is_scheduled_normally() -> None:
    assert said_in("hub ready\nplant: scheduling: SCHED_FIFO 40, memory locked\n", "hub") == "normal scheduling"


_UNSAID = f"""
from railhil.common.scheduling import cycle
with cycle("supervisor", {RECORDER_PRIORITY}, aloud=False) as scheduling:
    print(scheduling.sentence)
"""


def test_the_supervisor_does_not_say_it_on_the_users_terminal() -> None:
    done = subprocess.run([sys.executable, "-c", _UNSAID], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.stdout.strip()
    assert done.stderr == ""


@pytest.mark.slow
def test_a_lower_limit_is_used_as_far_as_it_goes(kernel: Kernel) -> None:
    with cycle("plant", NODE_PRIORITY, aloud=False) as scheduling:
        assert scheduling.priority == 33
    assert scheduling.sentence.startswith("SCHED_FIFO 33, ")
    assert kernel.asked == [NODE_PRIORITY, 33]


@pytest.mark.slow
def test_a_refusal_says_why(kernel: Kernel) -> None:
    kernel.limit = 0
    with cycle("plant", NODE_PRIORITY, aloud=False) as scheduling:
        assert scheduling.priority == 0
    assert scheduling.sentence.startswith("not permitted (no CAP_SYS_NICE, rtprio limit 0); normal scheduling, memory ")
    assert kernel.asked == [NODE_PRIORITY]


def test_another_thread_is_refused_because_nobody_could_stop_it() -> None:
    sentences: list[str] = []

    def work() -> None:
        with cycle("plant", NODE_PRIORITY, aloud=False) as scheduling:
            sentences.append(scheduling.sentence)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert sentences == ["not permitted (not the main thread of its process); normal scheduling"]


@pytest.mark.parametrize(
    ("limit", "locked", "result", "flags", "said"),
    [
        (-1, 0, 0, [1, 3], "memory locked"),
        # More is locked than the limit allows: it does not hold for this process.
        (8 << 20, 90 << 20, 0, [1, 3], "memory locked"),
        # An allocation beyond the limit would fail, so only what there is.
        (256 << 20, 90 << 20, 0, [1], "memory locked as far as it was in use at the start"),
        (8 << 20, 0, -1, [1], "memory not locked (cannot allocate memory, memlock limit 8192 KiB)"),
    ],
)
def test_memory_is_locked_as_far_as_is_safe(
    monkeypatch: pytest.MonkeyPatch, limit: int, locked: int, result: int, flags: list[int], said: str
) -> None:
    asked: list[int] = []
    libc = SimpleNamespace(mlockall=lambda which: asked.append(which) or result)
    monkeypatch.setattr(resource, "getrlimit", lambda which: (limit, limit))
    monkeypatch.setattr(realtime, "_locked_bytes", lambda: locked)
    monkeypatch.setattr(ctypes, "get_errno", lambda: 12)
    assert realtime._lock_memory(libc) == said
    assert asked == flags


_RUNAWAY = """
import os, time
from railhil.common.scheduling import cycle
with cycle("plant", 40) as scheduling:
    started = time.process_time()
    while os.sched_getscheduler(0) & os.SCHED_FIFO and time.process_time() - started < 1.8:
        pass
    print(scheduling.sentence)
"""


@pytest.mark.slow
def test_a_runaway_gives_realtime_up() -> None:
    done = subprocess.run([sys.executable, "-c", _RUNAWAY], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    if PERMITTED:
        given_up = "SCHED_FIFO 40 given up: it computed for 0.5 s without a pause; normal scheduling"
        assert done.stdout.strip() == given_up
        assert said_in(done.stderr, "plant") == given_up
    else:
        assert done.stdout.startswith("not permitted")


_UNPRIVILEGED = """
import os, signal, sys
from railhil.common import scheduling as realtime

def drop():
    # A user with an rtprio limit has SCHED_FIFO and no CAP_SYS_NICE: so it is once this process is nobody's.
    os.setresgid(65534, 65534, 65534)
    os.setresuid(65534, 65534, 65534)

if sys.argv[1] == "permitted_priority":
    ask = realtime._ask
    realtime._ask = lambda priority: (ask(priority), drop())[0]
    granted = realtime.permitted_priority()[0]
else:
    with realtime.cycle("plant", 40, aloud=False) as scheduling:
        granted = scheduling.priority
        drop()
        if sys.argv[1] == "runaway":
            signal.raise_signal(signal.SIGXCPU)
print(granted, os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK == os.SCHED_OTHER)
"""


@pytest.mark.skipif(
    os.geteuid() != 0 or not PERMITTED,
    reason="MISSING CAPABILITY root with SCHED_FIFO, to give it back",
)
@pytest.mark.parametrize("what", ["cycle", "runaway", "permitted_priority"])
def test_a_user_with_a_limit_can_give_scheduling_back(what: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _UNPRIVILEGED, what], cwd=ROOT, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == "40 True\n"


# -- K1: a step of the wall clock -------------------------------------------------------------------------------------

#: Who may look at the wall clock: the name of a run's folder, and the stamps of messages for tools of python-can. An
#: exported file begins at the instant that the user names.
_MAY_LOOK = {
    "railhil/record/run_folder.py": {"gmtime"},
    "bus/hub/batches.py": {"time"},
    "railhil/report/files/content.py": {"datetime"},
    # No process of a run: what a command lists since an instant, and the date in a copy of a list.
    "railhil/cli/runs.py": {"datetime", "now"},
    "railhil/judge/requirements/lists.py": {"datetime", "now"},
}
_WALL = {"time", "time_ns", "gmtime", "localtime", "ctime", "now", "utcnow", "today", "CLOCK_REALTIME"}


def wall_clock_uses(path: Path) -> set[str]:
    """Names of wall-clock functions of time and datetime that a module uses."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.value.id in ("time", "datetime", "date") and node.attr in _WALL:
                found.add(node.attr)
        elif isinstance(node, ast.ImportFrom) and node.module in ("time", "datetime"):
            found |= {alias.name for alias in node.names} & (_WALL | {"datetime", "date"})
    return found


@pytest.mark.slow
def test_no_process_of_a_run_looks_at_the_wall_clock() -> None:
    packages = (
        "dbc",
        "bus",
        "plant_sim",
        "controller_node",
        "railhil/common",
        "railhil/faults",
        "railhil/scenarios",
        "railhil/record",
        "railhil/judge",
        "railhil/report",
        "railhil/live",
        "railhil/systems",
        "railhil/cli",
    )
    paths = sorted(path for package in packages for path in (ROOT / package).rglob("*.py"))
    uses = {str(path.relative_to(ROOT)): wall_clock_uses(path) for path in paths}
    assert len(uses) > 100
    assert {name: found for name, found in uses.items() if found} == _MAY_LOOK


def realtime_record(scenario: Scenario) -> list[str]:
    """Lines of the record of a realtime run in this process."""
    lines: list[str] = []
    session = make_session(scenario, lines.append, RunSpec(pace="realtime"))
    node = ControllerNode(scenario, LawSpec())
    plant = make_plant_node(scenario, RunSpec(pace="realtime", rate=100.0), LocalBus([node.handle, session.handle]))
    assert ends_run(plant.run())
    assert plant.administrator.counters["missed_polls"] == 0
    return lines


@pytest.mark.wall_clock
def test_a_step_of_the_wall_clock_changes_nothing(run_2m: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    """The wall clock jumps by two hours at each look."""
    steady = realtime_record(run_2m)
    looks = itertools.count()
    monkeypatch.setattr(time, "time", lambda: 1e9 + (-1) ** next(looks) * 3600.0)
    monkeypatch.setattr(time, "time_ns", lambda: int(time.time() * 1e9))
    assert realtime_record(run_2m) == steady
    assert len(steady) > 1500
