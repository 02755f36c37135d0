"""The bench as a function of vectors: runs with given draws and noise, and the margins of a requirement in them.

Below 0: the run violates it. A requirement on scores alone goes through the batch of the system; any other one, and a
scenario with a fault that needs the nodes, goes through the nodes, one run after the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from railhil.batch.case import Case
from railhil.batch.nodes import batch_of
from railhil.common.errors import InputError, Words
from railhil.judge.requirements import syntax
from railhil.judge.requirements.outcome import SIZE_MIN, judge_requirements
from railhil.judge.requirements.parser import parse_sentence
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.requirements.scores import score_margins
from railhil.judge.result import Result
from railhil.probability.sampling import Floats, Points
from railhil.run.local import unrecorded_run
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec


def sides_of(requirement: Requirement) -> tuple[Requirement, ...]:
    """The sentences of the two sides of ``abs(x) <= limit``, of which one is violated if the whole is; else the
    requirement itself.

    Each side has one most probable point: apart they are found with fewer runs.
    """
    sentence = parse_sentence(requirement.says)
    body = sentence.body
    if not isinstance(body, syntax.Always | syntax.Never | syntax.At) or getattr(body, "longer", None) is not None:
        return (requirement,)
    compare = body.condition
    if not isinstance(compare, syntax.Compare):
        return (requirement,)
    sizes = [node for node in (compare.left, compare.right) if isinstance(node, syntax.Call) and node.function == "abs"]
    # The size is at most the limit: `always abs(x) <= limit`, `never abs(x) > limit`, or the other way about.
    wanted = ("<", "<=") if not isinstance(body, syntax.Never) else (">", ">=")
    turned = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}.get(compare.sign, "")
    if len(sizes) != 1 or (compare.sign if sizes[0] is compare.left else turned) not in wanted:
        return (requirement,)
    text, size, (inner,) = requirement.says, sizes[0], sizes[0].values
    value = text[inner.column : inner.after]
    texts = [f"{text[: size.column]}{put}{text[size.after :]}" for put in (f"({value})", f"-({value})")]
    return tuple(replace(requirement, says=says) for says in texts)


#: Margin of a run that violates a sentence whose sides are equal.
_EQUAL = -float(np.finfo(np.float64).tiny)


@dataclass(frozen=True)
class Bench:
    """A run, and the sides of a requirement. It is sent to workers."""

    base: RunSpec
    sides: tuple[Requirement, ...]

    def spec(self, draws: Sequence[float], noise: Sequence[tuple[int, float]]) -> RunSpec:
        """A run with these draws (of the scenario's order) and this noise."""
        given = f"draws={list(map(float, draws))}", f"noise={[[seed, weight] for seed, weight in noise]}"
        return replace(self.base, settings=(*self.base.settings, *given))

    def run(self, draws: Sequence[float], noise: Sequence[tuple[int, float]]) -> Result:
        """The same run through the nodes. Raises InputError."""
        spec = self.spec(draws, noise)
        return unrecorded_run(spec.load(), spec)

    def margins_of(self, result: Result) -> list[float]:
        """The margin of each side in a run; infinite where the run does not say."""
        outcomes = judge_requirements(result.as_record(), self.sides)
        margins = []
        for outcome in outcomes:
            margin = np.inf if outcome.margin is None else outcome.margin
            # A margin of 0 is shown where the sides of a comparison are equal.
            margins.append(_EQUAL if outcome.violated and margin >= 0 else margin)
        return margins


class LimitState:
    """Margins of the runs of a bench.

    ``all_names``: of all draws, None where the scenario has no distribution; ``names``: of the others, which alone are
    sampled, and ``drawn``: their places.
    ``silent``: number of runs so far that say nothing about the requirement, which count as runs that keep it.

    :raises InputError: numba is missing, or the law does not fit.
    """

    def __init__(self, bench: Bench, scenario: AnyScenario) -> None:
        self._bench = bench
        names = draw_names(scenario)
        self.all_names = names
        self.drawn = np.array([place for place, name in enumerate(names) if name], dtype=np.int64)
        self.names = tuple(name for name in names if name)
        self.silent = 0
        own = [score_margins(side, scenario) for side in bench.sides] if batch_of(scenario) is not None else [None]
        self._of_scores = [margins for margins in own if margins is not None]
        self.is_fast = len(self._of_scores) == len(bench.sides)
        made = scenario.installed_system.optional_part("vectors") if self.is_fast else None
        self._runs = None if made is None else made(Case(scenario, bench.base.law))
        self.is_fast = self._runs is not None

    def whole_draws(self, points: Points) -> Floats:
        """All draws of runs in the scenario's order, shape (n, draws); those that it does not draw are 0."""
        found = np.zeros((len(points), len(self.all_names)))
        found[:, self.drawn] = points.draws
        return found

    def __call__(self, points: Points) -> Floats:
        """Margins, shape (n, sides).

        :raises InputError: the law has failed.
        """
        draws, chains = self.whole_draws(points), points.chains()
        if self._runs is not None:
            scores = self._runs.run(draws, chains)
            found = np.stack([margins(scores) for margins in self._of_scores], axis=1)
            # As through the nodes.
            found = np.where(np.abs(found) < SIZE_MIN, np.where(found < 0, _EQUAL, 0.0), found)
        else:
            pairs = zip(draws, chains, strict=True)
            found = np.array([self._bench.margins_of(self._bench.run(one, noise)) for one, noise in pairs])
            found = found.reshape(len(points), len(self._bench.sides))
        unknown = ~np.isfinite(found)
        self.silent += int(unknown.any(axis=1).sum())
        return np.where(unknown, np.inf, found)


def draw_names(scenario: AnyScenario) -> tuple[str | None, ...]:
    """The names of the draws of its runs, in their order; None: it has no distribution.

    :raises InputError: runs of its system take no draws.
    """
    found = scenario.installed_system.optional_part("draws")
    if found is None:
        named = Words(f"{scenario.name}, a scenario of system {scenario.system}")
        allowed = "a scenario of a system whose runs can be given draws and noise, such as ato"
        raise InputError("command line", "scenario", named, allowed)
    names: tuple[str | None, ...] = found(scenario)
    return names
