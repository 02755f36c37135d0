"""Limit states of which the probability is known: ``beta - x`` with a standard normal x, P = Phi(-beta)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri

from railhil.probability.sampling import (
    Floats,
    Ints,
    Level,
    Margins,
    Pilot,
    Points,
    draw_points,
    estimate_side,
    find_levels,
)


def _normals_of(seeds: Ints) -> Floats:
    """A standard normal number for each seed (splitmix64): the projection of its stream on one direction."""
    z = seeds.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15) + np.uint64(0x1234567)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        z = (z ^ (z >> np.uint64(shift))) * np.uint64(factor)
    return np.asarray(ndtri(((z >> np.uint64(11)).astype(np.float64) + 0.5) / 2.0**53))


@dataclass(frozen=True)
class Linear:
    """``sides`` 2: ``beta + x``, too. ``tick``: x is rounded to multiples, as stop places are. ``noise``: x is half
    noise."""

    beta: float
    draws: int
    sides: int = 1
    tick: float = 0.0
    noise: bool = False

    def x(self, points: Points) -> Floats:
        x: Floats = points.draws.sum(axis=1) / np.sqrt(self.draws)
        if self.noise:
            x = (x + (points.weights * _normals_of(points.seeds)).sum(axis=1)) / np.sqrt(2)
        return np.round(x / self.tick) * self.tick if self.tick else x

    def __call__(self, points: Points) -> Floats:
        x = self.x(points)
        return np.stack([self.beta - x, self.beta + x][: self.sides], axis=1)

    @property
    def p(self) -> float:
        """The truth."""
        beta = self.beta
        if self.tick:
            # The first multiple above beta is reached from half a tick below it.
            beta = (np.floor(self.beta / self.tick + 1e-9) + 0.5) * self.tick
        return float(ndtr(-beta)) * self.sides


def pilots(state: Linear, count: int, random: np.random.Generator) -> list[Pilot]:
    """The pilot of each side; one that is stuck is made again."""
    found: list[Pilot] = []
    while len(found) < state.sides:
        plain = draw_points(count, state.draws, state.noise, random)
        one = find_levels(state, len(found), plain, state(plain), count, random)
        found += [one] if one.is_whole else []
    return found


def repetition(state: Margins, levels: list[tuple[Level, ...]], plain: Points, random: np.random.Generator) -> float:
    """One estimate, its sides added."""
    known = state(plain)
    sides = [estimate_side(state, side, one, plain, known, len(plain), random).p for side, one in enumerate(levels)]
    return sum(sides)


def estimates(state: Linear, count: int, repetitions: int, seed: int) -> Floats:
    """Estimates of independent repetitions after one pilot."""
    random = np.random.default_rng(seed)
    levels = [pilot.levels for pilot in pilots(state, count, random)]
    return np.array(
        [
            repetition(state, levels, draw_points(count, state.draws, state.noise, random), random)
            for _ in range(repetitions)
        ]
    )
