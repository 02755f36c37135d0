"""Fixtures of the tests on kernel SocketCAN: a short run, its reference bytes, can-utils, and a check of the bus after
every test."""

from __future__ import annotations

import dataclasses
import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from railhil.bench import Result, local_run
from railhil.scenarios.run_spec import RunSpec
from railhil.systems.ato.scenario.model import Scenario, TargetCurve
from railhil.systems.ato.scenario.target import Target
from railhil.testing.result import disturbed

_TOOLS = ("candump", "cansend", "cangen", "canplayer", "ip")
#: A hop of 8.5 s and 12 m. Short, because the machine is slow; the train departs, coasts and stops.
_HOP = TargetCurve(((0.0, 0.0), (1.0, 0.8), (3.0, 0.8), (4.0, 0.0), (5.0, 0.0), (6.0, -0.8)))


@pytest.fixture(scope="session")
def hop(lvshun: Scenario) -> Scenario:
    """The hop with the published train, which cannot stop accurately after so short a distance."""
    target = Target(_HOP)
    plan = dataclasses.replace(
        lvshun.plan, distance_m=target.stop_position_m, running_time_s=target.stop_time_s, stop_error_max_m=5.0
    )
    return dataclasses.replace(lvshun, target=_HOP, plan=plan)


@pytest.fixture(scope="session")
def hop_reference(hop: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Result:
    """The hop with seed 1, without a bus: log, hash and notches that every transport must give."""
    return local_run(hop, tmp_path_factory.mktemp("hop"), RunSpec(seed=1))


@pytest.fixture(scope="session")
def hop_export(hop: Scenario, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """IPFC for the hop as C."""
    # Not before: half of these tests have no use for what it loads.
    from hil_tests.support.foreign import export_node

    folder = tmp_path_factory.mktemp("export")
    export_node(hop, folder)
    return folder


@pytest.fixture(scope="session")
def can_utils() -> None:
    """Skip without can-utils; if nothing may be skipped, their absence fails the test."""
    missing = [name for name in _TOOLS if shutil.which(name) is None]
    if missing and not os.environ.get("RAILHIL_REQUIRE_ALL"):
        pytest.skip(f"MISSING CAPABILITY {', '.join(missing)} (make test-vcan installs them as root)")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Run folder."""
    path = tmp_path / "run"
    path.mkdir()
    return path


@pytest.fixture(autouse=True)
def healthy(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[None]:
    """After every test except those of such faults: no node has lost, refused or repeated anything."""
    yield
    if request.node.get_closest_marker("faults") is None:
        for file in sorted(tmp_path.rglob("*_counters.json")):
            assert disturbed(json.loads(file.read_text())) == {}, file.name
