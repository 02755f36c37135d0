"""Yizhuang's line in the return direction, as sections of ``ato``."""

from __future__ import annotations

import json
from dataclasses import replace

from hil_tests.support.paths import TEST_DATA
from railhil.scenarios.layers import DATA
from railhil.scenarios.load import load_any
from railhil.systems.ato.scenario.importers import ttobench
from railhil.systems.ato.scenario.importers.section import Stop, StopLine
from railhil.systems.ato.scenario.mirror import mirror_line
from railhil.systems.ato.scenario.model import Scenario

_TRACK = DATA / "sources" / "yizhuang_line" / "CN_Songjiazhuang_Yizhuang.json"


def return_section(number: int) -> Scenario:
    """Section ``number`` (from 1) of the return run; the target curve is that of another section and of no use."""
    back = json.loads((TEST_DATA / "line" / "return_profiles.json").read_text())
    scenario = load_any("yizhuang_05")
    assert isinstance(scenario, Scenario)
    stops = tuple(Stop(name, at_m) for name, at_m in back["stops_m"])
    line = mirror_line(ttobench.load_line(_TRACK).line, stops[-1].position_m, scenario.train.length_m)
    section = StopLine(line, stops).section(number - 1, number, scenario.train.length_m)
    distance_m = stops[number].position_m - stops[number - 1].position_m
    plan = replace(scenario.plan, distance_m=distance_m, running_time_s=float(back["timetable_s"][number - 1]))
    return replace(scenario, line=section, plan=plan)
