"""Faults on every transport: the bytes of the run in one process; without its controller the train stops by itself."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil_tests.support.adapter_rig import Rig
from hil_tests.support.cli import railhil
from hil_tests.support.fault_runs import (
    BRAKED,
    FAST_TOML,
    KILLED,
    Made,
    assert_stopped_by_its_own_watch,
    fast,
    levels,
)
from hil_tests.support.hub import running_hub, socket_folder, two_hubs_and_a_gateway
from hil_tests.transport.vcan.bench import run_on
from railhil.bench import local_run
from railhil.dbc import wire_contract
from railhil.record.framelog import read_log
from railhil.record.trace import trace_of

pytestmark = [pytest.mark.loop, pytest.mark.faults, pytest.mark.slow]


def _hub(channel: str) -> dict[str, Any]:
    return {"interface": "railhil", "channel": channel}


@contextmanager
def _tcp() -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    with running_hub(channel="tcp://127.0.0.1:0") as hub:
        yield _hub(hub.channel), _hub(hub.channel)


@contextmanager
def _gateway() -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    with two_hubs_and_a_gateway(options=("--lossless",)) as (a, b, _):
        yield _hub(a.channel), _hub(b.channel)


@contextmanager
def _adapter() -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    with socket_folder() as folder, Rig(folder) as rig:
        yield rig.hub, rig.adapter


#: What a command is given for a bus of its own.
OPTIONS = {"local": ["--bus", "local"], "hub": ["-i", "railhil"], "pipes": []}
#: Buses of plant and controller.
BUSES = {"tcp": _tcp, "gateway": _gateway, "adapter": _adapter}


def by_command(folder: Path, *options: str, faults: tuple[str, ...]) -> Made:
    """``railhil run`` with the scenario's file; the certificate and the log of the faults are in the folder."""
    path = folder / "fast.toml"
    path.write_text(FAST_TOML, encoding="utf-8")
    given = [word for text in faults for word in ("--fault", text)]
    done = railhil("run", path, "--out", folder / "run", "--quiet", "--no-report", *options, *given)
    assert done.exit_code in (1, 3), done.err
    assert "Traceback" not in done.out + done.err
    certificate = json.loads((folder / "run" / "certificate.json").read_text(encoding="utf-8"))
    return Made(folder / "run", done.exit_code, certificate["line"], certificate["frames_sha256"])


@pytest.fixture(scope="module")
def local_sha256(tmp_path_factory: pytest.TempPathFactory) -> Callable[[tuple[str, ...]], str]:
    """Hash of the record of the run in one process, each made once."""
    made: dict[tuple[str, ...], str] = {}

    def sha256(faults: tuple[str, ...]) -> str:
        if faults not in made:
            folder = tmp_path_factory.mktemp("local")
            made[faults] = local_run(fast(folder, *faults), folder).frames_sha256
        return made[faults]

    return sha256


@pytest.mark.long_after(1)
@pytest.mark.parametrize("bus", ["pipes", "local", "hub", *BUSES])
def test_a_train_whose_controller_is_killed_stops_by_itself(bus: str, tmp_path: Path, local_sha256: Any) -> None:
    scenario = fast(tmp_path, *KILLED)
    if bus in BUSES:
        (tmp_path / "run").mkdir()
        with BUSES[bus]() as (config, controller_config):
            result, exit_codes = run_on(config, scenario, tmp_path / "run", seed=0, controller_config=controller_config)
        assert exit_codes[0] == -9
        assert all(one.hits for one in result.faults)
        made = Made.of(tmp_path / "run", result)
    else:
        made = by_command(tmp_path, *OPTIONS[bus], faults=KILLED)
        assert made.exit_code == 1
    assert made.frames_sha256 == local_sha256(KILLED)
    assert_stopped_by_its_own_watch(scenario, made)


@pytest.mark.long_after(1)
@pytest.mark.parametrize("bus", ["hub", "pipes", "adapter"])
def test_a_controller_that_hangs_starts_anew_or_brakes(bus: str, tmp_path: Path, local_sha256: Any) -> None:
    if bus == "adapter":
        (tmp_path / "run").mkdir()
        with _adapter() as (config, controller_config):
            result, exit_codes = run_on(
                config, fast(tmp_path, *BRAKED), tmp_path / "run", seed=0, controller_config=controller_config
            )
        assert exit_codes == [0, 0]
        assert all(one.hits for one in result.faults)
        made = Made.of(tmp_path / "run", result)
    else:
        made = by_command(tmp_path, *OPTIONS[bus], faults=BRAKED)
    assert made.frames_sha256 == local_sha256(BRAKED)
    # Judged by what the train did: what the controller said while it hung was no stranger's.
    assert (made.exit_code, made.line.split(" ")[:2]) == (1, ["stop", "error"])


@pytest.mark.long_after(1)
@pytest.mark.parametrize(
    ("fault", "needs"),
    [
        ("bus off @8s for 300ms", False),
        pytest.param("TRN_SPEED duplicate 50% copies 2 @8s for 1s", False, marks=pytest.mark.long),
        pytest.param("speed wrong 1.1 @8s", False, marks=pytest.mark.long),
        ("bus error_frames 2% @8s for 1s", True),
        pytest.param("bus.a open @8s", True, marks=pytest.mark.long),
    ],
)
def test_only_a_fault_of_the_bus_itself_needs_the_hub(
    fault: str, needs: bool, tmp_path: Path, local_sha256: Callable[[tuple[str, ...]], str]
) -> None:
    made = by_command(tmp_path, faults=(fault,))
    certificate = json.loads((made.folder / "certificate.json").read_text(encoding="utf-8"))
    assert certificate["transport"].endswith("hub.sock" if needs else ":pipes")
    if not needs:
        assert made.frames_sha256 == local_sha256((fault,))


@pytest.mark.wall_clock
def test_in_real_time_the_process_is_stopped_and_killed(tmp_path: Path) -> None:
    """SIGSTOP and SIGCONT, then SIGKILL. At 2 simulated seconds a second 400 ms of the run are 200 ms; 300 ms later the
    train would stand. Polls without an answer end within a period of NOTCH_CMD, so that they do not hold it back. A
    busy machine does, where answers come after more than the 5 ms of a poll, and keeps the train from 60 km/h."""
    scenario = fast(tmp_path, "controller stop @8s for 400ms combine", "controller kill @v>40km/h combine")
    (tmp_path / "run").mkdir()
    with running_hub() as hub:
        result, exit_codes = run_on(_hub(hub.channel), scenario, tmp_path / "run", seed=0, pace="realtime", rate=2.0)
    assert exit_codes[0] == -9
    made = Made.of(tmp_path / "run", result)
    assert_stopped_by_its_own_watch(scenario, made, late_s=0.1, killed_kmh=40.0)
    assert (result.faults[0].hits, result.faults[0].begun_s) == (1, 8.0)
    notch_s = trace_of(read_log(made.folder / "frames.log"), wire_contract()).times_s("NOTCH_CMD")
    stopped_s = notch_s[(notch_s > 7.5) & (notch_s < 12.0)]
    assert np.diff(stopped_s).max() > 0.25, "the process has slept"
    found = levels(scenario, made.folder, "train")
    # 64 ms after the last answer traction is cut, 256 ms after it the train brakes; a late machine may have missed
    # answers before, none can come now.
    levels_now = [(one.level, one.cause) for one in found if one.time_s <= 8.2 < one.until_s]
    assert levels_now in ([("traction_cut", "command_age")], [("service_brake", "command_age")]), found
