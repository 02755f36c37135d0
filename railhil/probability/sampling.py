"""Subset simulation: the probability of a rare event as a product of shares that are not rare.

A *pilot* chooses falling bounds of the margin and a step for each of them. A *repetition* then takes these as they are:
it draws plain points, counts the share below the first bound, moves the points below it by a Markov chain that does not
leave them, counts the share below the next bound, and so on to the bound 0. The product of its shares is the estimate.
With bounds and steps that do not depend on its own points, its expectation is the probability itself, for any number of
points and any correlation between them: the points of a level are the survivors of the one before, each with the same
expected number of states of a chain that keeps the conditional distribution (Cerou, Del Moral, Furon, Guyader:
Sequential Monte Carlo for rare event estimation, 2012, section 2). With bounds that each run takes from its own points
the estimate has a bias.

Points are vectors of standard normal numbers. A proposal is conditional, ``sqrt(1 - s^2) old + s new`` with a step
``s`` for each draw (Papaioannou, Betz, Zwirglmaier, Straub: MCMC algorithms for subset simulation, 2015). The noise of
a run has too many numbers to be written down: it is a chain, the sum of streams that are known by their seeds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]

#: Seeds of streams of noise lie below it.
SEEDS = 2**32
#: Share of points that a bound of the pilot is to leave (Au, Beck 2001: 0.1 to 0.3 are equally good).
SHARE = 0.2
#: Share of accepted proposals at which the pilot aims (Papaioannou et al. 2015, section 4).
ACCEPTED = 0.44
#: A pilot that has not come to the bound 0 after so many levels ends: below about 1e-14.
LEVELS_MAX = 20
_FIRST_STEP = 0.6


@dataclass(frozen=True, slots=True)
class Points:
    """Runs as vectors.

    ``draws``: standard normal numbers, shape (n, draws). ``seeds``, ``weights``: the streams of each run's noise, shape
    (n, streams), from the left; the squares of a run's weights add up to 1, and the places behind its last stream have
    weight 0. No streams: there is no noise.
    """

    draws: Floats
    seeds: Ints
    weights: Floats

    def __len__(self) -> int:
        return len(self.draws)

    def take(self, places: NDArray[Any]) -> Points:
        """Some of them, by places or by truth values."""
        return Points(self.draws[places], self.seeds[places], self.weights[places])

    def chains(self) -> list[list[tuple[int, float]]]:
        """The streams of each run's noise: seed and weight."""
        return [
            [(int(seed), float(weight)) for seed, weight in zip(*one, strict=True) if weight]
            for one in zip(self.seeds, self.weights, strict=True)
        ]


#: (points) -> margins, shape (points, sides). Below 0: the event of that side; NaN is not allowed, inf is.
Margins: TypeAlias = Callable[[Points], Floats]


def draw_points(count: int, draws: int, has_noise: bool, random: np.random.Generator) -> Points:
    """Plain points, independent of each other."""
    streams = (count, int(has_noise))
    return Points(random.standard_normal((count, draws)), random.integers(0, SEEDS, streams), np.ones(streams))


def join_points(parts: list[Points]) -> Points:
    """Points of several parts, in their order."""
    width = max(part.seeds.shape[1] for part in parts)

    def widened(values: NDArray[Any]) -> NDArray[Any]:
        return np.pad(values, ((0, 0), (0, width - values.shape[1])))

    return Points(
        np.concatenate([part.draws for part in parts]),
        np.concatenate([widened(part.seeds) for part in parts]),
        np.concatenate([widened(part.weights) for part in parts]),
    )


