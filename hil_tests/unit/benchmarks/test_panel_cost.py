"""What the benchmark of the panel reckons, without a run."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.panel import Sample, cost_of, scenario_toml
from railhil.scenarios.load import load


def test_the_share_is_of_the_time_between_first_and_last_sample() -> None:
    samples = [Sample(100.0, 5.0, 60_000_000), Sample(110.0, 5.1, 63_000_000), Sample(150.0, 6.0, 61_500_000)]
    cost = cost_of(samples)
    assert cost.seconds == 50.0
    assert cost.share == pytest.approx(0.02)
    assert (cost.rss_start_mb, cost.rss_half_mb, cost.rss_end_mb, cost.rss_most_mb) == (60.0, 63.0, 61.5, 63.0)


@pytest.mark.parametrize("seconds", [20.0, 60.0, 1200.0, 1800.0])
def test_the_run_lasts_as_long_as_was_asked_for(tmp_path: Path, seconds: float) -> None:
    path = tmp_path / "walk.toml"
    path.write_text(scenario_toml(seconds))
    plan = load(str(path)).plan
    assert plan.running_time_s == pytest.approx(seconds, abs=1.0)
    assert plan.distance_m < 2940
