"""`docker compose up` on a fresh copy of the project: verdict, results, privileges, and nothing left behind."""

from __future__ import annotations

import json
import os
import re
import shutil
import socket
import time
import tomllib
import urllib.request
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any

import pytest
from websockets.sync.client import ClientConnection, connect

from hil_tests.support.paths import ROOT
from hil_tests.transport.compose.engine import (
    PROJECT,
    SERVICES,
    Up,
    compose,
    containers,
    docker,
    tool,
    traces_on_host,
    up,
)
from railhil.bench import local_run
from railhil.cli.panel import EMERGENCY
from railhil.panel.wire import SUBPROTOCOL
from railhil.record.framelog import sha256_of
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec

pytestmark = [pytest.mark.needs_docker, pytest.mark.timeout(900)]

_NEEDED = ("dbc", "bus", "plant_sim", "controller_node", "railhil", "docker")
_FILES = ("Dockerfile", ".dockerignore", "docker-compose.yml", "docker-compose.hardware.yml", "pyproject.toml",
          "setup.py", "README.md", "LICENSE")  # fmt: skip
_SEED = 3
#: The image is Debian with Python (120 MB), and NumPy, SciPy, Matplotlib and the bench: 415 MB. The batch's numba
#: (LLVM) and Arrow would be 350 MB more, a compiler 200 MB.
_IMAGE_MAX_BYTES = 450_000_000


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Iterator[Path]:
    """A fresh copy of the project, as after a clone: without ``./runs``; its image is built."""
    folder = tmp_path_factory.mktemp("compose") / "project"
    for name in _NEEDED:
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in _FILES:
        shutil.copy(ROOT / name, folder / name)
    (folder / "scenarios").mkdir()
    built = compose(folder, "build")
    assert built.returncode == 0, built.stdout[-2000:] + built.stderr[-2000:]
    before = traces_on_host()
    yield folder
    assert traces_on_host() == before
    assert containers() == []
    assert PROJECT not in docker("volume", "ls", "-q")
    assert PROJECT not in docker("network", "ls", "--format", "{{.Name}}")


@pytest.fixture(scope="module")
def bench(project) -> Up:
    """The bench, run with the defaults but for the seed."""
    owner = {} if os.getuid() == 0 else {"RAILHIL_UID": str(os.getuid()), "RAILHIL_GID": str(os.getgid())}
    return up(project, SEED=str(_SEED), **owner)


def test_exit_code_is_the_verdict(bench):
    verdict = json.loads((bench.run_folder / "score.json").read_text())["verdict"]
    assert bench.exit_code == {"PASS": 0, "FAIL": 1}[verdict], bench.out
    assert bench.containers["supervisor"]["State"]["ExitCode"] == bench.exit_code


def test_results_are_those_of_the_bench_without_containers(bench, tmp_path):
    names = {path.name for path in bench.run_folder.iterdir()}
    expected_names = {"frames.log", "frames.blf", "signals.csv", "score.json", "certificate.json", "junit.xml"}
    assert expected_names | {"report.html"} <= names
    expected = local_run(load("lvshun_tieshan"), tmp_path, RunSpec(seed=_SEED)).frames_sha256
    assert sha256_of(bench.run_folder / "frames.log") == expected
    certificate = json.loads((bench.run_folder / "certificate.json").read_text())
    assert certificate["frames_sha256"] == expected
    assert f"SEED={_SEED} PACE=lockstep" in certificate["command"]
    assert certificate["command"].endswith("docker compose up --exit-code-from supervisor")


def test_bus_says_which_transport_it_is(bench):
    transport = json.loads((bench.run_folder / "score.json").read_text())["run"]["transport"]
    (line,) = (line for line in bench.out.splitlines() if " bus: " in line and "supervisor" not in line)
    assert transport in line
    assert ("no vcan0: " in line) == (transport == "railhil:/bus/hub.sock")


def test_privileges(bench):
    assert set(bench.containers) == SERVICES
    bench.assert_confined({"bus": ["NET_ADMIN"]})
    assert bench.network_modes() == {"none", f"container:{bench.containers['bus']['Id']}"}


def test_image_is_small_and_has_no_build_tools(bench):
    (image,) = json.loads(docker("image", "inspect", "railhil-bench"))
    assert image["Size"] < _IMAGE_MAX_BYTES
    assert image["Config"]["User"] == "1000:1000"
    look = "for tool in cc gcc g++ make pip pip3 git; do command -v $tool; done; true"
    assert docker("run", "--rm", "--network", "none", "--entrypoint", "sh", "railhil-bench", "-c", look) == ""


def test_image_has_what_a_run_its_report_and_its_panel_need(bench):
    """The batch is not for containers; ``--build-arg EXTRAS`` adds it."""
    names = ("numpy", "scipy", "jinja2", "websockets", "llvmlite", "numba", "pyarrow", "dask", "pip", "setuptools")
    look = "import importlib.util as u, sys; print(*(name for name in sys.argv[1:] if u.find_spec(name)))"
    words = ["run", "--rm", "--network", "none", "--entrypoint", "python3", "railhil-bench", "-c", look, *names]
    assert docker(*words).split() == ["numpy", "scipy", "jinja2", "websockets"]


def test_image_does_not_call_itself_a_release_unless_it_is_told(bench):
    """Its build sees no repository."""
    certificate = json.loads((bench.run_folder / "certificate.json").read_text())
    base = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert certificate["railhil"] == f"{base}+unknown"


