"""The search: differential evolution within the bounds declared by a law, with the same number of evaluations for every
law.

Candidates are rounded to six significant digits *before* they are evaluated, so the file holds exactly the evaluated
values. A parameter whose bounds are positive and a factor of ten or more apart is searched on a logarithmic scale.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import differential_evolution

from railhil.common.errors import InputError, Words
from railhil.controller_node.laws import find
from railhil.controller_node.laws.base import ControlLaw
from railhil.scenarios import streams
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec
from railhil.tuning.objective import Scale
from railhil.tuning.trials import Trials

#: Differential evolution needs five candidates to choose from.
_POPULATION_MIN, _POPULATION_MAX = 5, 40
#: Ratio of bounds from which the search is logarithmic.
_WIDE = 10.0
#: Share of the range that counts as being at its bound.
_EDGE = 0.02


@dataclass(frozen=True, slots=True)
class Protocol:
    """The law to tune, the training runs and the budget; the law computes in double precision."""

    scenario: AnyScenario
    law: LawSpec
    seeds: tuple[int, ...] = tuple(range(8))
    budget: int = 800
    search_seed: int = 0

    @property
    def law_class(self) -> type[ControlLaw[Any, Any]]:
        """The law's class.

        :raises InputError: the scenario's system has no such law.
        """
        kind: type[ControlLaw[Any, Any]] = find(self.law.controller, self.scenario.installed_system.laws, ControlLaw)
        return kind

    @property
    def box(self) -> Box:
        """The box of the search.

        :raises InputError: as :attr:`law_class`, or the law declares no usable bounds.
        """
        return Box.of(self.law.controller, self.law_class)

    @property
    def population(self) -> int:
        """Candidates per generation, independent of the number of parameters."""
        return min(max(math.isqrt(2 * self.budget), _POPULATION_MIN), _POPULATION_MAX)

    @property
    def generations(self) -> int:
        """Generations, including the first population."""
        return self.budget // self.population


@dataclass(frozen=True, slots=True)
class Found:
    """The best parameters, and how they were found; ``complete`` is false after Ctrl-C.

    ``laid_aside``: the reason why the evaluation on other runs discarded the best parameters. ``values`` are then the
    law's own.
    """

    values: Mapping[str, float]
    objective: float
    objective_default: float
    scale: Scale
    evaluations: int
    infeasible: int
    complete: bool
    laid_aside: str = ""


@dataclass(frozen=True, slots=True)
class Box:
    """The bounds of a law's parameters, mapped to the unit cube."""

    names: tuple[str, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    default: tuple[float, ...]

    @classmethod
    def of(cls, law: str, kind: type[ControlLaw[Any, Any]]) -> Box:
        """Box of a law.

        :param law: name by which it was requested; ``kind``: its class.
        :raises InputError: it declares no tunable parameters, or bounds that no search can use.
        """
        if not kind.tunable:
            raise InputError("command line", "LAW", law, "a law that declares tunable parameters")
        defaults = kind.parameters_type()
        for name, bounds in kind.tunable.items():
            if not _are_bounds(bounds) or not _is_number(getattr(defaults, name, None)):
                allowed = "a number among the law's parameters, with two finite bounds, the lower one first"
                raise InputError("controller", f"{law}.tunable.{name}", bounds, allowed)
        low, high = zip(*kind.tunable.values(), strict=True)
        return cls(tuple(kind.tunable), low, high, tuple(getattr(defaults, name) for name in kind.tunable))

    def candidate(self, point: Sequence[float]) -> dict[str, float]:
        """Parameters at a point of the unit cube, rounded to six digits."""
        scaled = [_from_unit(low, high, x) for low, high, x in zip(self.low, self.high, point, strict=True)]
        return {name: float(f"{value:.6g}") for name, value in zip(self.names, scaled, strict=True)}

    def point(self, values: Sequence[float]) -> list[float]:
        """Parameters as a point of the unit cube; values outside are moved to the nearest bound."""
        points = [_to_unit(*given) for given in zip(self.low, self.high, values, strict=True)]
        return [min(max(x, 0.0), 1.0) for x in points]

    def at_bounds(self, values: Mapping[str, float]) -> list[str]:
        """Names of the parameters that a search has moved to a bound: a wider bound might give a better result."""
        point = self.point([values[name] for name in self.names])
        return [name for name, x in zip(self.names, point, strict=True) if not _EDGE <= x <= 1 - _EDGE]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _are_bounds(given: Any) -> bool:
    return isinstance(given, tuple | list) and len(given) == 2 and all(map(_is_number, given)) and given[0] < given[1]


def _wide(low: float, high: float) -> bool:
    return low > 0 and high / low >= _WIDE


def _from_unit(low: float, high: float, x: float) -> float:
    return low * (high / low) ** x if _wide(low, high) else low + (high - low) * x


def _to_unit(low: float, high: float, value: float) -> float:
    if _wide(low, high):
        return math.log(max(value, low) / low) / math.log(high / low)
    return (value - low) / (high - low)


def _first_population(box: Box, size: int, random: np.random.Generator) -> NDArray[np.float64]:
    """The default parameters, and a Latin hypercube around them."""
    columns = [(random.permutation(size) + random.random(size)) / size for _ in box.names]
    population = np.column_stack(columns)
    population[0] = box.point(box.default)
    return population


class _Best:
    """Evaluates generations and keeps the best candidate so far, beginning with the law's own parameters."""

    def __init__(self, box: Box, trials: Trials, progress: Callable[[int, float], None]) -> None:
        self._box = box
        self.trials = trials
        self._progress = progress
        self.values: Mapping[str, float] = dict(zip(box.names, box.default, strict=True))
        own = trials.of_defaults()
        self.objective = self.objective_default = math.inf if own is None else own
        self.evaluations = self.infeasible = 0

    def generation(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Objectives at points of the unit cube, shape (parameters, candidates); infinite where the law cannot be
        made."""
        candidates = [self._box.candidate(point) for point in points.T.tolist()]
        objectives = self.trials.of(candidates)
        for values, found in zip(candidates, objectives, strict=True):
            if found is not None and found < self.objective:
                self.values, self.objective = values, found
        self.evaluations += len(candidates)
        self.infeasible += objectives.count(None)
        self._progress(self.evaluations, self.objective)
        return np.array([np.inf if found is None else found for found in objectives])


def _spoken(name: str) -> str:
    return name.rpartition("_")[0].replace("_", " ") or name


def _hopeless(protocol: Protocol, best: _Best) -> InputError:
    """The error if no candidate gave a valid law: the reason, and the parameters that cause it but are not searched."""
    (reason, _), *_ = best.trials.refusals.most_common(1)
    law, kind = protocol.law.controller, protocol.law_class
    fixed = [field.name for field in fields(kind.parameters_type) if field.name not in kind.tunable]
    words = reason.replace("_", " ")
    # A reason names a parameter literally, or in words and without its unit.
    named = [name for name in fixed if name.replace("_", " ") in words or _spoken(name) in words] or fixed
    found = Words(f"no law among {best.evaluations} candidates nor with its own parameters")
    hint = f"{reason}; not searched, so that no candidate can mend it: {', '.join(named)}"
    return InputError("tune", law, found, "parameters with which the law can be made for this scenario", hint)


def search(protocol: Protocol, progress: Callable[[int, float], None] = lambda evaluations, best: None) -> Found:
    """The best parameters found within the budget, never worse on the training runs than the law's own.

    Deterministic for one version of scipy. Ctrl-C ends the search; completed generations count.

    :param progress: called after each generation with the evaluations so far and the best objective.
    :raises InputError: the law is unknown, has no tunable parameters, or does not support the scenario or the indexing
        with any candidate.
    """
    box = protocol.box
    best = _Best(box, Trials(protocol.scenario, protocol.law, protocol.seeds), progress)
    random = streams.generator(protocol.search_seed, streams.TUNING)
    settings: dict[str, Any] = {
        # No tolerance and no local search: only the budget ends the search.
        "tol": 0.0,
        "atol": 0.0,
        "polish": False,
        "updating": "deferred",
        "vectorized": True,
    }
    complete = True
    try:
        differential_evolution(
            best.generation,
            [(0.0, 1.0)] * len(box.names),
            maxiter=protocol.generations - 1,
            init=_first_population(box, protocol.population, random),
            seed=random,
            **settings,
        )
    except KeyboardInterrupt:
        complete = False
    if math.isinf(best.objective):
        raise _hopeless(protocol, best)
    return Found(
        best.values,
        best.objective,
        best.objective_default,
        best.trials.scale,
        best.evaluations,
        best.infeasible,
        complete,
    )
