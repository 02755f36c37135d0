"""Run a command with a Docker engine: ``python -m hil_tests.machines.docker_engine -- COMMAND ...``

A running engine is used unchanged. Otherwise, as root on Debian, a private one is started: its own sockets, process id
file and cgroup below one temporary folder, no bridge, no packet filter rules; afterwards its processes, containers,
volumes, mounts and files are removed. Its image layers stay in the cache folder, so that the next build takes seconds.
It can reach no image registry: the Dockerfile's base image is made from Debian packages and loaded under its own
name.

The environment of COMMAND contains ``DOCKER_HOST``; ``RAILHIL_BUILD_NETWORK`` (``host`` for the private engine,
which has no bridge to build on); ``RAILHIL_COMPOSE``, the words of the compose command.

Exit code: the command's own; 77 when this host cannot have an engine (one line says why); 124 after
``--timeout``; 125 when the engine itself failed; 2 for a wrong command line.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from hil_tests.machines.base_image import HOST, base_name, provide_base_image
from railhil.machines import debian

_PURPOSE = "a Docker engine"
_PACKAGES = {"dockerd": "docker.io", "docker": "docker.io", "containerd": "containerd", "ctr": "containerd"}
#: Name of the private engine's data, in the cache folder; those for another processor are in a folder beside it.
DATA_FOLDER = "docker_data"
_DOCKERFILE = Path(__file__).parents[2] / "Dockerfile"
#: Start time limit of each of its two processes: in an emulated machine they take ten times the 2 s of real hardware,
#: and longer when the host is busy.
_START_S = 180.0
#: Configuration of containerd: without Kubernetes, and without unused file systems.
_CONTAINERD_CONFIG = """version = 2
disabled_plugins = ["io.containerd.grpc.v1.cri", "io.containerd.snapshotter.v1.btrfs",
    "io.containerd.snapshotter.v1.zfs", "io.containerd.snapshotter.v1.devmapper", "io.containerd.snapshotter.v1.aufs"]
"""
_STOP_S = 30.0
#: Number of unnamed images to keep: the newest are build stages, which the next build reuses; the others are garbage.
_STAGES_KEPT = 2


def _works(words: Sequence[str], environment: dict[str, str]) -> bool:
    """Whether a command can be run and ends with exit code 0."""
    try:
        done = subprocess.run(
            words, env={**os.environ, **environment}, stdin=subprocess.DEVNULL, capture_output=True, timeout=30,
            check=False,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


def engine_answers() -> bool:
    """Whether there is a running engine at this user's Docker settings."""
    return _works(["docker", "version"], {})


def compose_words() -> str:
    """The compose command of this host (version 2, else version 1, else Debian's package is installed).

    Raises:
        CapabilityError: there is none and none can be installed.
    """
    if _works(["docker", "compose", "version"], {}):
        return "docker compose"
    if debian.find_command("docker-compose") is None:
        debian.require_debian_root("docker-compose")
        debian.install_commands({"docker-compose": "docker-compose"}, _PURPOSE)
    return "docker-compose"


@contextmanager
def docker_engine(*, base_image: bool = True, architecture: str = HOST) -> Iterator[dict[str, str]]:
    """Environment variables for an engine that can build the project's Dockerfile.

    Args:
        base_image: False if nothing is built because the images already exist.
        architecture: processor of the base image, by Debian's name; this kernel must be able to start its programs.

    Raises:
        CapabilityError: no engine is running and this host cannot start one.
        MachineError: the private engine does not start, stop or accept the base image.
    """
    if engine_answers():
        words = ["docker", "context", "inspect", "--format", "{{.Endpoints.docker.Host}}"]
        host = os.environ.get("DOCKER_HOST") or debian.run_tool(words).strip()
        yield {"DOCKER_HOST": host, "RAILHIL_BUILD_NETWORK": "default", "RAILHIL_COMPOSE": compose_words()}
        return
    debian.require_debian_root(_PURPOSE)
    debian.install_commands(_PACKAGES, _PURPOSE)
    compose = compose_words()
    folder = DATA_FOLDER if architecture == HOST else f"{DATA_FOLDER}_{architecture}"
    data = debian.cache_dir() / folder
    home = Path(tempfile.mkdtemp(prefix="railhil-docker-", dir="/var/tmp"))
    try:
        with debian.cache_lock(folder), _private_engine(home, data) as host:
            found = {"DOCKER_HOST": host, "RAILHIL_BUILD_NETWORK": "host", "RAILHIL_COMPOSE": compose}
            if base_image:
                provide_base_image(base_name(_DOCKERFILE), found, architecture)
            yield found
    finally:
        _unmount_below(data)
        _unmount_below(home)
        _remove_cgroups(home.name)
        shutil.rmtree(home)


