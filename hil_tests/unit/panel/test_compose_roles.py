"""The roles of the containers with a panel, by their script, with a ``railhil`` that only notes its words."""

from __future__ import annotations

import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from hil_tests.support.paths import ROOT
from railhil.cli.panel import EMERGENCY, prepared_faults

NAMES = {
    "SCENARIO": "lvshun_tieshan", "CONTROLLER": "ipfc", "ARITHMETIC": "iq", "SEED": "0", "PACE": "lockstep",
    "RATE": "1", "START_TIMEOUT": "60", "PATIENCE": "60",
}  # fmt: skip


def words_of(role: str, folder: Path, **names: str) -> list[str]:
    """What a role gives to ``railhil``."""
    bus = folder / "bus"
    bus.mkdir()
    (bus / "can").write_text("railhil\n/bus/hub.sock\ndocker compose up\n")
    for name in ("results", "verdict"):
        (bus / name).touch()
    script = (ROOT / "docker/bench.sh").read_text().replace("/bus/", f"{bus}/")
    (folder / "railhil").write_text(f'#!/bin/sh\nprintf "%s\\n" "$@" >{folder}/words\n')
    (folder / "python3").write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
    for program in ("railhil", "python3"):
        (folder / program).chmod(0o755)
    environment = {**NAMES, **names, "PATH": f"{folder}:{os.environ['PATH']}"}
    subprocess.run(["sh", "-c", script, "bench", role], env=environment, check=True, timeout=30)
    return (folder / "words").read_text().split("\n")


def option(words: list[str], name: str) -> str:
    return words[words.index(name) + 1]


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("names", "seconds"),
    [
        ({}, "60"),
        ({"WAIT": ""}, "60"),
        ({"PROFILES": "panel", "WAIT": "1"}, "300"),
        ({"PROFILES": "panel", "WAIT": "1", "START_TIMEOUT": "900"}, "900"),
    ],
)
def test_the_plant_waits_for_the_start_button(names: dict[str, str], seconds: str, tmp_path: Path) -> None:
    assert option(words_of("plant", tmp_path, **names), "--appear-timeout") == seconds


@pytest.mark.slow
def test_the_supervisor_takes_orders_and_the_panel_gives_them_at_one_socket(tmp_path: Path) -> None:
    for role in ("supervisor", "panel"):
        (tmp_path / role).mkdir()
    supervisor = words_of("supervisor", tmp_path / "supervisor", PROFILES="panel", WAIT="1")
    assert "--wait" in supervisor
    assert option(supervisor, "--operator").endswith("/operator.sock")
    panel = words_of("panel", tmp_path / "panel", PROFILES="panel", PANEL_PORT="8770")
    assert option(panel, "--public-port") == "8770"
    assert option(panel, "--operator").endswith("/operator.sock")


def test_the_compose_file_tells_all_roles_of_the_panel() -> None:
    text = (ROOT / "docker-compose.yml").read_text().partition("\nservices:")[0]
    assert "PROFILES: ${COMPOSE_PROFILES:-}" in text
    assert "WAIT: ${WAIT:-}" in text
    assert "CATALOGUE: ${CATALOGUE:-}" in text


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("role", "names", "logs"),
    [
        ("plant", {"PROFILES": "panel", "WAIT": "1"}, "--fault-logs"),
        ("controller", {"PROFILES": "panel", "PACE": "realtime"}, "--fault-logs"),
        ("supervisor", {"PROFILES": "panel", "PACE": "realtime"}, "--fault-logs"),
        ("supervisor", {"PROFILES": "panel"}, ""),
        ("supervisor", {"PACE": "realtime"}, ""),
    ],
)
def test_the_nodes_and_the_supervisor_prepare_the_same_faults(
    role: str, names: dict[str, str], logs: str, tmp_path: Path
) -> None:
    words = words_of(role, tmp_path, **names)
    assert [after for word, after in pairwise(words) if word == "--fault"] == ([EMERGENCY] if logs else [])
    assert [word for word in words if word.startswith("--fault-logs")] == ([logs] if logs else [])
    # Its random numbers are those of the run.
    assert "--seed" in words or role != "controller"


def test_the_catalogue_is_prepared_too() -> None:
    found = prepared_faults("lvshun_tieshan", True)
    assert found[0] == EMERGENCY
    assert len(found) > 40


@pytest.mark.parametrize(("role", "name"), [("plant", "WAIT"), ("supervisor", "CATALOGUE"), ("panel", "PORT")])
def test_what_belongs_to_the_panel_is_refused_without_its_profile(role: str, name: str) -> None:
    words = ["sh", str(ROOT / "docker/bench.sh"), role]
    variables = {**NAMES, name: "1", "PATH": os.environ["PATH"]}
    done = subprocess.run(words, env=variables, capture_output=True, text=True, check=False, timeout=30)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "COMPOSE_PROFILES" in done.stderr


@pytest.mark.parametrize(("name", "value"), [("START_TIMEOUT", "60s"), ("WAIT", "0"), ("CATALOGUE", "false")])
def test_a_wrong_setting_of_the_containers_is_refused_by_its_name(name: str, value: str) -> None:
    words = ["sh", str(ROOT / "docker/bench.sh"), "supervisor"]
    done = subprocess.run(
        words, env={**NAMES, name: value, "PATH": os.environ["PATH"]}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stderr.startswith(f"supervisor: {name}: found {value}, allowed ")