@dataclass(frozen=True, slots=True)
class Level:
    """A bound of the margin, and how points below it are moved: steps of the draws, shape (draws,), and of the noise,
    each above 0 and at most 1."""

    bound: float
    draw_steps: tuple[float, ...]
    noise_step: float

    def propose(self, points: Points, random: np.random.Generator) -> Points:
        """A proposal for each point. It keeps the distribution of plain points."""
        steps = np.array(self.draw_steps)
        draws = np.sqrt(1 - steps**2) * points.draws + steps * random.standard_normal(points.draws.shape)
        if not points.seeds.shape[1]:
            return Points(draws, points.seeds, points.weights)
        count, ends = len(points), np.count_nonzero(points.weights, axis=1)
        kept = np.sqrt(1 - self.noise_step**2)
        weights = np.pad(points.weights * kept, ((0, 0), (0, 1)))
        seeds = np.pad(points.seeds, ((0, 0), (0, 1)))
        if not kept:
            ends = np.zeros(count, dtype=np.int64)
        rows = np.arange(count)
        seeds[rows, ends] = random.integers(0, SEEDS, count)
        weights[rows, ends] = self.noise_step
        width = int(ends.max(initial=0)) + 1
        return Points(draws, seeds[:, :width], weights[:, :width])


@dataclass(frozen=True, slots=True)
class Moved:
    """Points of a level after the moves, their margins, and the numbers of proposals and of accepted ones."""

    points: Points
    margins: Floats
    proposed: int
    accepted: int


