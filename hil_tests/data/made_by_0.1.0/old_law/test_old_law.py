"""One step of the law compared with its equation, and complete runs in both arithmetics."""

from pathlib import Path

import pytest

from railhil.bench import local_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.laws.base import LawInputs
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec, RunSpec

from old_law import Parameters, OldLaw

SCENARIO = load("lvshun_tieshan")


def test_one_step_is_that_of_the_equation() -> None:
    """1 km/h too slow, the set-point rises by 0.5 km/h in each control period of 0.5 s."""
    parameters = Parameters(proportional=3.0, integral_per_s=0.1, lead_s=1.5)
    law = OldLaw(make("float64"), SCENARIO, parameters)
    inputs = LawInputs(50.0, 51.0, (51.5, 52.0))
    _, outputs = law.step(law.start(inputs), inputs)
    assert outputs.notch_raw == pytest.approx(3.0 * 1.0 + 0.1 * 0.5 * 1.0 + 1.5 * 1.0)


@pytest.mark.parametrize("arithmetic", ["iq", "float64"])
def test_a_whole_run_is_a_pass(arithmetic: str, tmp_path: Path) -> None:
    """In fixed point (iq) a law starts only if none of its operations can wrap."""
    run = local_run(SCENARIO, tmp_path, RunSpec(law=LawSpec("old_law", arithmetic)))
    assert run.score.verdict == "PASS", run.score.failures
    assert run.refused == {}
