"""What the panel draws along a line: its places and profiles, in run positions."""

from __future__ import annotations

from itertools import pairwise

from railhil.judge.declared import Place, ShownProfile
from railhil.scenarios.profiles import clip_profile
from railhil.systems.ato.judge.measures import KMH
from railhil.systems.ato.judge.places import limit_rows, list_balises
from railhil.systems.line.planned import planned_motion
from railhil.systems.line.scenario.model import LineScenario


def shown_places(line: LineScenario) -> list[Place]:
    """Stops, stations that are passed, signals, balises."""
    stops = [Place(stop.name, stop.position_m, "mark" if stop.service == "pass" else "stop") for stop in line.stops]
    signals = [Place("signal", signal.position_m, "mark") for signal in line.signals]
    balises = [balise for leg in line.legs for balise in list_balises(leg)]
    return sorted((*stops, *signals, *balises), key=lambda place: place.position)


def shown_profiles(line: LineScenario) -> list[ShownProfile]:
    """Speed of the timetable and speed limit in km/h, grade in permil."""
    motion = planned_motion(line)
    planned = tuple(zip(motion.position_m.tolist(), (motion.speed_mps * KMH).tolist(), strict=True))
    turns = [stop.position_m for stop in line.stops if stop.turn_back]
    bounds = list(pairwise((0.0, *turns, line.stops[-1].position_m)))
    legs = list(zip(line.legs, bounds, strict=True))
    return [
        ShownProfile("planned", "km/h", planned, is_step=False),
        ShownProfile("limit", "km/h", sum((limit_rows(leg, line.train, *ends) for leg, ends in legs), ())),
        ShownProfile("grade", "‰", sum((clip_profile(leg.grade_permil, *ends) for leg, ends in legs), ())),
    ]
