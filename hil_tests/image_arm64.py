"""The image for a Raspberry Pi's processor, built and run here: ``python -m hil_tests.image_arm64 [SCENARIO]``

The Dockerfile, as it is, is built with ``--platform linux/arm64``, emulated. A container of
the image makes a run in one process and one in three; this machine makes the same run without containers. Without a
scenario it is a short one. The image is removed; a private engine keeps the layers of the build in its cache.

Exit code: 0 if all frame logs have the same SHA-256, 1 if not; 77 when this host cannot emulate aarch64 or have a
Docker engine (one line says why), 124 after an hour in one step, 125 when one of them failed or the image does not
build.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from hil_tests.machines.binfmt import aarch64_programs
from hil_tests.machines.docker_engine import docker_engine
from hil_tests.support.paths import ROOT
from railhil.bench import local_run
from railhil.machines import debian
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec

_SHORT = ROOT / "hil_tests" / "transport" / "compose" / "short_move.toml"
_PLATFORM = ["--platform", "linux/arm64"]
#: Of the image and of its container.
_IMAGE = "railhil-bench-arm64"
_TIMEOUT_S = 3600.0
#: The runs in the container: in one process, and as `railhil run` makes it by itself.
_RUNS = {"one process": ["--bus", "local"], "three processes": []}
#: PASS, and FAIL: the published run misses its limit with this seed.
_VERDICTS = (0, 1)


def tool(words: list[str], environment: Mapping[str, str], allowed: tuple[int, ...] = (0,)) -> str:
    """Standard output of a docker command.

    Raises:
        MachineError: it ended with another exit code than the ``allowed``; the text has its last lines.
    """
    done = subprocess.run(
        ["docker", *words], env={**os.environ, **environment}, stdin=subprocess.DEVNULL, capture_output=True,
        text=True, timeout=_TIMEOUT_S, check=False,
    )  # fmt: skip
    if done.returncode not in allowed:
        lines = [*done.stdout.splitlines()[-2:], *done.stderr.splitlines()[-2:]]
        raise debian.MachineError(f"docker {words[0]} ended with {done.returncode}: {' | '.join(lines)}")
    return done.stdout


@contextmanager
def image(environment: Mapping[str, str]) -> Iterator[None]:
    """Build the image and print what it is; it is removed afterwards.

    Raises:
        MachineError: it does not build, or is not for aarch64.
    """
    debian.say("image for aarch64: docker build, emulated (a quarter of an hour the first time)")
    since_s = time.monotonic()
    network = ["--network", environment["RAILHIL_BUILD_NETWORK"]]
    tool(["build", *_PLATFORM, *network, "-t", _IMAGE, str(ROOT)], environment)
    took_s = time.monotonic() - since_s
    try:
        (about,) = json.loads(tool(["image", "inspect", _IMAGE], environment))
        if about["Architecture"] != "arm64":
            raise debian.MachineError(f"image for aarch64: found {about['Architecture']}, allowed arm64")
        print(f"image for aarch64: built in {took_s:.0f} s, {about['Size'] / 1e6:.0f} MB", flush=True)
        yield
    finally:
        # The layers of the last stage stay as those of the first do, for the next build.
        tool(["rmi", "--no-prune", _IMAGE], environment)


def contained(scenario: str, words: list[str], environment: Mapping[str, str]) -> str:
    """``frames_sha256`` of a run in a container of the image; a file is a scenario of its own.

    Raises:
        MachineError: the run ended without a verdict, or not on aarch64.
    """
    with tempfile.TemporaryDirectory(prefix="railhil-image-") as name:
        folder = Path(name)
        folder.chmod(0o777)
        mounts = ["-v", f"{folder}:/runs"]
        if Path(scenario).is_file():
            mounts += ["-v", f"{Path(scenario).resolve()}:/scenario.toml:ro"]
            scenario = "/scenario.toml"
        start = ["run", "--name", _IMAGE, *_PLATFORM, "--network", "none", *mounts, "--entrypoint", "sh", _IMAGE, "-c"]
        script = 'uname -m && exec railhil run "$@"'
        try:
            said = tool([*start, script, "sh", scenario, *words, "--out", "/runs/run"], environment, _VERDICTS)
        finally:
            # Not --rm: a container outlives its command when this process is ended. There is none if it did not start.
            tool(["rm", "-f", _IMAGE], environment, (0, 1))
        if said.split()[0] != "aarch64":
            raise debian.MachineError(f"image for aarch64: its processor is {said.split()[0]}")
        certificate = json.loads((folder / "run" / "certificate.json").read_text())
    return str(certificate["frames_sha256"])


def compared(scenario: str) -> int:
    """Build, run, and compare with this machine; returns the exit code.

    Raises:
        CapabilityError: aarch64 cannot be emulated here, or there is no Docker engine.
        MachineError: one of them failed, or the image does not build.
    """
    with tempfile.TemporaryDirectory() as scratch:
        here = local_run(load(scenario), Path(scratch), RunSpec()).frames_sha256
    different = 0
    with aarch64_programs(), docker_engine(architecture="arm64") as environment, image(environment):
        for kind, words in _RUNS.items():
            since_s = time.monotonic()
            there = contained(scenario, words, environment)
            different += there != here
            verdict = "equal" if there == here else f"DIFFERENT, here {here}"
            print(f"{scenario}, {kind}, {time.monotonic() - since_s:.0f} s: {there} {verdict}", flush=True)
    return 1 if different else 0


def main(words: list[str]) -> int:
    """Command line; see the module's docstring for the exit codes."""
    parser = argparse.ArgumentParser(prog="python -m hil_tests.image_arm64")
    parser.add_argument("scenario", nargs="?", default=str(_SHORT), help="name or file (default: a move of 8.5 s)")
    options = parser.parse_args(words)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    return debian.guarded("image_arm64", lambda: compared(options.scenario))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
