"""The plan of ``railhil learn``: a law with a memory, seeds of sequences, runs of each, and their chunks."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from railhil.common.command_line import INDEXINGS, SEED_MAX
from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic import names as arithmetics
from railhil.controller_node.law_controller import maker_of
from railhil.controller_node.laws import find
from railhil.controller_node.laws.memory import require_memory
from railhil.judge.judging import Judging, judging_of
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import load_parameters
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.sequences.one import sequence_batch_of
from railhil.study.manifest import one_of
from railhil.study.perturbed_runs import check_unseen
from railhil.study.plan import PlanOfSubject, origin_of

#: The usual scenario: its law learns from run to run.
SCENARIO = "yizhuang_stop"
RUNS_MAX, SEQUENCES_MAX, CHUNK_MAX = 10_000, 1_000_000, 1_000
#: Code, beyond the bench's own, on which the rows depend.
OWN_CODE = ("sequences",)
#: Sequences per part: where runs are made one by one, and where they are made together.
_CHUNK, _CHUNK_TOGETHER = 5, 25
_OTHERS = "another --seed, of runs on which no parameters were tuned or chosen"


@dataclass(frozen=True, slots=True)
class Request:
    """The request from the command line. Files have absolute paths, so that it can be resumed from any folder."""

    scenario: Annotated[str, Field(min_length=1)] = SCENARIO
    settings: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()
    controller: str = ""
    arithmetic: Annotated[str, one_of(arithmetics)] = "float64"
    indexing: Annotated[str, one_of(INDEXINGS)] = "time"
    parameters: str | None = None
    nominal: bool = False
    runs: Annotated[int, Field(ge=1, le=RUNS_MAX)] = 15
    sequences: Annotated[int, Field(ge=1, le=SEQUENCES_MAX)] = 150
    seed: Annotated[int, Field(ge=0, le=SEED_MAX)] = 1000
    #: 0: as many as suits the system; a plan has the number.
    chunk: Annotated[int, Field(ge=1, le=CHUNK_MAX)] = 0


@dataclass(frozen=True, slots=True)
class Chunk:
    """Consecutive sequences: the unit of work, of repetition and of loss."""

    index: int
    sequences: tuple[int, ...]
    runs_each: int

    @property
    def name(self) -> str:
        """Name of its part, without suffix."""
        return f"sequences-{self.index:05d}"

    @property
    def runs(self) -> int:
        """Number of runs."""
        return len(self.sequences) * self.runs_each


def run_specs(base: RunSpec, scenario: AnyScenario, seed: int, runs: int) -> list[RunSpec]:
    """The runs of a sequence, in order.

    In a system whose runs have no numbers, each run has a seed of its own instead: the sequence's seed and the next
    ones.

    :param base: any of its runs.
    :param seed: of the sequence.
    """
    if scenario.installed_system.numbered:
        return [replace(base, seed=seed, run_number=number + 1) for number in range(runs)]
    return [replace(base, seed=seed + number) for number in range(runs)]


@dataclass(frozen=True, slots=True)
class Plan(PlanOfSubject):
    """Sequences to be run; to resume them, the identity must be the same."""

    request: Request
    scenario: AnyScenario
    law: LawSpec

    @property
    def judging(self) -> Judging:
        """The system's part that judges the runs."""
        return judging_of(self.scenario)

    @property
    def perturbed(self) -> bool:
        """Whether the runs draw the scenario's perturbations."""
        return not self.request.nominal and self.scenario.can_be_perturbed

    @property
    def base(self) -> RunSpec:
        """A run of any sequence."""
        asked = self.request
        return RunSpec(
            asked.scenario, asked.settings, self.law, perturbed=self.perturbed, bus="local", faults=asked.faults
        )

    @property
    def seeds(self) -> range:
        """Seeds of the sequences: so far apart that no two runs have the same random numbers."""
        return sequence_seeds(self.scenario, self.request.seed, self.request.sequences, self.request.runs)

    def specs(self, seed: int) -> list[RunSpec]:
        """The runs of the sequence with this seed."""
        return run_specs(self.base, self.scenario, seed, self.request.runs)

    def chunks(self) -> list[Chunk]:
        """All chunks."""
        step = self.request.chunk
        starts = range(0, len(self.seeds), step)
        return [
            Chunk(index, tuple(self.seeds[start : start + step]), self.request.runs)
            for index, start in enumerate(starts)
        ]

    @property
    def subject(self) -> dict[str, Any]:
        given = self.law.parameters
        return asdict(self.request) | {
            "perturbed": self.perturbed,
            "parameters": None if given is None else given.sha256,
            **origin_of(self.scenario, OWN_CODE, self.law),
        }


def sequence_seeds(scenario: AnyScenario, first: int, sequences: int, runs: int) -> range:
    """Seeds of sequences, see :func:`run_specs`."""
    apart = 1 if scenario.installed_system.numbered else runs
    return range(first, first + sequences * apart, apart)


def make_plan(request: Request) -> Plan:
    """Load everything that the request names and check that the law can be made, and keeps a memory.

    :raises InputError: a scenario, law, parameter file or seed that cannot be run.
    """
    scenario = load_any(request.scenario, request.settings, request.faults)
    system = scenario.installed_system
    name = request.controller or scenario.usual_law
    system.check_law(name, "command line", "--controller")
    require_memory(name, {law: find(law, system.laws) for law in system.law_names()}, scenario)
    parameters = None if request.parameters is None else load_parameters(Path(request.parameters))
    law = LawSpec(name, request.arithmetic, request.indexing, parameters)
    if not request.chunk:
        request = replace(request, chunk=_CHUNK if sequence_batch_of(scenario) is None else _CHUNK_TOGETHER)
    plan = Plan(request, scenario, law)
    last = plan.specs(plan.seeds[-1])[-1].seed
    if last > SEED_MAX:
        raise InputError("command line", "--seed", Words(f"last seed {last}"), f"at most {SEED_MAX}")
    _check_unseen(plan, last)
    plan.base.load()
    maker_of(system, scenario)
    system.part("controller")(scenario, law)
    return plan


def _check_unseen(plan: Plan, last: int) -> None:
    """Refuse seeds on which the law's parameters were tuned or chosen: learning there is no evaluation.

    :param last: seed of the last run.
    :raises InputError: there is such a seed.
    """
    # Runs that are not perturbed draw nothing else, so only a file can be from the same runs.
    drawn = plan.perturbed or plan.scenario.every_run_is_drawn
    seeds = range(plan.seeds.start, last + 1)
    if drawn:
        check_unseen(plan.scenario, plan.law, seeds, "--seed", _OTHERS)
    elif plan.law.parameters is not None:
        plan.law.parameters.check_unseen(seeds, _OTHERS)
