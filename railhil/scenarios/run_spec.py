"""The specification of a run: scenario, law, seed and pace, defined once and passed on as a whole.

It is made from a command line (:meth:`RunSpec.from_namespace`), in Python, from a file (:meth:`RunSpec.from_file`:
TOML, or the certificate of an earlier run), or from several of these and the environment, later ones overriding earlier
ones (:meth:`RunSpec.from_layers`). Every file that describes a run uses the keys of :meth:`RunSpec.as_json`, or some of
them.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.common.choices import USUAL_LAW, USUAL_SCENARIO
from railhil.common.command_line import RATE
from railhil.common.errors import Faults, InputError
from railhil.common.patience import PATIENCE_S
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.orders import ORDER, orders_of
from railhil.scenarios.plant_fmu import KEY as FMU_KEY
from railhil.scenarios.plant_fmu import PlantFmu, fmu_again
from railhil.scenarios.settings import fault_words, set_words
from railhil.scenarios.system import System, system_named

# What reads and checks files is loaded where it is used: a node that is handed its scenario needs none of it.
if TYPE_CHECKING:
    from railhil.scenarios.memory import Memory
    from railhil.scenarios.parameters import ParameterSet
    from railhil.scenarios.run_document import Layer


@dataclass(frozen=True, slots=True)
class LawSpec:
    """One law and how it is run.

    :param controller: name of the law.
    :param arithmetic: one of :data:`railhil.common.choices.ARITHMETICS`.
    :param indexing: set-points by ``time`` or by ``distance``.
    :param parameters: parameters of the law from a file; None: its own.
    :param task_period_ms: simulation time between two readings of the controller's mailboxes; 0: each frame at once.
    :param memory: what the law kept from its last runs; None: it has no memory.
    """

    controller: str = USUAL_LAW
    arithmetic: str = "iq"
    indexing: str = "time"
    parameters: ParameterSet | None = None
    task_period_ms: int = 0
    memory: Memory | None = None

    @classmethod
    def from_namespace(
        cls,
        namespace: argparse.Namespace,
        system: System,
        controller: str | None,
        parameters: ParameterSet | None,
        memory: Memory | None = None,
    ) -> LawSpec:
        """A law from the options of :func:`railhil.common.command_line.add_law_arguments`.

        :param system: of the scenario: its law and its arithmetic are those that are not asked for.
        """
        arithmetic = namespace.arithmetic or system.arithmetic
        law = controller or system.law
        return cls(law, arithmetic, namespace.indexing, parameters, namespace.task_period_ms, memory)

    @property
    def label(self) -> str:
        """Name of the law in the handshake: with the digests of its parameters and its memory if they come from
        files."""
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
        words = ["--controller", self.controller, "--arithmetic", self.arithmetic, "--indexing", self.indexing]
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
        """How the law is run, for documents that name the law elsewhere."""
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
        }


@dataclass(frozen=True)
class RunSpec:
    """One law on one scenario.

    :param scenario: shipped name, or path of a TOML file.
    :param settings: keys that override those of its files, ``KEY=VALUE`` (:mod:`railhil.scenarios.settings`).
    :param faults: what is injected besides the scenario's own faults (:mod:`railhil.faults.language`).
    :param perturbed: draw the scenario's perturbations with the seed.
    :param run_number: of the run in the sequence of its seed, from 1; for systems whose runs have numbers.
    :param pace: ``lockstep`` or ``realtime``; for the latter, ``rate`` is in simulated seconds per second.
    :param patience_s: lockstep: wall time to wait for an answer, see :mod:`railhil.common.patience`.
    :param bus: ``local``: all nodes in one process, without a bus; ``auto``: chosen by :mod:`railhil.bus.select`.
    :param plant_fmu: simulates the train instead of the system's own plant; only command lines can name it.
    :param memory_store: folder with the law's memory (:mod:`railhil.scenarios.memory_store`): the run begins with it,
        and after a good run the memory that the law wants to keep is written to it. A repeated run does not write it:
        command line and certificate give only the memory with which the run began.
    :param orders: of an operator, to be given again (:mod:`railhil.scenarios.orders`).
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

    @classmethod
    def from_namespace(cls, namespace: argparse.Namespace, law: LawSpec) -> RunSpec:
        """A run from the options of :func:`railhil.common.command_line.add_run_arguments` and ``--set``.

        :raises InputError: there is no such scenario.
        """
        if getattr(namespace, "handed_scenario", None) is None:
            from railhil.scenarios.load import stable_name

            name = stable_name(namespace.scenario)
        else:
            # By the command that starts the node, which has found it.
            name = namespace.scenario
        return cls(
            scenario=name,
            settings=tuple(namespace.set),
            law=law,
            seed=namespace.seed,
            perturbed=namespace.perturbed,
            pace=namespace.pace,
            rate=namespace.rate or RATE,
            patience_s=namespace.patience,
            # Only the commands that make complete runs have it.
            bus=getattr(namespace, "bus", "auto"),
            faults=tuple(getattr(namespace, "fault", ())),
            run_number=namespace.run_number,
        )

    @classmethod
    def from_json(cls, document: Mapping[str, Any], file: Path, fmu: PlantFmu | None = None) -> RunSpec:
        """The run of a document with the keys of :meth:`as_json`; other keys are ignored, as in a certificate.

        Missing keys, as in a certificate of version 0.1.0, have their defaults.

        :param file: named in errors; parameters count as read from it.
        :param fmu: that the command line names.
        :raises InputError: a value that a run cannot have, or another FMU than the one on the command line.
        """
        from railhil.scenarios.memory import memory_from_json
        from railhil.scenarios.parameters import parameters_from_json
        from railhil.scenarios.run_document import RunDocument, as_asked
        from railhil.scenarios.validation import validated

        plant_fmu = fmu_again(document, file, fmu)
        found = validated(RunDocument, as_asked(document), lambda keys: file)
        orders_of(found.orders, file)
        given = found.parameters
        parameters = None
        if given is not None:
            parameters = parameters_from_json({"law": found.controller, **given}, file)
        memory = None if found.memory is None else memory_from_json(found.memory, file)
        law = LawSpec(found.controller, found.arithmetic, found.indexing, parameters, found.task_period_ms, memory)
        return cls(
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
            plant_fmu=plant_fmu,
        )

    @classmethod
    def from_layers(cls, layers: Sequence[Layer], faults: Faults) -> RunSpec:
        """The run of several sources, later ones overriding earlier ones.

        :param faults: errors found while the sources were read.
        :raises InputError: all errors together.
        """
        from railhil.scenarios.run_document import merged

        document, parameters, memory = merged(layers, faults)
        spec = cls.from_json(document, Path("railhil run"))
        return replace(spec, law=replace(spec.law, parameters=parameters, memory=memory))

    @classmethod
    def from_file(cls, path: str | Path, fmu: PlantFmu | None = None) -> RunSpec:
        """The run described by a TOML file with the keys of :meth:`as_json`, or by a ``certificate.json``.

        :param fmu: that the command line names.
        :raises InputError: the file cannot be read or does not describe a possible run: all errors together.
        """
        from railhil.scenarios.run_document import file_layer

        faults = Faults()
        return replace(cls.from_layers([file_layer(Path(path), faults, fmu)], faults), plant_fmu=fmu)

    @property
    def is_realtime(self) -> bool:
        """True if the run follows the wall clock, or a multiple of it."""
        return self.pace == "realtime"

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
        words += ["--patience", f"{self.patience_s:g}"] if self.patience_s != PATIENCE_S else []
        return words + (["--bus", self.bus] if self.is_local else [])

    @property
    def is_local(self) -> bool:
        """True if all nodes are in one process."""
        return self.bus == "local"

    def load(self) -> AnyScenario:
        """The scenario, nominal regardless of the seed.

        :raises InputError: it cannot be loaded, a perturbed run is requested and it has no perturbations, or the run
            has a number and those of its system have none.
        """
        from railhil.scenarios.load import load_any

        scenario = load_any(self.scenario, self.settings, self.faults)
        self.check_number(scenario)
        if self.perturbed:
            from railhil.scenarios.perturb import require_perturbations

            require_perturbations(scenario, "--perturbed")
        return scenario

    def check_number(self, scenario: AnyScenario) -> None:
        """Refuse a number of the run in a system whose runs have none.

        :raises InputError: it has a number.
        """
        if self.run_number != 1 and not system_named(scenario.system).numbered:
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
        }
