"""A suite of a user of railhil: `pip install railhil pytest`, then `pytest` in this folder."""

import pytest

from railhil.testing import kmh

pytestmark = pytest.mark.railhil(scenario="my_line.toml", controller="ipfc_plus")


@pytest.mark.requirement("ATO-12")
def test_stops_at_the_board(bench, seed):
    run = bench.run(seed=seed, perturbed=True)
    assert run.passed, run.reasons
    assert abs(run.score.stop_error_m) <= 0.30


@pytest.mark.requirement("ATO-15")
def test_brakes_for_the_stop(bench):
    with bench.start() as live:  # the test holds the clock
        live.wait_until(speed=kmh(40), timeout_s=60)  # simulation time
        live.expect("NOTCH_CMD", NotchCmd=lambda notch: notch < 0, CtlMode="running", within_s=90)
        live.wait_until("RUN_EVENT", RunEvent="stopped", timeout_s=60)
