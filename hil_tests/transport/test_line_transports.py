"""A short line with a dwell: the same bytes in one process, over pipes and over a hub."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.paths import TEST_DATA
from railhil.run.local import local_run
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec

pytestmark = [pytest.mark.loop, pytest.mark.slow]

LINE = TEST_DATA / "tiny_line.toml"
SEED = 3
OPTIONS = {"local": ["--bus", "local"], "hub": ["-i", "railhil"], "pipes": []}


@pytest.fixture(scope="module")
def local_sha256(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Hash of the record of the run in this process."""
    scenario = load_any(str(LINE))
    return local_run(
        scenario, tmp_path_factory.mktemp("local"), RunSpec(law=LawSpec("ipfc_plus"), seed=SEED)
    ).frames_sha256


@pytest.mark.long_after(1)
@pytest.mark.parametrize("bus", ["pipes", "local", "hub"])
def test_a_line_has_the_same_bytes_on_every_bus(bus: str, local_sha256: str, tmp_path: Path) -> None:
    given = ["--seed", str(SEED), "--out", tmp_path / "run", "--quiet", "--no-report"]
    done = railhil("run", LINE, *given, *OPTIONS[bus])
    assert done.exit_code in (0, 1), done.err
    certificate = json.loads((tmp_path / "run" / "certificate.json").read_text(encoding="utf-8"))
    assert certificate["transport"].endswith({"local": "local", "hub": "hub.sock", "pipes": ":pipes"}[bus])
    assert certificate["frames_sha256"] == local_sha256
