"""``railhil probability`` on the bench: beside counted runs, and rare runs through the nodes and over a bus."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import railhil
from hil_tests.support import cli
from railhil.batch.statistics import share_of
from railhil.probability.interval import from_count
from railhil.probability.plan import Request, make_plan
from railhil.probability.sampling import draw_points, estimate_side, find_levels

#: Runs of the batch whose stop error is larger than a limit, in m: scenario, law, limit, how many of how many. Those of
#: 32,768 are the seeds from 5,000,000 on; those of 1,000,000 were counted for the specification.
COUNTED = (
    ("lvshun_tieshan", "ipfc_plus_stop", 0.0403, 9960, 1_000_000),
    ("lvshun_tieshan", "ipfc_plus_stop", 0.0483, 965, 1_000_000),
    ("lvshun_tieshan", "ipfc_plus", 0.0449, 327, 32_768),
    ("lvshun_tieshan", "ipfc_plus", 0.0541, 31, 32_768),
    ("lvshun_tieshan_worn_wheels", "ipfc_plus", 0.0465, 325, 32_768),
    ("lvshun_tieshan_worn_wheels", "ipfc_plus", 0.0562, 32, 32_768),
    ("lvshun_tieshan_worn_wheels", "ipfc_plus_stop", 0.0404, 326, 32_768),
    ("lvshun_tieshan_worn_wheels", "ipfc_plus_stop", 0.0476, 33, 32_768),
)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize(("scenario", "law", "limit_m", "count", "runs"), COUNTED)
def test_subset_simulation_agrees_with_counted_runs(
    scenario: str, law: str, limit_m: float, count: int, runs: int, tmp_path: Path
) -> None:
    says = f"at stopped abs(stop_error) <= {limit_m} m"
    words = ["probability", scenario, "--says", says, "--controller", law, "--method", "subset", "--points", "1000"]
    cli.railhil(*words, "--accuracy", "10", "--seed", "1", "--engine", "batch", "--out", str(tmp_path / "p"))
    found = json.loads((tmp_path / "p" / "summary.json").read_text())
    counted = from_count(share_of(count, runs))
    assert len(found["repetitions"]) == 10
    assert found["low"] <= counted.high
    assert found["high"] >= counted.low
    assert found["p"] == pytest.approx(counted.p, rel=0.5)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.timeout(900)
def test_a_rare_run_is_the_same_in_the_batch_through_the_nodes_and_over_a_bus(tmp_path: Path) -> None:
    """Runs of a probability of about 1e-5: their noise is a chain of many proposals."""
    request = Request(says="at stopped stop_error <= 0.0579 m", controller="ipfc_plus_stop", points=500)
    plan = make_plan(request)
    random = np.random.default_rng(5)
    plain = draw_points(500, len(plan.state.names), True, random)
    known = plan.state(plain)
    pilot = find_levels(plan.state, 0, plain, known, 500, random)
    rare = estimate_side(plan.state, 0, pilot.levels, plain, known, 500, random)
    assert 1e-7 < rare.p < 1e-4
    for place in (0, -1):
        points = rare.failing.take(np.array([place]))
        (chain,) = points.chains()
        assert len(chain) > 2
        settings = plan.bench.spec(plan.state.whole_draws(points)[0].tolist(), chain).settings
        hashes = set()
        for bus in ("local", "auto"):
            folder = tmp_path / f"{bus}{place}"
            run = railhil.run(request.scenario, controller=request.controller, settings=settings, bus=bus, out=folder)
            error_m = json.loads((folder / "score.json").read_text())["signed"]["stop_error_m"]
            assert 0.0579 - error_m == pytest.approx(rare.margins[place], abs=1e-12)
            assert json.loads((folder / "certificate.json").read_text())["transport"].startswith(
                "local" if bus == "local" else "railhil:"
            )
            hashes.add(run.frames_sha256)
        assert len(hashes) == 1
