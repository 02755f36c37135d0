"""Short runs of precise stopping in which a law once violated a sentence of ``--requirements stop``."""

from __future__ import annotations

import pytest

from hil_tests.support.stops import SHORT
from railhil.hunt.oracle import run_case
from railhil.judge.requirements.requirement import read_requirements
from railhil.scenarios.run_spec import LawSpec, RunSpec

STANDSTILL = ("task.start_kmh=0", "task.after_stop_s=4")
UPHILL = ("task.grade=[[0, 10]]",)
RESTART = ("controller restart @stopped+100ms for 50ms",)


@pytest.mark.faults
@pytest.mark.slow
@pytest.mark.parametrize("law", ["ilc_stop", "reaim"])
@pytest.mark.parametrize(
    ("settings", "faults", "says_something"),
    [
        pytest.param(STANDSTILL, RESTART, "STOP-15", id="a restart at the platform of a run from standstill"),
        pytest.param(UPHILL, RESTART, "STOP-15", id="a restart at a platform on a slope"),
        pytest.param((), ("brake full @1s for 5s",), "STOP-15", id="a stop on the way by a brake that nobody commands"),
        pytest.param((), ("SPEED_RAW loss 60% @1s",), "STOP-17", id="an estimate that never settles"),
        pytest.param((), ("SPEED_RAW loss 100% @2s for 80ms",), "STOP-17", id="five speeds lost"),
    ],
)
def test_the_sentences_are_kept(
    law: str, settings: tuple[str, ...], faults: tuple[str, ...], says_something: str
) -> None:
    base = RunSpec("yizhuang_stop_closed", (*SHORT, *settings), LawSpec(law, arithmetic="float64"), bus="local")
    found = run_case(base, read_requirements("stop"), faults, seed=0)
    assert (found.is_valid, dict(found.violated)) == (True, {})
    assert "kept" in {one.verdict for one in found.outcomes if one.id == says_something}
