"""The run without faults, from which a study learns when faults can act."""

from __future__ import annotations

from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.study.faultless import faultless_run


def test_faults_are_drawn_while_the_run_lasts_even_if_its_time_is_longer() -> None:
    near = ("task.start_m=2600", "task.start_kmh=10")
    scenario = load_any("yizhuang_stop", near, ())
    horizon_s, sent = faultless_run(RunSpec("yizhuang_stop", near, LawSpec("reaim"), bus="local"))
    assert horizon_s < scenario.planned_s
    assert horizon_s >= max(one.last_s for one in sent.values())
