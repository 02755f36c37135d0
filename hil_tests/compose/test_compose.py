"""`docker compose up` on a fresh copy of the project: verdict, results, privileges, and nothing left behind."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from hil_tests.bench import local_run
from scenarios.load import load
from supervisor.framelog import sha256_of

pytestmark = [pytest.mark.needs_docker, pytest.mark.timeout(900)]

_ROOT = Path(__file__).parents[2]
_NEEDED = ("dbc", "bus", "scenarios", "plant_sim", "controller_node", "supervisor", "docker")
_FILES = ("Dockerfile", ".dockerignore", "docker-compose.yml", "pyproject.toml", "README.md", "LICENSE")
_SERVICES = {"bus", "results", "plant", "controller", "supervisor"}
_PROJECT = "railhil-test"
_SEED = 3
#: The image is Python, NumPy, SciPy and Matplotlib without their tests; a compiler alone would be 200 MB more.
_IMAGE_MAX_BYTES = 480_000_000


@dataclass(frozen=True, slots=True)
class Up:
    """A finished ``compose up``: where, its exit code, its output, and what the engine says of each container."""

    folder: Path
    exit_code: int
    out: str
    containers: dict[str, dict[str, Any]]

    @property
    def run_folder(self) -> Path:
        """The one run folder in ``./runs``."""
        (folder,) = (self.folder / "runs").iterdir()
        return folder


def tool(*words: str, cwd: Path | None = None, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a command to its end."""
    return subprocess.run(
        words, cwd=cwd, env={**os.environ, **variables}, capture_output=True, text=True, timeout=840, check=False
    )


def docker(*words: str) -> str:
    """Standard output of a docker command that must succeed."""
    done = tool("docker", *words)
    assert done.returncode == 0, done.stderr
    return done.stdout


def compose(folder: Path, *words: str, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a compose command in a copy of the project."""
    command = os.environ.get("RAILHIL_COMPOSE", "docker compose").split()
    return tool(*command, "-p", _PROJECT, *words, cwd=folder, **variables)


def up(folder: Path, **variables: str) -> Up:
    """Run the bench to its end and look at the containers before they are removed."""
    done = compose(folder, "up", "--no-color", "--exit-code-from", "supervisor", **variables)
    names = docker("ps", "-aq", "--filter", f"label=com.docker.compose.project={_PROJECT}").split()
    found = json.loads(docker("inspect", *names)) if names else []
    containers = {entry["Config"]["Labels"]["com.docker.compose.service"]: entry for entry in found}
    down = compose(folder, "down", "--volumes")
    assert down.returncode == 0, down.stderr
    return Up(folder, done.returncode, done.stdout + done.stderr, containers)


def traces_on_host() -> set[str]:
    """What a container leaves on a host when it leaves something: interfaces, and mounts of its volume."""
    mounts = {line.split()[1] for line in Path("/proc/mounts").read_text().splitlines() if _PROJECT in line}
    return mounts | set(os.listdir("/sys/class/net"))


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Iterator[Path]:
    """A fresh copy of the project, as after a clone: without ``./runs``; its image is built."""
    folder = tmp_path_factory.mktemp("compose") / "project"
    for name in _NEEDED:
        shutil.copytree(_ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in _FILES:
        shutil.copy(_ROOT / name, folder / name)
    built = compose(folder, "build")
    assert built.returncode == 0, built.stdout[-2000:] + built.stderr[-2000:]
    before = traces_on_host()
    yield folder
    assert traces_on_host() == before
    assert docker("ps", "-aq", "--filter", f"label=com.docker.compose.project={_PROJECT}") == ""
    assert _PROJECT not in docker("volume", "ls", "-q")
    assert _PROJECT not in docker("network", "ls", "--format", "{{.Name}}")


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
    assert {"frames.log", "frames.blf", "signals.csv", "score.json", "certificate.json", "junit.xml"} <= names
    expected = local_run(load("lvshun_tieshan"), tmp_path, seed=_SEED).frames_sha256
    assert sha256_of(bench.run_folder / "frames.log") == expected
    assert json.loads((bench.run_folder / "certificate.json").read_text())["frames_sha256"] == expected


def test_bus_says_which_transport_it_is(bench):
    transport = json.loads((bench.run_folder / "score.json").read_text())["run"]["transport"]
    (line,) = (line for line in bench.out.splitlines() if " bus: " in line and "supervisor" not in line)
    assert transport in line
    assert ("no vcan0: " in line) == (transport == "railhil:/bus/hub.sock")


def test_privileges(bench):
    assert set(bench.containers) == _SERVICES
    for service, entry in bench.containers.items():
        host = entry["HostConfig"]
        assert host["ReadonlyRootfs"] is True, service
        assert host["CapDrop"] == ["ALL"], service
        assert (host["CapAdd"] or []) == (["NET_ADMIN"] if service == "bus" else []), service
        assert not host["Privileged"], service
        assert entry["Config"]["User"].split(":")[0] != "0" or service == "results"
        bus_id = bench.containers["bus"]["Id"]
        assert host["NetworkMode"] == ("none" if service == "bus" else f"container:{bus_id}"), service
        assert not host["PortBindings"], service


def test_image_is_small_and_has_no_build_tools(bench):
    (image,) = json.loads(docker("image", "inspect", "railhil-bench"))
    assert image["Size"] < _IMAGE_MAX_BYTES
    assert image["Config"]["User"] == "1000:1000"
    look = "for tool in cc gcc g++ make pip pip3 git; do command -v $tool; done; true"
    assert docker("run", "--rm", "--network", "none", "--entrypoint", "sh", "railhil-bench", "-c", look) == ""


def test_unknown_scenario_is_one_clear_line_and_exit_code_2(project):
    done = up(project, SCENARIO="no_such_line")
    assert done.exit_code == 2, done.out
    assert "Traceback" not in done.out
    lines = [line for line in done.out.splitlines() if "supervisor" in line and "no_such_line" in line]
    assert len(lines) == 1, done.out
