"""Cases of a hunt: a case is data, made from the seed of the hunt and its number alone."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from railhil.faults.model import Word
from railhil.faults.random_faults import (
    APART_S,
    BEGIN_SHARE,
    Ports,
    Sent,
    random_faults,
    word_subset,
    words_drawn,
)
from railhil.hunt.draws import Draws, random_draws

#: Faults of a case by each strategy, smallest and largest number.
_RANDOM_FAULTS, _SWARM_FAULTS = (1, 2), (2, 5)
#: Swarm: most levels of the fault language in a case, and most ports.
_LEVELS_MAX, _PORTS_MAX = 4, 3
#: Swarm: shortest and longest time between two beginnings, in s; drawn evenly over its logarithm.
_GAPS_S = (0.01, 5.0)
#: Swarm: draws of faults from one subset; a subset of which the run can inject nothing is drawn again.
_TRIES = 60
#: Cases of ``auto`` in turn.
_TURN = ("swarm", "swarm", "random")


@dataclass(frozen=True, slots=True)
class Space:
    """What cases are drawn from: the duration of the timetable in s; the ports on which faults may act, with their
    signals; those that a run without faults sends; whether a fault keeps to the bounds and a run can inject it; the
    words that are drawn; the most faults of a case; which draws of a run have an effect, if they are drawn."""

    horizon_s: float
    ports: Ports
    sent: Mapping[str, Sent]
    can_inject: Callable[[str], bool]
    words: tuple[Word, ...] = field(default_factory=words_drawn)
    faults_max: int = 5
    drawn: tuple[bool, ...] = ()


@dataclass(frozen=True, slots=True)
class HuntCase:
    """One case. ``strategy``: that made it; ``seed``: of the run's noise; ``draws``: of the scenario's perturbations,
    standard normal numbers; empty: the run is not perturbed."""

    number: int
    strategy: str
    seed: int
    faults: tuple[str, ...]
    draws: Draws = ()


def _random(chance: random.Random, space: Space) -> list[str]:
    """One or two faults of any kind, about a second apart: those of ``railhil faults --pairs``."""
    begin_s = chance.uniform(0.0, BEGIN_SHARE * space.horizon_s)

    def apart_s() -> float:
        return chance.expovariate(1.0 / APART_S)

    count = min(chance.randint(*_RANDOM_FAULTS), space.faults_max)
    return random_faults(chance, begin_s, count, apart_s, space.ports, space.sent, space.words, space.can_inject)


def _swarm(chance: random.Random, space: Space) -> list[str]:
    """Two to five faults of a few kinds at a few places: they meet each other more often."""

    def apart_s() -> float:
        low_s, high_s = _GAPS_S
        return float(low_s * (high_s / low_s) ** chance.random())

    some_ports = {name: space.ports[name] for name in space.ports if name in space.sent}
    count = min(chance.randint(*_SWARM_FAULTS), space.faults_max)
    while True:
        words, ports = word_subset(chance, space.words, some_ports, _LEVELS_MAX, _PORTS_MAX)
        begin_s = chance.uniform(0.0, BEGIN_SHARE * space.horizon_s)
        found = random_faults(chance, begin_s, count, apart_s, ports, space.sent, words, space.can_inject, _TRIES)
        if found:
            return found


_STRATEGIES: Mapping[str, Callable[[random.Random, Space], list[str]]] = {"random": _random, "swarm": _swarm}
#: Names of the strategies; ``auto`` takes the others in turn.
STRATEGIES = ("auto", *_STRATEGIES)


def make_case(strategy: str, seed: int, number: int, space: Space) -> HuntCase:
    """A case, the same for the same arguments.

    :param strategy: one of :data:`STRATEGIES`.
    :param number: of the case in the hunt, from 0; it is also the seed of the run.
    """
    if strategy == "auto":
        strategy = _TURN[number % len(_TURN)]
    chance = random.Random(f"railhil hunt {strategy} {seed} {number}")
    faults = _STRATEGIES[strategy](chance, space) if space.words else []
    return HuntCase(number, strategy, number, tuple(faults), random_draws(seed, number, space.drawn))


def make_cases(strategy: str, seed: int, numbers: Sequence[int], space: Space) -> tuple[HuntCase, ...]:
    """The cases with these numbers."""
    return tuple(make_case(strategy, seed, number, space) for number in numbers)
