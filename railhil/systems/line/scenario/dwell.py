"""The dwell that a run draws for each stop: a disturbance, and sometimes a hold."""

from __future__ import annotations

from dataclasses import dataclass

from railhil.scenarios import streams
from railhil.systems.line.scenario.model import LineScenario


@dataclass(frozen=True, slots=True)
class DrawnDwell:
    """What a run adds to the least dwell at a stop."""

    disturbance_s: float
    hold_s: float


def draw_dwells(line: LineScenario, seed: int) -> tuple[DrawnDwell, ...]:
    """One for each stop of the route, also where the train does not dwell; one random number for each of the two.

    :raises ValueError: a negative seed.
    """
    disturbance, hold = line.route.dwell_disturbance_s, line.route.hold
    units = streams.generator(seed, streams.DWELL).random((len(line.stops), 2)).tolist()
    return tuple(
        DrawnDwell(
            disturbance.low + (disturbance.high - disturbance.low) * first,
            # The number that decides on a hold is, within its probability, also the share of its range.
            hold.extra_s.low + (hold.extra_s.high - hold.extra_s.low) * second / hold.probability
            if second < hold.probability
            else 0.0,
        )
        for first, second in units
    )
