"""The two controllers of docs/reference/wire.md know nothing of railhil: a verdict on each bus, under their name."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from hil_tests.support.cli import Done, railhil
from hil_tests.support.hub import running_hub
from hil_tests.support.paths import ROOT
from hil_tests.support.short_runs import RUN_2M_TOML

pytestmark = [pytest.mark.slow, pytest.mark.loop]

EXAMPLES = ROOT / "docs/examples/wire"
PYTHON, C = EXAMPLES / "controller.py", EXAMPLES / "controller.c"


@pytest.fixture(scope="module")
def dbc(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """As a user gets it."""
    path = tmp_path_factory.mktemp("dbc") / "railhil.dbc"
    assert railhil("ports", "--write-dbc", path).exit_code == 0
    return path


def joined(controller: Sequence[str | Path], channel: str, folder: Path, *arguments: str) -> Done:
    """The published run on a hub, with a stranger's program as the controller, which must end with the run."""
    node = subprocess.Popen(controller, stderr=subprocess.PIPE, text=True)
    try:
        bus = ("-i", "railhil", "-c", channel)
        done = railhil("run", "--no-controller", *arguments, "--out", folder, "--quiet", "--no-report", *bus)
        _, said = node.communicate(timeout=20)
    finally:
        node.kill()
        node.wait()
    assert node.returncode == 0, said
    return done


def by_python(dbc: Path, folder: Path) -> Done:
    """The published run with the Python controller, on the Unix socket of a hub."""
    with running_hub() as hub:
        return joined([sys.executable, PYTHON, "railhil", hub.channel, dbc], hub.channel, folder)


def document(folder: Path, name: str) -> Any:
    return json.loads((folder / name).read_text())


def test_the_examples_are_short_and_import_nothing_of_railhil() -> None:
    for path in (PYTHON, C):
        text = path.read_text()
        assert len(text.splitlines()) <= 100, path
        assert not re.search(r"^(?:import|from) railhil|#include \"", text, re.M), path


def test_the_python_controller_passes(dbc: Path, tmp_path: Path) -> None:
    done = by_python(dbc, tmp_path / "run")
    assert (done.exit_code, "PASS" in done.out) == (0, True), done.out + done.err


@pytest.mark.long
def test_behind_a_gateway_the_python_controller_has_the_same_hash(dbc: Path, tmp_path: Path) -> None:
    """The controller on a hub of its own over TCP, the bench on another one, which is the gateway."""
    by_python(dbc, tmp_path / "unix")
    with (
        running_hub(channel="tcp://127.0.0.1:0") as far,
        running_hub("--lossless", "--port", f"railhil:{far.channel}") as near,
    ):
        joined([sys.executable, PYTHON, "railhil", far.channel, dbc], near.channel, tmp_path / "tcp")
    hashes = {document(tmp_path / way, "certificate.json")["frames_sha256"] for way in ("unix", "tcp")}
    assert len(hashes) == 1


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The C controller; two compilers have nothing to say on it."""
    path = tmp_path_factory.mktemp("c") / "controller"
    words = ["-std=gnu99", "-O2", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off", "-o", path, C, "-lm"]
    for compiler in ("clang", "gcc"):
        subprocess.run([compiler, *words], check=True)
    return path


@pytest.mark.long_after(1)
@pytest.mark.needs_compiler
@pytest.mark.parametrize("name", ["", "ATO of somebody"])
def test_the_c_controller_has_a_verdict_under_its_own_name(program: Path, name: str, tmp_path: Path) -> None:
    """PASS on the published run; without a name it is unknown, as is all that it does not state."""
    short = tmp_path / "short.toml"
    short.write_text(RUN_2M_TOML)
    folder, scenario = tmp_path / "run", [] if name else [str(short)]
    with running_hub() as hub:
        given = ["--controller-name", name] if name else []
        done = joined([program, "hub", hub.channel], hub.channel, folder, *scenario, *given)
    if name:
        assert (done.exit_code, "PASS" in done.out) == (0, True), done.out + done.err
    run, certificate = document(folder, "score.json")["run"], document(folder, "certificate.json")
    stated = {key: run[key] for key in ("controller", "arithmetic", "indexing")}
    assert stated == {"controller": name or "unknown", "arithmetic": "unknown", "indexing": "unknown"}
    assert (certificate["controller"], certificate["foreign"]) == (name or "unknown", True)
    properties = ET.parse(folder / "junit.xml").iter("property")
    assert [one.get("value") for one in properties if one.get("name") == "controller"] == [name or "unknown"]


@pytest.mark.needs_compiler
@pytest.mark.parametrize("words", [[], ["hub"], ["hub", "/none.sock"], ["can", "no_such_can9"]])
def test_the_c_controller_refuses_a_bus_that_is_not_there(program: Path, words: list[str]) -> None:
    done = subprocess.run([program, *words], check=False, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith("bus: ")
