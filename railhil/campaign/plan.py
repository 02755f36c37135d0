"""The plan of a campaign: a scenario, laws with their parameters, seeds, and their division into chunks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any
from urllib.parse import quote

from pydantic import AfterValidator, Field

from railhil.batch.nodes import batch_of
from railhil.common.command_line import INDEXINGS, SEED_MAX, USUAL_SCENARIO
from railhil.common.errors import InputError, Words, did_you_mean
from railhil.controller_node.arithmetic import names as arithmetics
from railhil.controller_node.controller import make_controller_node
from railhil.judge.criteria import Criterion
from railhil.judge.judging import Judging, judging_of
from railhil.scenarios.given import GivenController, RecordedController, identity_of, is_law_name, named_controller
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario, require_free_draws, require_perturbations
from railhil.scenarios.parameters import ParameterSet, load_parameters
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import names as system_names
from railhil.scenarios.system import system_named
from railhil.study.manifest import one_of
from railhil.study.perturbed_runs import FIRST_SEED, check_unseen, training_seeds
from railhil.study.plan import PlanOfSubject, law_sha256, origin_of

#: Stands for every registered law, in the order of the tables; the others are compared with the first.
ALL_LAWS = "all"
RUNS_MAX = 10_000_000
CHUNK_MAX = 10_000


#: The controllers of the user that a command line or a call names, by their texts.
Code = Mapping[str, GivenController]


def _check_law(text: str) -> str:
    """Laws of all installed systems, and texts of code; whether one fits is seen when the plan is made."""
    known = [*dict.fromkeys(law for name in system_names() for law in system_named(name).law_names()), ALL_LAWS]
    if is_law_name(text) and text not in known:
        raise ValueError(f"one of {', '.join(known)}")
    return text


@dataclass(frozen=True, slots=True)
class Request:
    """The request from the command line. Files have absolute paths, so that a campaign can be resumed from any
    folder."""

    scenario: Annotated[str, Field(min_length=1)] = USUAL_SCENARIO
    settings: tuple[str, ...] = ()
    runs: Annotated[int, Field(ge=1, le=RUNS_MAX)] = 1000
    first_seed: Annotated[int, Field(ge=0, le=SEED_MAX)] = FIRST_SEED
    laws: tuple[Annotated[str, AfterValidator(_check_law)], ...] = ()
    both: bool = False
    arithmetic: Annotated[str, one_of(arithmetics)] = "float64"
    indexing: Annotated[str, one_of(INDEXINGS)] = "time"
    parameters: tuple[str, ...] = ()
    chunk: Annotated[int, Field(ge=1, le=CHUNK_MAX)] = 500
    allow_training_seeds: bool = False


@dataclass(frozen=True, slots=True)
class Entry:
    """One law with its parameters, or a controller of the user: a row of every table.

    ``law_sha256``: :func:`railhil.study.plan.law_sha256`, or the digest of the controller.
    """

    law: LawSpec
    law_sha256: str

    @property
    def label(self) -> str:
        """Name in tables and files: the law, and the digest of a parameter file."""
        return self.law.label

    @property
    def parameters(self) -> ParameterSet | None:
        """The law's parameters, from a file."""
        return self.law.parameters


@dataclass(frozen=True, slots=True)
class Chunk:
    """Runs of one entry with consecutive seeds: the unit of work, of repetition and of loss."""

    entry: Entry
    index: int
    first_seed: int
    runs: int

    @property
    def seeds(self) -> range:
        """Seeds of the runs."""
        return range(self.first_seed, self.first_seed + self.runs)

    @property
    def name(self) -> str:
        """Name of its part, without suffix; a law's name may contain any characters."""
        return f"{quote(self.entry.label, safe='+')}-{self.index:05d}"


