"""What the benchmark of the panel reckons, without a run."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.figures import MeasurementError
from benchmarks.panel import Sample, cost_of, loss, scenario_toml
from railhil.scenarios.load import load


def test_the_share_is_of_the_time_between_first_and_last_sample() -> None:
    samples = [Sample(100.0, 5.0, 60_000_000), Sample(110.0, 5.1, 63_000_000), Sample(150.0, 6.0, 61_500_000)]
    cost = cost_of(samples)
    assert cost.seconds == 50.0
    assert cost.share == pytest.approx(0.02)
    assert (cost.rss_start_mb, cost.rss_half_mb, cost.rss_end_mb, cost.rss_most_mb) == (60.0, 63.0, 61.5, 63.0)


def test_a_run_that_is_too_short_gives_no_figure() -> None:
    with pytest.raises(MeasurementError, match="more --seconds"):
        cost_of([Sample(1.0, 1.0, 1)])


def test_the_loss_is_that_of_the_median_pair() -> None:
    assert loss([(100.0, 98.0), (50.0, 25.0), (200.0, 202.0)]) == pytest.approx(0.02)


@pytest.mark.parametrize("seconds", [20.0, 60.0, 1200.0, 1800.0])
def test_the_run_lasts_as_long_as_was_asked_for(tmp_path: Path, seconds: float) -> None:
    path = tmp_path / "walk.toml"
    path.write_text(scenario_toml(seconds))
    plan = load(str(path)).plan
    assert plan.running_time_s == pytest.approx(seconds, abs=1.0)
    assert plan.distance_m < 2940
