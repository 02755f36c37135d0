"""The specification of a run: scenario, law, seed and pace, defined once and passed on as a whole.

It is made in Python, from a file (:meth:`RunSpec.from_file`: TOML, or the certificate of an earlier run), or from
several sources, such as a file, the environment and a command line, later ones overriding earlier ones
(:meth:`RunSpec.from_layers`). Every file that describes a run uses the keys of :meth:`RunSpec.as_json`, or some of
them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.common.command_line import RATE, USUAL_LAW, USUAL_SCENARIO
from railhil.common.errors import Faults, InputError
from railhil.common.patience import APPEAR_S, PATIENCE_S
from railhil.scenarios.given import KEY as GIVEN_KEY
from railhil.scenarios.given import NO_CODE, GivenController, NamedCode
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.operator_commands import ORDER, parse_commands
from railhil.scenarios.plant_fmu import KEY as FMU_KEY
from railhil.scenarios.plant_fmu import PlantFmu
from railhil.scenarios.settings import REQUIREMENTS, fault_words, required, set_words

# The modules that read and check files are imported where they are used: a node that gets its scenario from its parent
# needs none of them.
if TYPE_CHECKING:
    from railhil.scenarios.memory import Memory
    from railhil.scenarios.parameters import ParameterSet
    from railhil.scenarios.run_document import Layer


@dataclass(frozen=True, slots=True)
class LawSpec:
    """One law and the way to run it.

    :param controller: name of the law.
    :param arithmetic: one of :data:`railhil.common.command_line.ARITHMETICS`.
    :param indexing: set-points by ``time`` or by ``distance``.
    :param parameters: parameters of the law from a file; None: its own.
    :param task_period_ms: simulation time between two readings of the controller's mailboxes; 0: each frame at once.
    :param memory: memory that the law kept from its last runs; None: it has no memory.
    :param given: the controller that the user brings instead of a law; ``controller`` and ``arithmetic`` are then its
        own.
    """

    controller: str = USUAL_LAW
    arithmetic: str = "iq"
    indexing: str = "time"
    parameters: ParameterSet | None = None
    task_period_ms: int = 0
    memory: Memory | None = None
    given: GivenController | None = None

    @classmethod
    def of_given(cls, given: GivenController, indexing: str = "time", task_period_ms: int = 0) -> LawSpec:
        """The controller that the user brings."""
        return cls(given.name, given.arithmetic, indexing, task_period_ms=task_period_ms, given=given)

    @property
    def label(self) -> str:
        """Name of the law in the handshake: with the digests of its parameters and its memory if they come from
        files."""
        if self.given is not None:
            return self.given.label
        label = self.controller if self.parameters is None else self.parameters.controller
        return label if self.memory is None else f"{label}@{self.memory.digest}"

    @property
    def over_distance(self) -> bool:
        """True if the set-point is found from the distance covered."""
        return self.indexing == "distance"

    @property
    def identity(self) -> dict[str, Any]:
        """The law's part of the handshake."""
        return {"controller": self.label, "arithmetic": self.arithmetic, "indexing": self.indexing}

    @property
    def words(self) -> list[str]:
        """As words of a command line, without the task period if it is 0."""
        words = ["--indexing", self.indexing]
        if self.given is not None:
            words = [*self.given.words, *words]
        else:
            words = ["--controller", self.controller, "--arithmetic", self.arithmetic, *words]
        words += ["--parameters", str(self.parameters.source)] if self.parameters is not None else []
        words += ["--memory-from", str(self.memory.source)] if self.memory is not None else []
        return words + (["--task-period-ms", str(self.task_period_ms)] if self.task_period_ms else [])

    @property
    def set_points(self) -> str:
        """The quantity that indexes the set-points, in words."""
        return f"set-points by {self.indexing}"

    @property
    def said(self) -> str:
        """Arithmetic and indexing, for the heading of a table."""
        return f"{self.arithmetic}, indexed by {self.indexing}"

    @property
    def how(self) -> dict[str, str]:
        """The way to run the law, for documents that name the law elsewhere."""
        return {"arithmetic": self.arithmetic, "indexing": self.indexing}

    def as_json(self) -> dict[str, Any]:
        """All fields, parameters with their values."""
        return {
            "controller": self.controller,
            "arithmetic": self.arithmetic,
            "indexing": self.indexing,
            "parameters": None if self.parameters is None else self.parameters.as_json(),
            "task_period_ms": self.task_period_ms,
            "memory": None if self.memory is None else self.memory.as_json(),
            **({} if self.given is None else {GIVEN_KEY: self.given.as_json()}),
        }


