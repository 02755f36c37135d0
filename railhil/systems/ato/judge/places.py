"""What the panel draws along the track of ``ato``: places and profiles of the scenario."""

from __future__ import annotations

import numpy as np

from railhil.judge.declared import Place, ShownProfile
from railhil.scenarios.profiles import Profile, clip_profile, find_lowest
from railhil.systems.ato.judge.measures import KMH
from railhil.systems.ato.scenario.model import Line, Scenario, Train
from railhil.systems.ato.scenario.target import target_of

#: Interval of the planned curve, s.
_STEP_S = 0.5


def shown_places(scenario: Scenario) -> list[Place]:
    """Balises by their number, and the stopping point."""
    return [*list_balises(scenario.line), Place("stopping point", scenario.plan.distance_m)]


def shown_profiles(scenario: Scenario) -> list[ShownProfile]:
    """Planned speed and speed limit in km/h, grade in permil."""
    target = target_of(scenario.target)
    time_s = np.append(np.arange(0.0, target.stop_time_s, _STEP_S), target.stop_time_s)
    speed_kmh = np.maximum(np.asarray(target.speed_mps(time_s)), 0.0) * KMH
    planned = tuple(zip(np.asarray(target.position_m(time_s)).tolist(), speed_kmh.tolist(), strict=True))
    low_m, high_m = 0.0, scenario.plan.distance_m
    return [
        ShownProfile("planned", "km/h", planned, is_step=False),
        ShownProfile("limit", "km/h", limit_rows(scenario.line, scenario.train, low_m, high_m)),
        ShownProfile("grade", "‰", clip_profile(scenario.line.grade_permil, low_m, high_m)),
    ]


def list_balises(line: Line) -> list[Place]:
    """The balises at their surveyed positions."""
    return [Place(str(balise.number), balise.surveyed_m, "balise") for balise in line.balises]


def limit_rows(line: Line, train: Train, low_m: float, high_m: float) -> Profile:
    """Speed limit in km/h in force for the whole train, by position of its front between two positions."""
    rows = find_lowest(line.speed_limit_mps, train.length_m, train.speed_limit_mps)
    return clip_profile(tuple((start_m, value * KMH) for start_m, value in rows), low_m, high_m)
