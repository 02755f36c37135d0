"""Faults as a strategy of hypothesis."""

from __future__ import annotations

import pytest
from hypothesis import find, given, settings

from railhil.faults.language import parse
from railhil.judge.fault_report import check_faults
from railhil.scenarios.load import load
from railhil.testing import faults

SHORT = faults("yizhuang_05", max_size=3)


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(SHORT)
def test_a_run_can_inject_them(found: tuple[str, ...]) -> None:
    scenario = load("yizhuang_05", (), found)
    assert len(scenario.faults) == len(found)
    check_faults(scenario, ["local"], "lockstep")


@pytest.mark.long
@pytest.mark.slow
def test_they_shrink_to_fewer_shorter_and_later_ones() -> None:
    end_s = load("yizhuang_05").planned_s
    (simplest,) = find(SHORT, lambda found: True)
    fault = parse(simplest)
    assert (fault.place.level, fault.what, fault.duration_s) == ("telegram", "loss", 0.01)
    assert end_s - 0.02 <= float(fault.trigger.value) < end_s
    short = parse(find(SHORT, lambda found: (parse(found[0]).duration_s or 0) >= 1.5)[0])
    assert short.duration_s == 1.5
    early = parse(find(SHORT, lambda found: float(parse(found[0]).trigger.value) < 30)[0])
    assert 29.5 < float(early.trigger.value) < 30
    assert len(find(SHORT, lambda found: len(found) >= 2)) == 2