def test_realtime_run_keeps_its_pace_and_says_what_it_was_granted(project):
    shutil.copy(Path(__file__).with_name("short_move.toml"), project / "scenarios")
    earlier = {path.name for path in (project / "runs").iterdir()} if (project / "runs").exists() else set()
    done = up(project, SCENARIO="/scenarios/short_move.toml", PACE="realtime", RATE="8")
    # Invalid when this machine was too busy to keep the time, which is what the verdict is for.
    assert done.exit_code in (0, 3), done.out
    for node in ("plant", "controller"):
        assert len([line for line in done.out.splitlines() if f"{node}: scheduling: " in line]) == 1, done.out
    (folder,) = (path for path in (project / "runs").iterdir() if path.name not in earlier)
    run = json.loads((folder / "score.json").read_text())["run"]
    # Never faster; slower is a matter of the machine.
    assert run["speed_factor"] < 8.2
    assert (folder / "wall.csv").is_file()


@pytest.mark.skipif(os.getuid() != 0, reason="MISSING CAPABILITY root: to give ./runs to another user")
def test_another_user_than_before_needs_nothing_taken_away(project):
    """Only ``./runs`` has to belong to the new one, which a line says."""
    shutil.copy(Path(__file__).with_name("short_move.toml"), project / "scenarios")
    short = {"SCENARIO": "/scenarios/short_move.toml"}
    runs = project / "runs"
    first = up(project, volumes=True, **short)
    owner, group = runs.stat().st_uid, runs.stat().st_gid
    os.chown(runs, 1234, 1234)
    try:
        second = up(project, **short, RAILHIL_UID="1234", RAILHIL_GID="1234")
    finally:
        os.chown(runs, owner, group)
    assert (first.exit_code, second.exit_code) == (0, 0), first.out + second.out


def test_the_page_starts_the_run_through_the_published_port(project, tmp_path):
    """The bytes are those of a run with the prepared fault; the port is the one way in, on loopback only."""
    shutil.copy(Path(__file__).with_name("short_move.toml"), project / "scenarios")
    earlier = {path.name for path in (project / "runs").iterdir()}
    given = {"COMPOSE_PROFILES": "panel", "SCENARIO": "/scenarios/short_move.toml", "WAIT": "1"}
    given |= {"PANEL_PORT": str(_free_port())}
    with ThreadPoolExecutor(1) as beside:
        running = beside.submit(up, project, **given)
        try:
            page, token = _address_in_logs(running).split("#token=")
            assert page == f"http://127.0.0.1:{given['PANEL_PORT']}/"
            with urllib.request.urlopen(page, timeout=20) as answer:
                assert answer.headers["Content-Security-Policy"].startswith("default-src 'self'; ")
            with connect(f"ws{page[4:]}ws", origin=page[:-1], subprotocols=[SUBPROTOCOL]) as connection:
                _press_start(connection, token)
                wait([running], 120)
        finally:
            if not running.done():
                # Else it would wait for Start.
                docker("kill", *containers())
        done = running.result()
    assert done.exit_code == 0, done.out
    (folder,) = (path for path in (project / "runs").iterdir() if path.name not in earlier)
    scenario = load(Path(__file__).with_name("short_move.toml"), (), (EMERGENCY,))
    assert sha256_of(folder / "frames.log") == local_run(scenario, tmp_path, RunSpec()).frames_sha256
    assert done.containers["door"]["HostConfig"]["PortBindings"]["8765/tcp"][0]["HostIp"] == "127.0.0.1"


def _press_start(connection: ClientConnection, token: str) -> None:
    """Press it until it is passed on: the page may be there before the supervisor."""
    for _ in range(60):
        connection.send(json.dumps({"do": "start", "token": token}))
        answer: dict[str, Any] = {}
        while not answer.keys() & {"done", "refused"}:
            text = connection.recv(timeout=20)
            # The others are curves.
            answer = json.loads(text) if isinstance(text, str) else {}
        if "done" in answer:
            return
        time.sleep(0.5)
    raise AssertionError(answer)


def _free_port() -> int:
    """A port of loopback on which nobody listens."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


def _address_in_logs(running: Future[Up]) -> str:
    """The address that the panel prints, as soon as it does."""
    for _ in range(300):
        named = docker("ps", "-q", "--filter", f"label=com.docker.compose.project={PROJECT}",
                       "--filter", "label=com.docker.compose.service=panel").split()  # fmt: skip
        said = tool("docker", "logs", named[0]) if named else None
        found = re.search(r"http://\S+#token=\S+", said.stderr + said.stdout) if said else None
        if found:
            return found.group()
        assert not running.done(), running.result().out
        time.sleep(0.2)
    raise AssertionError("the panel prints no address")


def told(done: Up, *words: str) -> str:
    """The one line in which the supervisor names ``words``."""
    assert done.exit_code == 2, done.out
    assert "Traceback" not in done.out
    lines = [line for line in done.out.splitlines() if "supervisor" in line and all(word in line for word in words)]
    assert len(lines) == 1, done.out
    return lines[0]


def test_unknown_scenario_is_one_clear_line_and_exit_code_2(project):
    told(up(project, SCENARIO="no_such_line"), "no_such_line")


@pytest.mark.parametrize(
    ("channel", "words"),
    [
        ("can_none", ("no such interface", "ip link set can_none type can bitrate 500000", "txqueuelen 1000 up")),
        ("lo", ("is no CAN interface", "CAN_CHANNEL")),
    ],
)
def test_interface_of_the_host_that_cannot_be_the_bus_is_one_clear_line(project, channel, words):
    done = up(project, "docker-compose.hardware.yml", CAN_CHANNEL=channel)
    told(done, channel, *words)
    assert len([line for line in done.out.splitlines() if channel in line]) == 1, done.out
    assert set(done.containers) == SERVICES - {"bus"} | {"adapter"}
    done.assert_confined({})