@dataclass(frozen=True, slots=True)
class Plan(PlanOfSubject):
    """A campaign; to resume it, its identity must be the same."""

    request: Request
    scenario: AnyScenario
    entries: tuple[Entry, ...]

    @property
    def judging(self) -> Judging:
        """The system's part that judges the runs."""
        return judging_of(self.scenario)

    @property
    def criteria(self) -> tuple[Criterion, ...]:
        """The criteria by which the runs are judged."""
        return self.judging.criteria

    @property
    def batch(self) -> Callable[..., Any] | None:
        """The function that runs many seeds at once; None if the system has none."""
        return batch_of(self.scenario)

    @property
    def seeds(self) -> range:
        """Seeds of every law."""
        return range(self.request.first_seed, self.request.first_seed + self.request.runs)

    def chunks(self) -> list[Chunk]:
        """All chunks, laws by their labels."""
        step = self.request.chunk
        return [
            Chunk(entry, index, first, min(step, self.seeds.stop - first))
            for entry in sorted(self.entries, key=lambda entry: entry.label)
            for index, first in enumerate(self.seeds[::step])
        ]

    def origin(self, chunk: Chunk) -> str:
        """The identification of a part: its campaign and runs."""
        entry = chunk.entry
        parameters = "" if entry.parameters is None else entry.parameters.sha256
        return f"{self.results_origin} {entry.law_sha256} {parameters} {chunk.name}"

    @property
    def how(self) -> dict[str, str]:
        """The settings with which every law is run."""
        return self.entries[0].law.how

    def run(self, entry: Entry, seed: int) -> RunSpec:
        """One of its runs, for the full bench."""
        return RunSpec(self.request.scenario, self.request.settings, entry.law, seed, perturbed=True)

    def training(self, entry: Entry) -> list[int]:
        """Seeds of the campaign on which the entry's parameters were tuned, or the law's own ones chosen."""
        return training_seeds(self.scenario, entry.law, self.seeds)

    @property
    def subject(self) -> dict[str, Any]:
        """Everything that determines the figures of every single run."""
        return origin_of(self.scenario) | self.how

    @property
    def identity(self) -> dict[str, Any]:
        """The values that must be unchanged when the campaign is resumed."""
        return self.subject | {
            "first_seed": self.request.first_seed,
            "runs": self.request.runs,
            "chunk": self.request.chunk,
            "laws": [
                {
                    "label": entry.label,
                    "law": entry.law.controller,
                    "law_sha256": entry.law_sha256,
                    "parameters_sha256": None if entry.parameters is None else entry.parameters.sha256,
                    "training_seeds": self.training(entry),
                    **({} if entry.law.given is None else identity_of(entry.law.given)),
                }
                for entry in self.entries
            ],
        }


def _given_entry(request: Request, text: str, code: Code) -> Entry:
    given = named_controller(text, code, "campaign", "--laws")
    if given.arithmetic != request.arithmetic:
        raise InputError("command line", "--arithmetic", request.arithmetic, f"{given.arithmetic}, that of {text}")
    return Entry(LawSpec.of_given(given, request.indexing), given.digest)


def _entries(request: Request, scenario: AnyScenario, code: Code) -> tuple[Entry, ...]:
    files = [load_parameters(Path(name)) for name in request.parameters]
    system = scenario.installed_system
    known, usual = system.law_names(), (scenario.usual_law,)
    wanted: Sequence[str] = request.laws or tuple(dict.fromkeys(file.law for file in files)) or usual
    if wanted == (ALL_LAWS,):
        wanted = known
    for name in wanted:
        if is_law_name(name) and name not in known:
            allowed = f"all, or some of {', '.join(known)}"
            raise InputError("command line", "--laws", name, allowed, did_you_mean(name, known))
    for file in files:
        if file.law not in wanted:
            raise InputError(file.source, "law", file.law, f"one of the laws of the campaign: {', '.join(wanted)}")
    found: list[Entry] = []
    for name in wanted:
        if not is_law_name(name):
            found.append(_given_entry(request, name, code))
            continue
        sets: list[ParameterSet | None] = [file for file in files if file.law == name]
        if request.both or not sets:
            sets.insert(0, None)
        laws = [LawSpec(name, request.arithmetic, request.indexing, one) for one in sets]
        found += [Entry(law, law_sha256(name, system.name)) for law in laws]
    labels = [entry.label for entry in found]
    if twice := next((label for label in labels if labels.count(label) > 1), None):
        raise InputError("command line", "--laws, --parameters", Words(f"{twice} twice"), "each law and file once")
    return tuple(found)


def make_plan(request: Request, code: Code | None = None) -> Plan:
    """Load everything that the request names and check that every law can be made from it.

    :param code: controllers of the user that command line or call names; without it the request must name none.
    :raises InputError: a scenario, law, parameter file or seed that cannot be run, or seeds on which parameters were
        tuned or chosen (unless the request allows them).
    """
    scenario = load_any(request.scenario, request.settings)
    require_perturbations(scenario, "campaign")
    require_free_draws(scenario, "campaign")
    last = request.first_seed + request.runs - 1
    if last > SEED_MAX:
        raise InputError("command line", "--seed, --runs", Words(f"last seed {last}"), f"at most {SEED_MAX}")
    plan = Plan(request, scenario, _entries(request, scenario, code or {}))
    for entry in plan.entries:
        if not isinstance(entry.law.given, RecordedController):
            make_controller_node(scenario, RunSpec(law=entry.law)).close()
        if not request.allow_training_seeds:
            check_unseen(scenario, entry.law, plan.seeds)
    return plan
