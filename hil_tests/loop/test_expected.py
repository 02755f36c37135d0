"""``expect`` of a fault: an unmet expectation makes the run FAIL, in the run and when its folder is scored again."""

from __future__ import annotations

from pathlib import Path

import pytest

from hil_tests.support.cli import railhil
from hil_tests.support.short_runs import RUN_2M_TOML

pytestmark = pytest.mark.faults


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("expected") / "short.toml"
    path.write_text(RUN_2M_TOML, encoding="utf-8")
    return path


@pytest.mark.long_after(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("expect", "said"),
    [
        ("HOLD within 40ms by speed_age", ""),
        ("TRACTION CUT within 70ms", ""),
        ("TRACTION CUT within 50ms", "fault 1: expected TRACTION CUT within 50 ms, came after 60 ms"),
        ("EMERGENCY", "fault 1: expected EMERGENCY, reached TRACTION CUT"),
        ("HOLD by overspeed", "fault 1: expected to be detected by overspeed, was by speed_age"),
    ],
)
def test_an_unmet_expectation_fails_the_run(scenario: Path, tmp_path: Path, expect: str, said: str) -> None:
    fault = f"TRN_SPEED loss @1s x12 expect {expect}"
    railhil("run", scenario, "--bus", "local", "--no-report", "--quiet", "--fault", fault, "--out", tmp_path / "run")
    again = railhil("score", tmp_path / "run", "--json")
    found = [text for text in again.json["failures"] if text.startswith("fault")]
    assert found == ([said] if said else [])
    assert (again.exit_code == 1) is bool(again.json["failures"])
