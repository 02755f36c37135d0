"""The compose files without an engine: constructs that other versions of Compose would refuse."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from hil_tests.support.paths import ROOT
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import system_named

_FILES = sorted(path.name for path in ROOT.glob("docker-compose*.yml"))


def compose_file(name: str) -> dict[str, Any]:
    return yaml.safe_load((ROOT / name).read_text())


def empty_lists(found: Any, key: str = "") -> Iterator[str]:
    """Keys that hold an empty list."""
    if isinstance(found, dict):
        for name, value in found.items():
            yield from empty_lists(value, f"{key}.{name}")
    elif found == []:
        yield key


@pytest.mark.parametrize("name", _FILES)
def test_no_list_is_empty(name: str) -> None:
    """Compose 2.26 merges an override into an empty list as nothing, and then says that it must be a list."""
    assert list(empty_lists(compose_file(name))) == []


def test_one_service_alone_has_a_capability_and_goes_without_no_new_privileges() -> None:
    services = compose_file("docker-compose.yml")["services"]
    capable = {name for name, service in services.items() if "cap_add" in service}
    assert capable == {name for name, service in services.items() if "security_opt" not in service} == {"bus"}


def test_defaults_are_those_of_the_command() -> None:
    """Who starts the same scenario with and without containers expects the same bytes."""
    said = compose_file("docker-compose.yml")["x-bench"]["environment"]
    run = RunSpec()
    assert said == said | {
        "SCENARIO": f"${{SCENARIO:-{run.scenario}}}",
        "SEED": f"${{SEED:-{run.seed}}}",
        "PACE": f"${{PACE:-{run.pace}}}",
        "PATIENCE": f"${{PATIENCE:-{run.patience_s:g}}}",
        "RATE": f"${{RATE:-{run.rate:g}}}",
    }


def test_the_image_can_be_built_compiled() -> None:
    """setup.py reads the build argument; without that file the image would be pure whatever is asked for."""
    dockerfile = (ROOT / "Dockerfile").read_text()
    assert "!setup.py" in (ROOT / ".dockerignore").read_text().splitlines()
    assert dockerfile.index("ARG RAILHIL_COMPILED=0") < dockerfile.index("pip install --no-cache-dir --no-deps .")


def test_law_and_arithmetic_are_left_to_the_system_unless_they_are_chosen() -> None:
    """Not every system has the fixed point, and each has laws of its own."""
    for service in compose_file("docker-compose.yml")["services"].values():
        said = service["environment"]
        assert (said["CONTROLLER"], said["ARITHMETIC"]) == ("${CONTROLLER:-}", "${ARITHMETIC:-}")


def role_words(role: str, folder: Path, scenario: str, **chosen: str) -> list[str]:
    """What a role of docker/bench.sh starts railhil with, on a volume that is ``folder``."""
    for name in ("can", "results", "verdict"):
        (folder / name).write_text("socketcan\nvcan0\ndocker compose up\n")
    stub = folder / "bin"
    stub.mkdir()
    (stub / "railhil").write_text(
        f"#!/bin/sh\nprintf '%s\\n' \"$@\" >{folder}/words.part; mv {folder}/words.part {folder}/words\n"
    )
    # Waits until the words of a command in the background are there.
    (stub / "sleep").write_text(f"#!/bin/sh\nuntil [ -e {folder}/words ]; do /bin/sleep 0.05; done\n")
    (stub / "python3").write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
    for name in ("railhil", "sleep", "python3"):
        (stub / name).chmod(0o755)
    text = (ROOT / "docker" / "bench.sh").read_text().replace("/bus/", f"{folder}/").replace("    cd /\n", "")
    environment = {
        "SCENARIO": scenario, "CONTROLLER": "", "ARITHMETIC": "", "SEED": "0", "PACE": "lockstep", "RATE": "1",
        "START_TIMEOUT": "1", "PATIENCE": "60", "PANEL_PORT": "8765", "PROFILES": "panel" if role == "panel" else "",
        "PYTHONPATH": str(ROOT), **chosen,
    }  # fmt: skip
    done = subprocess.run(
        ["sh", "-s", role], input=text, capture_output=True, text=True, timeout=60, check=False, cwd=folder,
        env={**environment, "PATH": f"{stub}:{os.environ['PATH']}"},
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return (folder / "words").read_text().splitlines()


@pytest.mark.parametrize("role", ["controller", "supervisor"])
def test_nodes_are_told_law_and_arithmetic_when_they_are_chosen(role: str, tmp_path: Path) -> None:
    for name in ("left", "chosen"):
        (tmp_path / name).mkdir()
    left = role_words(role, tmp_path / "left", "jinan_xuzhou")
    assert not {"--controller", "--arithmetic"} & set(left)
    chosen = role_words(role, tmp_path / "chosen", "lvshun_tieshan", CONTROLLER="tdmc", ARITHMETIC="float32")
    assert "--controller tdmc --arithmetic float32" in " ".join(chosen)


@pytest.mark.slow
def test_the_panel_names_the_notes_of_the_law_of_the_system(tmp_path: Path) -> None:
    words = role_words("panel", tmp_path, "jinan_xuzhou")
    assert words[words.index("--controller") + 1] == system_named("hst1").law


def test_the_volume_between_the_containers_knows_no_user() -> None:
    """Its options stay those of its making: an owner in them would shut out another RAILHIL_UID."""
    (volume,) = compose_file("docker-compose.yml")["volumes"].values()
    assert "uid" not in volume["driver_opts"]["o"]
    assert "gid" not in volume["driver_opts"]["o"]


def test_the_page_is_published_on_loopback_alone_and_its_bench_has_no_network() -> None:
    services = compose_file("docker-compose.yml")["services"]
    assert {name for name, service in services.items() if "profiles" in service} == {"panel", "door"}
    published = {name: service["ports"] for name, service in services.items() if "ports" in service}
    assert published == {"door": ["127.0.0.1:${PANEL_PORT:-8765}:8765"]}
    assert services["panel"]["network_mode"] == "service:bus"
    roles = (ROOT / "docker" / "bench.sh").read_text()
    assert all(f"\n{role})\n" in roles for role in ("panel", "door"))


@pytest.mark.parametrize("name", ["docker-compose.yml", "docker-compose.hardware.yml"])
def test_every_container_is_limited(name: str) -> None:
    """A run that goes wild must not take the machine with it: processes, memory, files in memory."""
    made = {role: service for role, service in compose_file(name)["services"].items() if "image" in service}
    expected = {
        "docker-compose.yml": {"bus", "results", "plant", "controller", "supervisor", "panel", "door"},
        "docker-compose.hardware.yml": {"adapter"},
    }
    assert set(made) == expected[name]
    for service in made.values():
        assert 0 < service["pids_limit"] <= 1024
        assert service["mem_limit"] == "${MEMORY_LIMIT:-2g}"
        assert service["read_only"] is True
        assert [re.fullmatch(r"/tmp:size=\d+m", mount) is not None for mount in service["tmpfs"]] == [True]
    if "volumes" in compose_file(name):
        assert all("size=" in volume["driver_opts"]["o"] for volume in compose_file(name)["volumes"].values())
