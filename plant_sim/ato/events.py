"""Events of a train inside a tick, with their exact instants."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import Literal

from railhil.plant_sim.ato.dynamics import Motion
from railhil.systems.ato.scenario.model import Balise

EventKind = Literal["departed", "stopped", "emergency", "balise", "watch"]


@dataclass(frozen=True, slots=True)
class PlantEvent:
    """Something that happened inside a tick, at its exact instant and true position of the train's front.

    ``departed``: first motion; ``stopped``: standstill after at least :data:`railhil.bus.codes.STOP_LEG_MIN_M`;
    ``emergency``: the emergency brake was applied; ``watch``: the level of the train's watch changed; ``balise``: the
    front passed ``balise`` with the odometer at ``odometer_mm``.
    """

    kind: EventKind
    instant_01ms: int
    position_01mm: int
    balise: Balise | None = None
    odometer_mm: int = 0


def passing_s(before: Motion, after: Motion, at_m: float, moving_s: float) -> float:
    """Time from the first motion of a step to the passing of ``at_m``, with constant acceleration in between."""
    distance_m = at_m - before.position_m
    if distance_m <= 0.0 or moving_s <= 0.0:
        return 0.0
    accel_mps2 = (after.speed_mps - before.speed_mps) / moving_s
    root_mps = sqrt(max(0.0, before.speed_mps**2 + 2 * accel_mps2 * distance_m))
    return min(moving_s, 2 * distance_m / (before.speed_mps + root_mps))