def move_points(
    margins: Margins,
    seeds: Points,
    known: Floats,
    side: int,
    level: Callable[[], Level],
    count: int,
    random: np.random.Generator,
    tell: Callable[[float], None] = lambda accepted: None,
) -> Moved:
    """``count`` points below a bound: each of ``seeds`` is the first state of a chain, and all chains move together.

    Chains differ by one in length where ``count`` is no multiple; which ones are longer is drawn.

    :param known: margins of the seeds, shape (seeds, sides).
    :param level: asked before each move. ``tell``: called after each move with the share that was accepted.
    """
    lengths = np.full(len(seeds), count // len(seeds))
    lengths[random.permutation(len(seeds))[: count % len(seeds)]] += 1
    points, values = [seeds.take(lengths > 0)], [known[lengths > 0]]
    state, value, lengths = points[0], values[0], lengths[lengths > 0]
    proposed = accepted = 0
    for step in range(1, int(lengths.max(initial=0))):
        left = lengths > step
        state, value, lengths = state.take(left), value[left], lengths[left]
        now = level()
        candidates = now.propose(state, random)
        found = margins(candidates)
        is_taken = found[:, side] < now.bound
        both = join_points([state, candidates])
        state = both.take(np.arange(len(state)) + len(state) * is_taken)
        value = np.where(is_taken[:, None], found, value)
        points.append(state)
        values.append(value)
        proposed, accepted = proposed + len(state), accepted + int(is_taken.sum())
        tell(float(is_taken.mean()))
    return Moved(join_points(points), np.concatenate(values), proposed, accepted)


@dataclass(frozen=True, slots=True)
class Pilot:
    """Levels of one side, the last one with the bound 0; ``estimate`` with a bias of its own, for plans only.

    ``levels`` end above 0 where the pilot was stuck: no point has a smaller margin than others. Then ``estimate`` is 0.
    """

    levels: tuple[Level, ...]
    estimate: float
    runs: int

    @property
    def is_whole(self) -> bool:
        """Whether it came to the bound 0."""
        return bool(self.levels) and self.levels[-1].bound <= 0


def find_levels(
    margins: Margins, side: int, plain: Points, known: Floats, count: int, random: np.random.Generator
) -> Pilot:
    """The pilot of one side: bounds at the 20 % quantile, steps that aim at 44 % accepted proposals.

    Margins may be equal to each other: a bound lies just above a margin that was found, and the share is what really
    lies below it.

    :param plain, known: plain points and their margins. ``count``: points of each level.
    """
    points, values, size = plain, known[:, side], _FIRST_STEP
    estimate, runs, levels = 1.0, 0, list[Level]()
    while len(levels) < LEVELS_MAX:
        bound = _next_bound(values, levels[-1].bound if levels else np.inf)
        if bound is None:
            return Pilot(tuple(levels), 0.0, runs)
        below = values < bound
        estimate *= float(below.mean())
        if bound <= 0:
            return Pilot((*levels, Level(0.0, (1.0,) * points.draws.shape[1], 1.0)), estimate, runs)
        steps = _Steps(bound, points.take(below), size)
        moved = move_points(margins, points.take(below), known[below], side, steps.level, count, random, steps.adapt)
        points, known, values, size = moved.points, moved.margins, moved.margins[:, side], steps.size
        runs += moved.proposed
        levels.append(steps.level())
    return Pilot(tuple(levels), 0.0, runs)


def _next_bound(values: Floats, before: float) -> float | None:
    """The bound below which at least :data:`SHARE` of the margins lie, 0 if so many are below it; None: no margin lies
    further down."""
    ordered = np.sort(values)
    found = ordered[int(np.ceil(SHARE * len(values))) - 1]
    if found < 0:
        return 0.0
    bound = np.nextafter(found, np.inf)
    if bound < before and found < ordered[-1]:
        return float(bound)
    # Most margins are equal.
    lower = ordered[ordered < found]
    if not len(lower):
        return None
    return float(max(np.nextafter(lower[-1], np.inf), 0.0)) if lower[-1] >= 0 else 0.0


class _Steps:
    """Steps that follow the share of accepted proposals (Papaioannou et al. 2015, algorithm 4): those of the draws
    relative to the deviation that each has in the points below the bound."""

    def __init__(self, bound: float, below: Points, size: float) -> None:
        self.size = size
        self._bound = bound
        self._deviations = below.draws.std(axis=0) if len(below) > 1 else np.ones(below.draws.shape[1])
        self._adapted = 0

    def level(self) -> Level:
        """The level with the present steps."""
        steps = np.clip(self.size * self._deviations, 1e-3, 1.0)
        return Level(self._bound, tuple(steps.tolist()), float(np.clip(self.size, 1e-3, 1.0)))

    def adapt(self, accepted: float) -> None:
        """Take note of the share that was accepted."""
        self._adapted += 1
        self.size = float(np.clip(self.size * np.exp((accepted - ACCEPTED) / np.sqrt(self._adapted)), 0.02, 2.0))


@dataclass(frozen=True, slots=True)
class Estimate:
    """The estimate of a repetition for one side.

    ``shares``: of the points below each bound; the last one without points that belong to an earlier side. ``failing``,
    ``margins``: the points of the event, and their margins on this side.
    """

    shares: tuple[float, ...]
    runs: int
    proposed: int
    accepted: int
    failing: Points
    margins: Floats

    @property
    def p(self) -> float:
        """The probability."""
        return float(np.prod(self.shares))


def estimate_side(
    margins: Margins,
    side: int,
    levels: tuple[Level, ...],
    plain: Points,
    known: Floats,
    count: int,
    random: np.random.Generator,
) -> Estimate:
    """One repetition for one side. A point that belongs to an earlier side, too, counts there.

    :param levels: of a pilot, which has not seen these points; the last one has the bound 0.
    :param plain, known: plain points and their margins, shape (n, sides). ``count``: points of each level.
    """
    points, shares = plain, list[float]()
    proposed = accepted = 0
    for level in levels[:-1]:
        below = known[:, side] < level.bound
        shares.append(float(below.mean()))
        if not below.any():
            break
        moved = move_points(margins, points.take(below), known[below], side, lambda now=level: now, count, random)  # type: ignore[misc]
        points, known = moved.points, moved.margins
        proposed, accepted = proposed + moved.proposed, accepted + moved.accepted
    else:
        is_event = (known[:, side] < 0) & (known[:, :side] >= 0).all(axis=1)
        shares.append(float(is_event.mean()))
        return Estimate(tuple(shares), proposed, proposed, accepted, points.take(is_event), known[is_event, side])
    nothing = np.zeros(0, dtype=np.int64)
    return Estimate(tuple(shares), proposed, proposed, accepted, points.take(nothing), np.zeros(0))
