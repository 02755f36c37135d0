"""Complete runs of the cart in both arithmetics."""

from pathlib import Path

import pytest

from railhil.bench import local_run
from railhil.bus.telegrams import RunEvent
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec

from old_system import SYSTEM

SCENARIO = load_any(Path(__file__).with_name("old_system.toml"))


@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
@pytest.mark.parametrize("drawn", [False, True])
def test_a_run_is_a_pass(arithmetic: str, drawn: bool, tmp_path: Path) -> None:
    """In fixed point (iq) a law starts only if none of its operations can wrap."""
    spec = RunSpec(law=LawSpec("hold", arithmetic), seed=7, perturbed=drawn)
    run = local_run(SCENARIO, tmp_path, spec)
    assert run.score.verdict == "PASS", run.score.failures
    assert run.refused == {}
    assert SYSTEM.events["arrived"] in run.trace.raw(RunEvent.PORT, "RunEvent")
