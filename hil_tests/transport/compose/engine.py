"""`docker compose up` for tests, and what there is to see of it afterwards."""

from __future__ import annotations

import json
import os
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

#: Services of docker-compose.yml.
SERVICES = {"bus", "results", "plant", "controller", "supervisor"}
#: Of the containers, volumes and networks that these tests make.
PROJECT = "railhil-test"
_SERVICE_LABEL = "com.docker.compose.service"


@dataclass(frozen=True, slots=True)
class Up:
    """A finished ``compose up``: where its runs are, exit code, output, and what the engine says of each container."""

    runs: Path
    exit_code: int
    out: str
    containers: dict[str, dict[str, Any]]

    @classmethod
    def of(cls, runs: Path, exit_code: int, out: str, inspected: list[dict[str, Any]]) -> Up:
        """From the words of ``docker inspect``."""
        return cls(runs, exit_code, out, {entry["Config"]["Labels"][_SERVICE_LABEL]: entry for entry in inspected})

    @classmethod
    def read(cls, folder: Path, exit_code: int, out: str) -> Up:
        """From a folder with ``containers.json`` and the run folder."""
        return cls.of(folder, exit_code, out, json.loads((folder / "containers.json").read_text()))

    @property
    def run_folder(self) -> Path:
        """The one run folder."""
        (folder,) = (path for path in self.runs.iterdir() if path.is_dir())
        return folder

    def network_modes(self) -> set[str]:
        """Network modes of all containers."""
        return {entry["HostConfig"]["NetworkMode"] for entry in self.containers.values()}

    def assert_confined(self, capabilities: dict[str, list[str]]) -> None:
        """Read-only, nobody's root, and no capability but those of ``capabilities`` (service -> names)."""
        for service, entry in self.containers.items():
            host = entry["HostConfig"]
            assert host["ReadonlyRootfs"] is True, service
            assert host["CapDrop"] == ["ALL"], service
            assert (host["CapAdd"] or []) == capabilities.get(service, []), service
            assert not host["Privileged"], service
            assert entry["Config"]["User"].split(":")[0] != "0" or service == "results"
            assert not host["PortBindings"], service
            assert "no-new-privileges:true" in (host["SecurityOpt"] or []) or service in capabilities, service


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
    return tool(*command, "-p", PROJECT, *words, cwd=folder, **variables)


def containers() -> list[str]:
    """Identifiers of the project's containers, running or not."""
    return docker("ps", "-aq", "--filter", f"label=com.docker.compose.project={PROJECT}").split()


def up(folder: Path, *overrides: str, volumes: bool = False, **variables: str) -> Up:
    """Run the bench to its end and look at the containers before they are removed.

    :param overrides: compose files on top of docker-compose.yml.
    :param volumes: leave the volume for a next ``up``.
    """
    files = [word for name in ("docker-compose.yml", *overrides) for word in ("-f", name)]
    done = compose(folder, *files, "up", "--no-color", "--exit-code-from", "supervisor", **variables)
    names = containers()
    found = json.loads(docker("inspect", *names)) if names else []
    # What `up` shows of a short container may lack lines; the engine has them all.
    said = compose(folder, *files, "logs", "--no-color").stdout if names else done.stdout
    down = compose(folder, *files, "down", *([] if volumes else ["--volumes"]))
    assert down.returncode == 0, down.stderr
    return Up.of(folder / "runs", done.returncode, said + done.stderr, found)


def traces_on_host() -> set[str]:
    """What a container leaves on a host when it leaves something: interfaces, and mounts of its volume."""
    mounts = {line.split()[1] for line in Path("/proc/mounts").read_text().splitlines() if PROJECT in line}
    return mounts | set(os.listdir("/sys/class/net"))
