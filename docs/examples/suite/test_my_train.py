"""A suite of a user of railhil: `pip install railhil pytest`, then `pytest` in this folder."""

import pytest

from railhil.testing import kmh

pytestmark = pytest.mark.railhil(scenario="my_line.toml", controller="ipfc_plus")


@pytest.mark.requirement("ATO-12")
@pytest.mark.parametrize("faults", [[], ["TRN_SPEED loss 5% @0s"]], ids=["undisturbed", "5_percent_loss"])
def test_stops_at_the_board(bench, seed, faults):
    run = bench.run(seed=seed, perturbed=True, faults=faults)
    assert run.passed, run.reasons
    assert abs(run.score.stop_error_m) <= 0.30


@pytest.mark.requirement("ATO-13")
def test_stands_without_its_controller(bench):
    run = bench.run(faults=["controller kill @v>40km/h"])
    assert run.reaction("SERVICE BRAKE").after_s("controller kill @v>40km/h") <= 0.3
    assert run.signals["true_speed_mps"][-1] == 0


@pytest.mark.requirement("ATO-15")
def test_no_traction_without_pantograph(bench):
    with bench.start() as live:  # the test holds the clock
        live.wait_until(speed=kmh(40), timeout_s=60)  # simulation time
        live.inject("pantograph off for 5s")
        live.advance(1.0)
        assert live.read("SIM_TRUTH")["TractionForce"] == 0