@contextmanager
def _private_engine(home: Path, data: Path) -> Iterator[str]:
    """Start an engine that keeps images below ``data`` and everything else below ``home``; yields its address, then
    stops it."""
    host = f"unix://{home}/docker.sock"
    address = f"{home}/containerd.sock"
    # By default dockerd gives containerd 15 s to start, which is too short on a busy emulated machine.
    runtime = ["containerd", "--root", f"{data}/containerd/daemon", "--state", f"{home}/containerd"]
    runtime += ["--address", address, "--config", f"{home}/containerd.toml"]
    engine = ["dockerd", "--data-root", str(data), "--exec-root", f"{home}/exec", "--containerd", address]
    engine += ["--pidfile", f"{home}/pid", "--host", host, "--config-file", f"{home}/daemon.json"]
    engine += ["--bridge", "none", "--iptables=false", "--ip6tables=false", "--ip-forward=false"]
    engine += ["--exec-opt", "native.cgroupdriver=cgroupfs", "--cgroup-parent", f"/{home.name}"]
    (home / "containerd.toml").write_text(_CONTAINERD_CONFIG)
    (home / "daemon.json").write_text("{}\n")
    with (
        _service(runtime, home, ["ctr", "--address", address, "version"], {}),
        _service(engine, home, ["docker", "version"], {"DOCKER_HOST": host}),
    ):
        try:
            yield host
        finally:
            _clear(host)


@contextmanager
def _service(words: list[str], home: Path, answers: list[str], environment: dict[str, str]) -> Iterator[None]:
    """A process that is ready when the command ``answers`` succeeds, and is stopped at the end."""
    # setpriv: the engine must not outlive this process, even if this process is killed.
    command = ["setpriv", "--pdeathsig", "TERM", *words]
    with (home / f"{words[0]}.log").open("wb") as log:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True)
    try:
        deadline_s = time.monotonic() + _START_S
        while not _works(answers, environment):
            if process.poll() is not None or time.monotonic() > deadline_s:
                lines = (home / f"{words[0]}.log").read_text(errors="replace").splitlines() or ["no output"]
                raise debian.MachineError(f"{words[0]} does not start: {lines[-1]}")
            time.sleep(0.2)
        yield
    finally:
        process.terminate()
        try:
            process.wait(_STOP_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _clear(host: str) -> None:
    """Remove containers, volumes and old layers, so that no process of a container outlives its engine."""

    def docker(*words: str) -> list[str]:
        done = subprocess.run(
            ["docker", *words], env={**os.environ, "DOCKER_HOST": host}, stdin=subprocess.DEVNULL,
            capture_output=True, text=True, timeout=120, check=False,
        )  # fmt: skip
        return done.stdout.split()

    if containers := docker("ps", "-aq"):
        docker("rm", "-f", *containers)
    docker("volume", "prune", "-f")
    if stages := docker("images", "-q", "--filter", "dangling=true")[_STAGES_KEPT:]:
        docker("rmi", *stages)


def _unmount_below(folder: Path) -> None:
    """Unmount what a killed engine leaves mounted below a folder, the deepest first."""
    points = [line.split()[1] for line in Path("/proc/mounts").read_text().splitlines()]
    for point in reversed(points):
        if point.startswith(f"{folder}/"):
            debian.run_tool(["umount", "-l", point])


def _remove_cgroups(name: str) -> None:
    """Remove the engine's cgroup from each hierarchy; a cgroup is just empty directories."""
    for group in sorted(Path("/sys/fs/cgroup").glob(f"**/{name}/**/"), reverse=True):
        if group.is_dir():
            group.rmdir()


def run(command: Sequence[str], *, timeout_s: float, base_image: bool = True) -> int:
    """Run ``command`` with an engine and return its exit code.

    Raises:
        CapabilityError, MachineError: like :func:`docker_engine`; subprocess.TimeoutExpired: after ``timeout_s``.
    """
    with docker_engine(base_image=base_image) as environment:
        return subprocess.run(command, env={**os.environ, **environment}, timeout=timeout_s, check=False).returncode


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; see the module's docstring for the exit codes."""
    parser = argparse.ArgumentParser(
        prog="python -m hil_tests.machines.docker_engine",
        description="Run a command beside a Docker engine that can build this project's image.",
    )
    parser.add_argument("--timeout", type=float, default=1200.0, metavar="S", help="for the command (default 1200)")
    parser.add_argument(
        "--no-base-image", action="store_true", help="nothing is built: a private engine starts at once"
    )
    parser.add_argument("command", nargs="+", help="command and its arguments, after --")
    options = parser.parse_args(arguments)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    base_image = not options.no_base_image
    return debian.guarded(
        "docker_engine", lambda: run(options.command, timeout_s=options.timeout, base_image=base_image)
    )


if __name__ == "__main__":
    sys.exit(main())
