"""The plan of a hunt: a run without faults, what is searched for, and the cases in parts."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Any

from pydantic import Field

from railhil.common.command_line import ARITHMETICS, SEED_MAX, USUAL_SCENARIO
from railhil.common.errors import InputError, Words
from railhil.controller_node.controller import make_controller_node
from railhil.hunt.bounds import DRAWS, Bounds, read_bounds
from railhil.hunt.cases import STRATEGIES, HuntCase, Space, make_cases
from railhil.hunt.draws import DESCENT_RUNS, drawn_numbers
from railhil.hunt.oracle import BENCH, CONTROLLER, RULE_ID
from railhil.judge.requirements.requirement import (
    Requirement,
    check_requirements,
    named_requirements,
    scenario_requirements,
)
from railhil.scenarios.fault_list import list_disturbed_signals
from railhil.scenarios.given import (
    OPTION,
    GivenController,
    RecordedController,
    identity_of,
    is_law_name,
    named_controller,
    refuse_beside,
)
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import System
from railhil.study.faultless import can_inject_in, faultless_run
from railhil.study.manifest import one_of
from railhil.study.plan import PlanOfSubject, origin_of

RUNS_MAX = 1_000_000
#: Runs of a part: what a process does at a time, and what is lost when it is killed.
PART_RUNS = 8
#: The strategy that makes the margin of a requirement smaller over the draws of its runs.
DESCENT = "descent"
#: Code, beyond the bench's own, on which the rows depend.
OWN_CODE = ("hunt", "study/faultless.py", "study/descent.py")


@dataclass(frozen=True, slots=True)
class Request:
    """The request from the command line. ``requirements``: files, and names of systems that ship one. ``controller``:
    a law, or a controller of the user, which the command line names; it and ``arithmetic``: empty: the usual one.
    ``only``: ids of requirements, or beginnings of them; empty: all. ``what``: is searched, by the names of
    :mod:`railhil.hunt.bounds`; empty: faults. ``all``: shrink every case that violates something, and keep all.
    ``tighten``: state the tightest bounds that held."""

    scenario: Annotated[str, Field(min_length=1)] = USUAL_SCENARIO
    settings: tuple[str, ...] = ()
    requirements: tuple[str, ...] = ()
    only: tuple[str, ...] = ()
    controller: str = ""
    arithmetic: Annotated[str, one_of(("", *ARITHMETICS))] = ""
    runs: Annotated[int, Field(ge=1, le=RUNS_MAX)] = 2000
    seed: Annotated[int, Field(ge=0, le=SEED_MAX)] = 0
    strategy: Annotated[str, one_of((*STRATEGIES, DESCENT))] = "auto"
    no_shrink: bool = False
    what: tuple[str, ...] = ()
    all: bool = False
    tighten: bool = False


@dataclass(frozen=True, slots=True)
class Chunk:
    """Cases with consecutive numbers."""

    index: int
    numbers: range

    @property
    def name(self) -> str:
        """Name of its part, without suffix."""
        return f"cases-{self.index:06d}"

    @property
    def runs(self) -> int:
        """How many cases it has."""
        return len(self.numbers)


@dataclass(frozen=True)
class Plan(PlanOfSubject):
    """A hunt; to resume it, its identity must be the same. ``base``: the run without faults. ``requirements``:
    those that are searched for, besides the rules of every run."""

    request: Request
    scenario: AnyScenario
    base: RunSpec
    requirements: tuple[Requirement, ...]
    bounds: Bounds

    @cached_property
    def space(self) -> Space:
        """What cases are drawn from; for this, the run without faults is made once.

        :raises InputError, NeverBegan: it cannot be made.
        """
        system = self.scenario.installed_system
        horizon_s, sent = faultless_run(self.base)
        ports = self.bounds.ports(list_disturbed_signals(system))
        has_ports = any(name in sent for name in ports)
        words = tuple(word for word in self.bounds.words() if has_ports or word.level != "telegram")

        def can_inject(text: str) -> bool:
            return can_inject_in(system, self.base, text) and self.bounds.allows(text)

        return Space(horizon_s, ports, sent, can_inject, words, self.bounds.faults_max, self.drawn)

    @property
    def drawn(self) -> tuple[bool, ...]:
        """Which draws of a run have an effect; empty: a hunt of faults alone."""
        return drawn_numbers(self.scenario) if DRAWS in self.bounds.what else ()

    @property
    def part_runs(self) -> int:
        """Runs of a part."""
        return DESCENT_RUNS if self.request.strategy == DESCENT else PART_RUNS

    def aim(self, chunk: Chunk) -> str:
        """The requirement whose margin a part of a descent makes smaller: each in turn."""
        return self.requirements[chunk.index % len(self.requirements)].id

    def cases(self, numbers: Sequence[int]) -> tuple[HuntCase, ...]:
        """The cases with these numbers."""
        return make_cases(self.request.strategy, self.request.seed, numbers, self.space)

    def chunks(self) -> list[Chunk]:
        """All parts, in the order of the cases."""
        numbers, size = range(self.request.runs), self.part_runs
        return [Chunk(index, numbers[first : first + size]) for index, first in enumerate(numbers[::size])]

    def origin(self, chunk: Chunk) -> str:
        """The identification of a part: its hunt and its cases. A longer hunt has the same first cases."""
        return f"{self.results_origin} {chunk.name} {chunk.runs}"

    def is_searched(self, requirement: str) -> bool:
        """Whether a requirement is among those that the user has named; a defect of the bench, or a
        controller that fails, always is."""
        return requirement in (BENCH, CONTROLLER) or _is_named(requirement, self.request.only)

    @property
    def subject(self) -> dict[str, Any]:
        """Everything that determines a row."""
        law = self.base.law
        return {
            **origin_of(self.scenario, OWN_CODE, law),
            "law": law.controller,
            **law.how,
            **({} if law.given is None else {"label": law.label, **identity_of(law.given)}),
            "seed": self.request.seed,
            "strategy": self.request.strategy,
            "bounds": self.bounds.as_json(),
            "requirements": [one.as_json() for one in self.requirements],
        }

    @property
    def identity(self) -> dict[str, Any]:
        """The values that must be unchanged when the hunt is resumed."""
        asked = self.request
        return self.subject | {
            "runs": asked.runs,
            "only": list(asked.only),
            "no_shrink": asked.no_shrink,
            "all": asked.all,
        }


def make_plan(request: Request, code: Mapping[str, GivenController] | None = None) -> Plan:
    """Load what the request names, and check that its law can be made.

    :param code: controllers of the user that command line or call name; without it the request must name none.
    :raises InputError: a scenario, law or arithmetic that cannot be run, or an id of no requirement.
    """
    scenario = load_any(request.scenario, request.settings)
    system = scenario.installed_system
    law = _law(request, system, code or {})
    own = scenario_requirements(request.scenario, request.settings)
    requirements = (*own, *named_requirements(request.requirements, own))
    check_requirements(requirements, scenario)
    for one in requirements:
        if re.fullmatch(rf"{BENCH}|{CONTROLLER}|{RULE_ID}-\w+", one.id):
            allowed = f"an id other than {BENCH}, {CONTROLLER} and {RULE_ID}-n, which findings of every hunt have"
            raise InputError(one.file, "requirement.id", one.id, allowed)
    for only in request.only:
        ids = [*(one.id for one in requirements), BENCH, CONTROLLER]
        if not only or not (RULE_ID.startswith(only[:3]) or any(name.startswith(only) for name in ids)):
            allowed = ", ".join([*ids, f"{RULE_ID}-1, {RULE_ID}-2, ... (the rules of every run)"])
            raise InputError("command line", "--only", only, allowed)
    requirements = tuple(one for one in requirements if _is_named(one.id, request.only))
    base = RunSpec(request.scenario, request.settings, law, bus="local")
    if not isinstance(law.given, RecordedController):
        make_controller_node(scenario, replace(base, seed=0)).close()
    what = request.what or ((DRAWS,) if request.strategy == DESCENT else ())
    bounds = read_bounds(request.scenario, request.settings, what, list_disturbed_signals(system))
    plan = Plan(request, scenario, base, requirements, bounds)
    _check_draws(plan)
    return plan


def _law(request: Request, system: System, code: Mapping[str, GivenController]) -> LawSpec:
    """The law, or the controller of the user. Raises InputError."""
    if not is_law_name(request.controller):
        given = named_controller(request.controller, code, "hunt", OPTION)
        refuse_beside(given, {"--arithmetic": request.arithmetic or None})
        return LawSpec.of_given(given)
    if request.controller:
        system.check_law(request.controller, "command line", OPTION)
    return LawSpec(request.controller or system.law, request.arithmetic or system.arithmetic)


def _check_draws(plan: Plan) -> None:
    """Refuse a descent that has no draws or no margin, and draws that a run does not have. Raises InputError."""
    is_descent = plan.request.strategy == DESCENT
    if is_descent and plan.bounds.what != (DRAWS,):
        allowed = f"{DRAWS} alone with --strategy {DESCENT}"
        raise InputError("command line", "--what", ", ".join(plan.bounds.what), allowed)
    if is_descent and not plan.requirements:
        allowed = f"sentences: --strategy {DESCENT} makes their margins smaller"
        raise InputError("command line", "--requirements", Words("none"), allowed)
    if DRAWS in plan.bounds.what:
        drawn_numbers(plan.scenario)


def cut(plan: Plan, chunks: int) -> Plan:
    """The plan of the first parts of a hunt, which has other parts behind them."""
    return replace(plan, request=replace(plan.request, runs=chunks * plan.part_runs))


def _is_named(requirement: str, only: Sequence[str]) -> bool:
    return not only or any(requirement.startswith(one) for one in only)