@dataclass(frozen=True, slots=True)
class StartUp:
    """The nodes of a run that are started, and the way to start them.

    :param ask_for_fifo: real time: request SCHED_FIFO and locked memory.
    :param attach: attach to running nodes instead of starting them.
    :param foreign: the controller is a board or another program: all nodes except it are started.
    :param controller_name: name of that controller; empty: the name that it reports.
    :param rerun_command: the command that the certificate names for repeating an attached run; empty: a run that starts
        its own nodes.
    :param fault_logs: folder in which running nodes leave the logs of their faults; None: the run folder.
    :param appear_s: wall time for all nodes to appear.
    :param waits: faults may be added before the run begins.
    """

    ask_for_fifo: bool = True
    attach: bool = False
    foreign: bool = False
    controller_name: str = ""
    rerun_command: str = ""
    fault_logs: Path | None = None
    appear_s: float = APPEAR_S
    waits: bool = False

    @property
    def joins(self) -> bool:
        """True if another program starts a node of the run: the bus is then foreign, too."""
        return self.attach or self.foreign


@dataclass(frozen=True)
class RunSpec:
    """One law on one scenario.

    The last three fields describe the making of the run, not the run itself: they are not compared, and no file has
    them.

    :param scenario: shipped name, or path of a TOML file.
    :param settings: keys that override those of its files, ``KEY=VALUE`` (:mod:`railhil.scenarios.settings`).
    :param faults: faults besides the scenario's own (:mod:`railhil.faults.language`).
    :param perturbed: draw the scenario's perturbations with the seed.
    :param run_number: of the run in the sequence of its seed, from 1; for systems with numbered runs.
    :param pace: ``lockstep`` or ``realtime``; for the latter, ``rate`` is in simulated seconds per second.
    :param patience_s: lockstep: wall time to wait for an answer, see :mod:`railhil.common.patience`.
    :param bus: ``local``: all nodes in one process, without a bus; ``auto``: chosen by :mod:`railhil.bus.select`.
    :param plant_fmu: simulates the train instead of the system's own plant; only command lines can name it.
    :param memory_store: folder with the law's memory (:mod:`railhil.scenarios.memory_store`): the run begins with it,
        and after a good run the memory that the law wants to keep is written to it. A repeated run does not write it:
        command line and certificate give only the memory with which the run began.
    :param orders: of an operator, to be given again (:mod:`railhil.scenarios.operator_commands`).
    :param requirements: sentences by which the run is judged, as in a certificate
        (:meth:`railhil.judge.requirements.requirement.Requirement.as_json`); they change nothing of the run.
    :param can: arguments of ``can.Bus`` that the user has named; without any, the bus is chosen.
    :param out: the run folder; None: ``runs/<utc>-<scenario>-<controller>``.
    """

    scenario: str = USUAL_SCENARIO
    settings: tuple[str, ...] = ()
    law: LawSpec = field(default_factory=LawSpec)
    seed: int = 0
    perturbed: bool = False
    pace: str = "lockstep"
    rate: float = RATE
    patience_s: float = PATIENCE_S
    bus: str = "auto"
    memory_store: str | None = None
    faults: tuple[str, ...] = ()
    run_number: int = 1
    orders: tuple[str, ...] = ()
    plant_fmu: PlantFmu | None = None
    requirements: tuple[Mapping[str, Any], ...] = field(default=(), compare=False)
    can: Mapping[str, Any] = field(default_factory=dict, compare=False)
    start_up: StartUp = field(default_factory=StartUp, compare=False)
    out: str | Path | None = field(default=None, compare=False)

    @classmethod
    def from_json(cls, document: Mapping[str, Any], file: Path, code: NamedCode = NO_CODE) -> RunSpec:
        """The run of a document with the keys of :meth:`as_json`; other keys are ignored, as in a certificate.

        Missing keys, as in a certificate of version 0.1.0, have their defaults.

        :param file: named in errors; parameters count as read from it.
        :param code: that the command line names.
        :raises InputError: a value that a run cannot have, or other code than that of the command line.
        """
        from railhil.scenarios.memory import memory_from_json
        from railhil.scenarios.parameters import parameters_from_json
        from railhil.scenarios.run_document import RunDocument, restore_asked
        from railhil.scenarios.validation import validate

        document = restore_asked(document)
        code = code.check_recorded(document, file)
        found = validate(RunDocument, document, lambda keys: file)
        parse_commands(found.orders, file)
        given = found.parameters
        parameters = None
        if given is not None:
            parameters = parameters_from_json({"law": found.controller, **given}, file)
        memory = None if found.memory is None else memory_from_json(found.memory, file)
        law = LawSpec(found.controller, found.arithmetic, found.indexing, parameters, found.task_period_ms, memory)
        spec = cls(
            scenario=found.scenario,
            settings=tuple(found.settings),
            law=law,
            seed=found.seed,
            perturbed=found.perturbed,
            pace=found.pace,
            rate=found.rate or RATE,
            patience_s=found.patience_s,
            bus=found.bus,
            memory_store=found.memory_store,
            faults=tuple(found.faults),
            run_number=found.run_number,
            orders=tuple(found.orders),
            requirements=required(document, file),
        )
        return spec.with_code(code)

    def with_code(self, code: NamedCode) -> RunSpec:
        """The run with code that a command line names: its plant, and its controller instead of the law."""
        law = self.law
        if code.controller is not None:
            law = LawSpec.of_given(code.controller, law.indexing, law.task_period_ms)
        return replace(self, plant_fmu=code.plant_fmu, law=law)

    @classmethod
    def from_layers(cls, layers: Sequence[Layer], faults: Faults) -> RunSpec:
        """The run of several sources, later ones overriding earlier ones.

        :param faults: errors found while the sources were read.
        :raises InputError: all errors together.
        """
        from railhil.scenarios.run_document import merge_layers

        document, parameters, memory = merge_layers(layers, faults)
        spec = cls.from_json(document, Path("railhil run"))
        return replace(spec, law=replace(spec.law, parameters=parameters, memory=memory))

    @classmethod
    def from_file(cls, path: str | Path, code: NamedCode = NO_CODE) -> RunSpec:
        """The run described by a TOML file with the keys of :meth:`as_json`, or by a ``certificate.json``.

        :param code: that the command line names.
        :raises InputError: the file cannot be read or does not describe a possible run: all errors together.
        """
        from railhil.scenarios.run_document import file_layer

        faults = Faults()
        return cls.from_layers([file_layer(Path(path), faults, code)], faults).with_code(code)

    @property
    def is_realtime(self) -> bool:
        """True if the run follows the wall clock, or a multiple of it."""
        return self.pace == "realtime"

    @property
    def asks_for_fifo(self) -> bool:
        """True if the processes of this run should request SCHED_FIFO and locked memory."""
        return self.is_realtime and self.start_up.ask_for_fifo

    @property
    def folder_controller(self) -> str:
        """The controller in the name of a run folder."""
        if not self.start_up.foreign:
            return self.law.controller
        return re.sub(r"[^A-Za-z0-9_.+-]+", "_", self.start_up.controller_name) or "other"

    @property
    def wall_rate(self) -> float:
        """Simulated seconds per wall second, 0 in lockstep."""
        return self.rate if self.is_realtime else 0.0

    @property
    def identity(self) -> dict[str, Any]:
        """The run as described in the handshake, without scenario and wire."""
        return {"seed": self.seed, "perturbed": self.perturbed, "pace": self.pace, **self.law.identity}

    @property
    def scenario_words(self) -> list[str]:
        """The words that select the scenario on any command line."""
        return [self.scenario, *set_words(self.settings), *fault_words(self.faults)]

    @property
    def requirement_words(self) -> list[str]:
        """The words that name the files of its requirements."""
        files = dict.fromkeys(str(one["file"]) for one in self.requirements if one.get("file"))
        # The scenario has its own.
        files.pop(self.scenario, None)
        return [word for file in files for word in ("--requirements", file)]

    @property
    def number_words(self) -> list[str]:
        """The words that number the run; none for the first."""
        return ["--run-number", str(self.run_number)] if self.run_number != 1 else []

    @property
    def words(self) -> list[str]:
        """As words of a command line after ``railhil run``."""
        words = [*self.scenario_words, *self.law.words, "--seed", str(self.seed), "--pace", self.pace]
        words += ["--rate", f"{self.rate:g}"] if self.is_realtime else []
        words += ["--perturbed"] * self.perturbed
        words += self.number_words
        words += [word for text in self.orders for word in (ORDER, text)]
        words += self.plant_fmu.words if self.plant_fmu is not None else []
        words += self.requirement_words
        words += ["--patience", f"{self.patience_s:g}"] if self.patience_s != PATIENCE_S else []
        return words + (["--bus", self.bus] if self.is_local else [])

    @property
    def is_local(self) -> bool:
        """True if all nodes are in one process."""
        return self.bus == "local"

    def load(self) -> AnyScenario:
        """The scenario, nominal regardless of the seed.

        :raises InputError: it cannot be loaded, a perturbed run is requested and it has no perturbations, or the run
            has a number and runs of its system have none.
        """
        from railhil.scenarios.load import load_any

        scenario = load_any(self.scenario, self.settings, self.faults)
        self.check_number(scenario)
        if self.perturbed:
            from railhil.scenarios.model import require_perturbations

            require_perturbations(scenario, "--perturbed")
        return scenario

    def check_number(self, scenario: AnyScenario) -> None:
        """Refuse a number of the run in a system whose runs have none.

        :raises InputError: it has a number.
        """
        if self.run_number != 1 and not scenario.installed_system.numbered:
            allowed = f"1: runs of system {scenario.system} have no numbers"
            raise InputError("run", "run_number", self.run_number, allowed)

    def as_json(self) -> dict[str, Any]:
        """All fields without nesting: the keys of a certificate. ``rate`` is None in lockstep."""
        return {
            "scenario": self.scenario,
            "settings": list(self.settings),
            "faults": list(self.faults),
            **self.law.as_json(),
            "seed": self.seed,
            "perturbed": self.perturbed,
            "run_number": self.run_number,
            "pace": self.pace,
            "rate": self.rate if self.is_realtime else None,
            "patience_s": self.patience_s,
            "bus": self.bus,
            "orders": list(self.orders),
            **({} if self.plant_fmu is None else {FMU_KEY: self.plant_fmu.as_json()}),
            **({REQUIREMENTS: [dict(one) for one in self.requirements]} if self.requirements else {}),
        }
