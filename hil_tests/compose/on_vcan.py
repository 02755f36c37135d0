"""What the containers have left that ran on a kernel with CAN: the same bytes, and nothing else.

Tests, but not found by pytest: :mod:`hil_tests.compose.vcan_runs` names them, after it has made what they look at.
"""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from hil_tests.bench import local_run
from hil_tests.compose.engine import SERVICES, Up
from hil_tests.compose.vcan_runs import FOLDER_VARIABLE
from scenarios.load import load
from supervisor.framelog import sha256_of

_SHORT = Path(__file__).with_name("short_move.toml")
_HARDWARE = SERVICES - {"bus"} | {"adapter"}
#: docker-compose.yml's own seed.
_SEED = 1
_FOLDER = Path(os.environ[FOLDER_VARIABLE])


def left(case: str) -> Up:
    """What one case left behind."""
    folder = _FOLDER / case
    return Up.read(folder, int((folder / "exit_code").read_text()), (folder / "out").read_text())


def said(case: str, service: str) -> list[str]:
    """Lines of one service, without compose's prefix."""
    lines = [line.partition("|") for line in left(case).out.splitlines()]
    return [text.strip() for prefix, _, text in lines if prefix.strip().startswith(service)]


@pytest.mark.parametrize(
    ("case", "scenario", "channel"),
    [("vcan", "lvshun_tieshan", "vcan0"), ("hardware", str(_SHORT), "can0"), ("foreign", str(_SHORT), "can0")],
)
def test_run_gives_the_bytes_of_the_bench_without_containers(case, scenario, channel, tmp_path):
    run = left(case)
    assert run.exit_code == 0, run.out
    expected = local_run(load(scenario), tmp_path, seed=_SEED).frames_sha256
    assert sha256_of(run.run_folder / "frames.log") == expected
    certificate = json.loads((run.run_folder / "certificate.json").read_text())
    assert certificate["frames_sha256"] == expected
    assert json.loads((run.run_folder / "score.json").read_text())["run"]["transport"] == f"socketcan:{channel}"


def test_the_bus_is_said_once_by_the_one_who_gives_it():
    (line,) = (line for line in said("vcan", "bus_") if line.startswith("bus: "))
    assert line.startswith("bus: socketcan:vcan0 ")
    for case in ("hardware", "foreign"):
        (line,) = said(case, "adapter_")
        assert line.startswith("adapter: socketcan:can0 ")


def test_only_the_service_that_makes_the_interface_has_a_capability():
    run = left("vcan")
    assert set(run.containers) == SERVICES
    run.assert_confined({"bus": ["NET_ADMIN"]})
    assert run.network_modes() == {"none"} | {f"container:{run.containers['bus']['Id']}"}


@pytest.mark.parametrize(("case", "missing"), [("hardware", set()), ("foreign", {"controller"})])
def test_no_container_on_the_hosts_interface_has_a_capability(case, missing):
    run = left(case)
    assert set(run.containers) == _HARDWARE - missing
    run.assert_confined({})
    assert run.network_modes() == {"none", "host"}
    assert run.containers["results"]["HostConfig"]["NetworkMode"] == "none"


def test_controller_outside_the_containers_served_the_run_to_its_end():
    assert (_FOLDER / "foreign_exit_code").read_text().strip() == "0"
    assert (_FOLDER / "foreign.txt").read_text().startswith("controller: socketcan:can0 ")


def test_interface_that_is_down_is_one_line_with_the_commands():
    (line,) = (_FOLDER / "down").read_text().splitlines()
    assert line.startswith("can1: the interface is down ")
    assert "ip link set can1 type can bitrate 500000" in line
    assert "ip link set can1 txqueuelen 1000 up" in line


def limits(case: str) -> dict[str, str]:
    """Soft resource limits of the plant's process (columns of /proc/PID/limits)."""
    rows = (_FOLDER / case / "limits").read_text().splitlines()
    return {row[:26].strip(): row[26:].split()[0] for row in rows}


def test_realtime_limits_reach_the_nodes():
    """Below them any process may have SCHED_FIFO and locked memory, without a capability."""
    assert limits("hardware")["Max realtime priority"] == "45"
    assert limits("hardware")["Max locked memory"] == "unlimited"
    assert limits("vcan")["Max realtime priority"] == "0"


def test_nothing_is_left_behind():
    before, after = ((_FOLDER / name).read_text().splitlines() for name in ("before", "after"))
    assert after == before
    assert {"can0", "can1", "vcan0"} <= set(after)
