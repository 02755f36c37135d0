"""What the containers have left that ran on a kernel with CAN: the same bytes, and nothing else.

Tests, but not found by pytest: :mod:`hil_tests.transport.compose.vcan_runs` names them, after it has made what they
look at.
"""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path

import pytest

from hil_tests.transport.compose.engine import SERVICES, Up
from hil_tests.transport.compose.vcan_runs import CASES_VARIABLE, FOLDER_VARIABLE
from railhil.bench import local_run
from railhil.record.framelog import sha256_of
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec

_SHORT = str(Path(__file__).with_name("short_move.toml"))
_FOLDER = Path(os.environ[FOLDER_VARIABLE])
_SEED = 0
_ON_THE_HOST = SERVICES - {"bus"} | {"adapter"}


@dataclass(frozen=True, slots=True)
class Case:
    """What is expected of a case: scenario, interface, services, and whose capabilities."""

    scenario: str
    channel: str
    services: set[str]
    capabilities: dict[str, list[str]]
    realtime_priority: int = 0


_ALL = {
    "vcan": Case(_SHORT, "vcan0", SERVICES, {"bus": ["NET_ADMIN"]}),
    "published": Case("lvshun_tieshan", "vcan0", SERVICES, {"bus": ["NET_ADMIN"]}),
    "hardware": Case(_SHORT, "can0", _ON_THE_HOST, {}),
    "foreign": Case(_SHORT, "can0", _ON_THE_HOST - {"controller"}, {}, realtime_priority=45),
}
_NAMES = os.environ[CASES_VARIABLE].split()


@pytest.fixture(params=_NAMES)
def name(request) -> str:
    """One case that was run."""
    return request.param


@pytest.fixture
def left(name) -> Up:
    """What it left behind."""
    folder = _FOLDER / name
    return Up.read(folder, int((folder / "exit_code").read_text()), (folder / "out").read_text())


def test_run_gives_the_bytes_of_the_bench_without_containers(name, left, tmp_path):
    assert left.exit_code in (0, 1), left.out
    score = json.loads((left.run_folder / "score.json").read_text())
    # The published run with this seed stops 0.22 m off and misses its limit.
    assert left.exit_code == {"PASS": 0, "FAIL": 1}[score["verdict"]], left.out
    expected = local_run(load(_ALL[name].scenario), tmp_path, RunSpec(seed=_SEED)).frames_sha256
    assert sha256_of(left.run_folder / "frames.log") == expected
    certificate = json.loads((left.run_folder / "certificate.json").read_text())
    assert certificate["frames_sha256"] == expected
    assert score["run"]["transport"] == f"socketcan:{_ALL[name].channel}"


def test_the_bus_is_said_by_the_one_who_gives_it(name, left):
    giver = "bus" if "bus" in _ALL[name].services else "adapter"
    (line,) = (line for line in left.out.splitlines() if line.startswith(giver) and "|" in line)
    assert f"| {giver}: socketcan:{_ALL[name].channel} " in line


def test_only_the_service_that_makes_the_interface_has_a_capability(name, left):
    case = _ALL[name]
    assert set(left.containers) == case.services
    left.assert_confined(case.capabilities)
    shared = f"container:{left.containers['bus']['Id']}" if "bus" in case.services else "host"
    assert left.network_modes() == {"none", shared}
    outside = {service for service, entry in left.containers.items() if entry["HostConfig"]["NetworkMode"] == "none"}
    assert outside == ({"bus"} if "bus" in case.services else {"results"})


def test_realtime_limits_reach_the_nodes(name):
    """Below them any process may have SCHED_FIFO and locked memory, without a capability."""
    rows = (_FOLDER / name / "limits").read_text().splitlines()
    soft = {row[:26].strip(): row[26:].split()[0] for row in rows}
    priority = _ALL[name].realtime_priority
    assert soft["Max realtime priority"] == str(priority)
    assert (soft["Max locked memory"] == "unlimited") == bool(priority)


def test_controller_outside_the_containers_served_the_run_to_its_end():
    assert (_FOLDER / "controller_exit_code").read_text().strip() == "0"
    assert (_FOLDER / "controller.txt").read_text().startswith("controller: socketcan:can0 ")


def test_interface_that_is_down_is_one_line_with_the_commands():
    (line,) = (_FOLDER / "down").read_text().splitlines()
    assert line.startswith("can1: the interface is down ")
    assert "ip link set can1 type can bitrate 500000" in line
    assert "ip link set can1 txqueuelen 1000 up" in line


def test_nothing_is_left_behind():
    before, after = ((_FOLDER / name).read_text().splitlines() for name in ("before", "after"))
    assert after == before
    assert {"can0", "can1"} <= set(after)
