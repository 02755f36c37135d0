"""The plan of a study of a probability: a requirement, the pilot, and repetitions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from railhil.common.command_line import ARITHMETICS, SEED_MAX, USUAL_SCENARIO
from railhil.common.errors import InputError, OptionError, Words, did_you_mean
from railhil.controller_node.controller import make_controller_node
from railhil.judge.requirements.requirement import (
    Requirement,
    check_requirements,
    named_requirements,
    requirements_in,
    scenario_requirements,
    shipped_requirements,
)
from railhil.probability.interval import REPETITIONS_MIN, runs_for
from railhil.probability.limit_state import Bench, LimitState, draw_names, sides_of
from railhil.probability.sampling import LEVELS_MAX, Level, Pilot, draw_points, find_levels
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario, require_free_draws, require_perturbations
from railhil.scenarios.parameters import load_parameters
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.study.manifest import one_of
from railhil.study.perturbed_runs import how_made
from railhil.study.plan import PlanOfSubject, origin_of

RUNS_MAX = 100_000_000
#: Runs of a part of the brute force, and of one whose runs go through the nodes (chosen: about a minute).
_BRUTE_RUNS, _BRUTE_RUNS_BY_NODES = 5_000, 100
METHODS = AUTO, SUBSET, BRUTE = "auto", "subset", "brute"
#: Name of the least disturbance in the folder.
LEAST = "least.toml"
#: Runs of the descent to the least disturbance (chosen: 15 draws need about 1000).
LEAST_RUNS = 3000
#: A pilot that is stuck is made again with other points, so many times in all.
_PILOTS = 3
#: Id of the sentence of ``--says``.
_SAID = "SAID"
#: Random numbers of the pilot; the repetitions have their numbers from 0 on.
_PILOT_STREAM, _REPETITION_STREAM = 0, 1
#: Code, beyond the bench's own, on which the rows depend.
OWN_CODE = ("probability",)


@dataclass(frozen=True, slots=True)
class Request:
    """The request from the command line.

    ``requirement``: its id, in the scenario or in ``requirements`` (files, and names of systems that ship one; none:
    what the scenario's system ships); ``says``: a sentence instead. ``controller``, ``arithmetic``, ``parameters``:
    empty: the usual one. ``points``: of each level of a repetition.
    """

    scenario: Annotated[str, Field(min_length=1)] = USUAL_SCENARIO
    settings: tuple[str, ...] = ()
    requirements: tuple[str, ...] = ()
    requirement: str = ""
    says: str = ""
    controller: str = ""
    arithmetic: Annotated[str, one_of(("", *ARITHMETICS))] = ""
    parameters: str = ""
    accuracy: Annotated[float, Field(gt=0, le=10)] = 0.3
    max_runs: Annotated[int, Field(ge=1000, le=RUNS_MAX)] = 1_000_000
    points: Annotated[int, Field(ge=100, le=100_000)] = 1000
    method: Annotated[str, one_of(METHODS)] = AUTO
    at_most: Annotated[float, Field(ge=0, le=1)] = 1.0
    seed: Annotated[int, Field(ge=0, le=SEED_MAX)] = 0


@dataclass(frozen=True, slots=True)
class Design:
    """What the pilot has fixed. ``levels``: of each side; none: brute force. ``runs``: of the pilot."""

    levels: tuple[tuple[Level, ...], ...]
    estimate: float
    runs: int
    repetition_runs: int


@dataclass(frozen=True, slots=True)
class Chunk:
    """One repetition. ``rows``: one for each side."""

    index: int
    runs: int

    @property
    def name(self) -> str:
        """Name of its part, without suffix."""
        return f"repetition-{self.index:05d}"


@dataclass(frozen=True)
class Plan(PlanOfSubject):
    """A study of a probability; to resume it, its identity must be the same. ``more``: repetitions (or parts of the
    brute force), None: as many as the pilot says."""

    request: Request
    scenario: AnyScenario
    bench: Bench
    requirement: Requirement
    more: int | None = None

    @cached_property
    def state(self) -> LimitState:
        """The bench as a function of vectors. Raises InputError."""
        return LimitState(self.bench, self.scenario)

    @cached_property
    def design(self) -> Design:
        """The pilot is made once.

        :raises InputError: the law has failed.
        """
        asked, random = self.request, self.random(_PILOT_STREAM, 0)
        if asked.method == BRUTE:
            return Design((), 0.0, 0, self._brute_runs)
        pilots: list[Pilot] = []
        runs = 0
        for side in range(len(self.bench.sides)):
            for _ in range(_PILOTS):
                plain = draw_points(asked.points, len(self.state.names), True, random)
                found = find_levels(self.state, side, plain, self.state(plain), asked.points, random)
                runs += asked.points + found.runs
                # One that is only far away would be as far with other points.
                if found.is_whole or len(found.levels) == LEVELS_MAX:
                    break
            pilots.append(found)
        estimate = sum(pilot.estimate for pilot in pilots)
        each = asked.points + sum(pilot.runs for pilot in pilots)
        levels = tuple(pilot.levels for pilot in pilots)
        # Margins of two values, as some levels have them, show no way.
        is_blind = not all(levels)
        is_frequent = estimate > 0 and runs_for(estimate, asked.accuracy) <= REPETITIONS_MIN * each
        if asked.method == AUTO and (is_blind or is_frequent):
            return Design((), estimate, runs, self._brute_runs)
        return Design(levels, estimate, runs, each)

    @property
    def _brute_runs(self) -> int:
        return _BRUTE_RUNS if self.state.is_fast else _BRUTE_RUNS_BY_NODES

    @property
    def repetitions(self) -> int:
        """Number of repetitions, or of parts of the brute force."""
        if self.more is not None:
            return self.more
        design, most = self.design, self.most_repetitions
        if design.levels:
            return min(REPETITIONS_MIN, most)
        p = design.estimate or 1 / self.request.max_runs
        # A tenth more: the pilot's estimate is a rough one. Where all of its runs violate, none would be needed.
        return min(max(1, -(-int(1.1 * runs_for(p, self.request.accuracy)) // design.repetition_runs)), most)

    @property
    def most_repetitions(self) -> int:
        """Number of repetitions that the greatest number of runs allows."""
        # The first repetition has as many further runs, with new noise, as it has plain ones.
        design = self.design
        other = design.runs + (self.request.points if design.levels else design.repetition_runs)
        other += LEAST_RUNS if self.state.is_fast else 0
        return max(1, (self.request.max_runs - other) // design.repetition_runs)

    def random(self, stream: int, number: int) -> np.random.Generator:
        """The random numbers of the pilot or of a repetition."""
        return np.random.default_rng([self.request.seed, stream, number])

    def repetition_random(self, number: int) -> np.random.Generator:
        """The random numbers of a repetition."""
        return self.random(_REPETITION_STREAM, number)

    def chunks(self) -> list[Chunk]:
        """All parts."""
        rows = len(self.bench.sides) if self.design.levels else 1
        return [Chunk(index, rows) for index in range(self.repetitions)]

    @property
    def subject(self) -> dict[str, Any]:
        # With more runs it goes on; the bound of a judgement may change.
        law = self.bench.base.law
        asked = self.request
        return {
            **origin_of(self.scenario, OWN_CODE, law),
            "law": law.label,
            **law.how,
            "parameters_sha256": None if law.parameters is None else law.parameters.sha256,
            "requirement": self.requirement.as_json(),
            "seed": asked.seed,
            "points": asked.points,
            "method": asked.method,
            "accuracy": asked.accuracy,
        }

    def grown(self, repetitions: int) -> Plan:
        """The same with another number of repetitions; what the pilot has found is kept."""
        found = replace(self, more=repetitions)
        found.__dict__.update({name: self.__dict__[name] for name in ("state", "design") if name in self.__dict__})
        return found


def make_plan(request: Request) -> Plan:
    """Load what the request names, and check that its law can be made.

    :raises InputError: a scenario, law or requirement that cannot be run, or a scenario that draws nothing.
    """
    scenario = load_any(request.scenario, request.settings)
    system = scenario.installed_system
    if not scenario.faults:
        require_perturbations(scenario, "probability")
    require_free_draws(scenario, "probability", wholly=True)
    if not any(draw_names(scenario)):
        require_perturbations(scenario, "probability")
    parameters = load_parameters(Path(request.parameters)) if request.parameters else None
    controller = request.controller or (parameters.law if parameters is not None else system.law)
    system.check_law(controller, "command line", "--controller")
    if parameters is not None and parameters.law != controller:
        raise InputError(parameters.source, "law", parameters.law, f"{controller}, the law of --controller")
    law = LawSpec(controller, request.arithmetic or system.arithmetic, parameters=parameters)
    requirement = _requirement(request, scenario)
    if requirement.when == "none" and scenario.faults:
        found = Words(f"{requirement.id} is about runs without faults")
        raise InputError("command line", "--requirement", found, "a scenario without faults, or another requirement")
    sides = sides_of(requirement)
    check_requirements((requirement,), scenario)
    for side in sides:
        check_requirements((side,), scenario)
    base = RunSpec(request.scenario, request.settings, law, bus="local")
    make_controller_node(scenario, replace(base, seed=0)).close()
    return Plan(request, scenario, Bench(base, sides), requirement)


def find_making(plan: Plan) -> tuple[str, str | None]:
    """A remark on the making of the runs (empty: none), and the module with compiled loops (None: nothing is
    compiled)."""
    if plan.state.is_fast:
        return how_made(plan.scenario)
    # A journey of a minute or two takes half a second.
    hours = plan.request.max_runs / 2 / 3600
    return f"every run goes through the nodes, about two a second and core: up to {hours:.3g} h with --max-runs", None


def _requirement(request: Request, scenario: AnyScenario) -> Requirement:
    if bool(request.says) == bool(request.requirement):
        raise OptionError("--requirement, --says", "one of them is needed: the id of a requirement, or a sentence")
    if request.says:
        if request.requirements:
            raise OptionError("--requirements", "used only with --requirement")
        tables = {"requirement": [{"id": _SAID, "says": request.says}]}
        return requirements_in(tables, "command line --says")[0]
    own = scenario_requirements(request.scenario, request.settings)
    words = request.requirements
    if not words and request.requirement not in (one.id for one in own):
        shipped_requirements(scenario.system)
        words = (scenario.system,)
    known = {one.id: one for one in (*named_requirements(words, own), *own)}
    if request.requirement not in known:
        hint = did_you_mean(request.requirement, known)
        raise InputError("command line", "--requirement", request.requirement, f"one of {', '.join(known)}", hint)
    return known[request.requirement]
