"""The compose files without an engine: constructs that other versions of Compose would refuse."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
import yaml

from hil_tests.support.paths import ROOT
from railhil.scenarios.run_spec import RunSpec

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
    services |= {name: compose_file("docker-compose.panel.yml")["services"][name] for name in ("panel", "door")}
    capable = {name for name, service in services.items() if "cap_add" in service}
    assert capable == {name for name, service in services.items() if "security_opt" not in service} == {"bus"}


def test_defaults_are_those_of_the_command() -> None:
    """Who starts the same scenario with and without containers expects the same bytes."""
    said = compose_file("docker-compose.yml")["x-bench"]["environment"]
    run = RunSpec()
    assert said == said | {
        "SCENARIO": f"${{SCENARIO:-{run.scenario}}}",
        "CONTROLLER": f"${{CONTROLLER:-{run.law.controller}}}",
        "ARITHMETIC": f"${{ARITHMETIC:-{run.law.arithmetic}}}",
        "SEED": f"${{SEED:-{run.seed}}}",
        "PACE": f"${{PACE:-{run.pace}}}",
        "PATIENCE": f"${{PATIENCE:-{run.patience_s:g}}}",
        "RATE": f"${{RATE:-{run.rate:g}}}",
    }


def test_the_volume_between_the_containers_knows_no_user() -> None:
    """Its options stay those of its making: an owner in them would shut out another RAILHIL_UID."""
    (volume,) = compose_file("docker-compose.yml")["volumes"].values()
    assert "uid" not in volume["driver_opts"]["o"]
    assert "gid" not in volume["driver_opts"]["o"]


def test_the_page_is_published_on_loopback_alone_and_its_bench_has_no_network() -> None:
    services = compose_file("docker-compose.panel.yml")["services"]
    published = {name: service["ports"] for name, service in services.items() if "ports" in service}
    assert published == {"door": ["127.0.0.1:${PANEL_PORT:-8765}:8765"]}
    assert services["panel"]["network_mode"] == "service:bus"
    roles = (ROOT / "docker" / "bench.sh").read_text()
    assert all(f"\n{role})\n" in roles for role in ("panel", "door"))


@pytest.mark.parametrize("name", ["docker-compose.yml", "docker-compose.hardware.yml", "docker-compose.panel.yml"])
def test_every_container_is_limited(name: str) -> None:
    """A run that goes wild must not take the machine with it: processes, memory, files in memory."""
    made = {role: service for role, service in compose_file(name)["services"].items() if "image" in service}
    expected = {
        "docker-compose.yml": {"bus", "results", "plant", "controller", "supervisor"},
        "docker-compose.hardware.yml": {"adapter"},
        "docker-compose.panel.yml": {"panel", "door"},
    }
    assert set(made) == expected[name]
    for service in made.values():
        assert 0 < service["pids_limit"] <= 1024
        assert service["mem_limit"] == "${MEMORY_LIMIT:-2g}"
        assert service["read_only"] is True
        assert [re.fullmatch(r"/tmp:size=\d+m", mount) is not None for mount in service["tmpfs"]] == [True]
    if "volumes" in compose_file(name):
        assert all("size=" in volume["driver_opts"]["o"] for volume in compose_file(name)["volumes"].values())
