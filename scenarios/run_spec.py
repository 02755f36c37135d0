"""What a run is: scenario, law, seed and pace, said once and handed on whole.

It is made from a command line (:meth:`RunSpec.from_namespace`), in Python, from a file (:meth:`RunSpec.from_file`:
TOML, or the certificate of an earlier run), or from several of these and the environment, one above the other
(:meth:`RunSpec.from_layers`). Every file that says what is or was run has the keys of :meth:`RunSpec.as_json`, or some
of them.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from railhil.common.command_line import RATE
from railhil.common.errors import Faults
from railhil.common.patience import PATIENCE_S
from railhil.scenarios.load import load_any, stable_name
from railhil.scenarios.memory import Memory, memory_from_json
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import ParameterSet, parameters_from_json
from railhil.scenarios.perturb import require_perturbations
from railhil.scenarios.run_document import USUAL_LAW, USUAL_SCENARIO, Layer, RunDocument, file_layer, merged
from railhil.scenarios.settings import set_words
from railhil.scenarios.validation import validated


@dataclass(frozen=True, slots=True)
class LawSpec:
    """One law and how it is run.

    :param controller: name of the law.
    :param arithmetic: one of :data:`railhil.common.choices.ARITHMETICS`.
    :param indexing: set-points by ``time`` or by ``distance``.
    :param parameters: of the law, from a file; None: its own.
    :param task_period_ms: simulation time between two readings of the controller's mailboxes; 0: each frame at once.
    :param memory: what the law has kept of its last runs; None: it is given none.
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
        controller: str,
        parameters: ParameterSet | None,
        memory: Memory | None = None,
    ) -> LawSpec:
        """What the options of :func:`railhil.common.command_line.add_law_arguments` say of a law."""
        return cls(controller, namespace.arithmetic, namespace.indexing, parameters, namespace.task_period_ms, memory)

    @property
    def label(self) -> str:
        """The law, with the digests of its parameters and its memory when they come from files: its name in the
        handshake."""
        label = self.controller if self.parameters is None else self.parameters.controller
        return label if self.memory is None else f"{label}@{self.memory.digest}"

    @property
    def over_distance(self) -> bool:
        """True when the set-points are found by the distance covered."""
        return self.indexing == "distance"

    @property
    def identity(self) -> dict[str, Any]:
        """Its part of the handshake."""
        return {"controller": self.label, "arithmetic": self.arithmetic, "indexing": self.indexing}

    @property
    def words(self) -> list[str]:
        """As words of a command line, the task period left out when there is none."""
        words = ["--controller", self.controller, "--arithmetic", self.arithmetic, "--indexing", self.indexing]
        words += ["--parameters", str(self.parameters.source)] if self.parameters is not None else []
        words += ["--memory-from", str(self.memory.source)] if self.memory is not None else []
        return words + (["--task-period-ms", str(self.task_period_ms)] if self.task_period_ms else [])

    @property
    def set_points(self) -> str:
        """Over what its set-points run, in words."""
        return f"set-points by {self.indexing}"

    @property
    def said(self) -> str:
        """Arithmetic and set-points for the head of a table."""
        return f"{self.arithmetic}, indexed by {self.indexing}"

    @property
    def how(self) -> dict[str, str]:
        """How the law is run, for documents that name it otherwise."""
        return {"arithmetic": self.arithmetic, "indexing": self.indexing}

    def as_json(self) -> dict[str, Any]:
        """All of it, parameters with their values."""
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
    :param settings: keys set beside its files, ``KEY=VALUE`` (:mod:`railhil.scenarios.settings`).
    :param perturbed: draw the scenario's perturbations with the seed.
    :param pace: ``lockstep`` or ``realtime``; ``rate``: then simulated seconds per second.
    :param patience_s: lockstep: wall time for an answer, see :mod:`railhil.common.patience`.
    :param bus: ``local``: all nodes in one process, without a bus; ``auto``: as :mod:`railhil.bus.select` finds it.
    :param memory_file: file with the law's memory: the run begins with it, and what the law wants kept goes there when
        the run was good. A run that is made again keeps nothing: its words and certificate say only what it began with.
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
    memory_file: str | None = None

    @classmethod
    def from_namespace(cls, namespace: argparse.Namespace, law: LawSpec) -> RunSpec:
        """What the options of :func:`railhil.common.command_line.add_run_arguments` and ``--set`` say.

        :raises InputError: there is no such scenario.
        """
        return cls(
            scenario=stable_name(namespace.scenario),
            settings=tuple(namespace.set),
            law=law,
            seed=namespace.seed,
            perturbed=namespace.perturbed,
            pace=namespace.pace,
            rate=namespace.rate or RATE,
            patience_s=namespace.patience,
            # Only the commands that make whole runs have it.
            bus=getattr(namespace, "bus", "auto"),
        )

    @classmethod
    def from_json(cls, document: Mapping[str, Any], file: Path) -> RunSpec:
        """The run of a document with the keys of :meth:`as_json`; other keys are left aside, as in a certificate.

        Keys that are missing, as in one of version 0.1.0, have their defaults.

        :param file: named in a complaint; parameters count as read from it.
        :raises InputError: a value that no run has.
        """
        found = validated(RunDocument, dict(document), lambda keys: file)
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
            memory_file=found.memory_file,
        )

    @classmethod
    def from_layers(cls, layers: Sequence[Layer], faults: Faults) -> RunSpec:
        """The run of several sources, the later one above the earlier.

        :param faults: what was wrong with the sources as they were read.
        :raises InputError: all that is wrong, together.
        """
        document, parameters, memory = merged(layers, faults)
        spec = cls.from_json(document, Path("railhil run"))
        return replace(spec, law=replace(spec.law, parameters=parameters, memory=memory))

    @classmethod
    def from_file(cls, path: str | Path) -> RunSpec:
        """The run that a TOML file says with the keys of :meth:`as_json`, or a ``certificate.json``.

        :raises InputError: the file cannot be read, or says what no run is: all of it together.
        """
        faults = Faults()
        return cls.from_layers([file_layer(Path(path), faults)], faults)

    @property
    def is_realtime(self) -> bool:
        """True when the run keeps the pace of the wall clock, or a multiple of it."""
        return self.pace == "realtime"

    @property
    def wall_rate(self) -> float:
        """Simulated seconds per wall second, 0 in lockstep."""
        return self.rate if self.is_realtime else 0.0

    @property
    def identity(self) -> dict[str, Any]:
        """What the handshake says of the run, scenario and wire left out."""
        return {"seed": self.seed, "perturbed": self.perturbed, "pace": self.pace, **self.law.identity}

    @property
    def scenario_words(self) -> list[str]:
        """Words of every command line that say which scenario it is."""
        return [self.scenario, *set_words(self.settings)]

    @property
    def words(self) -> list[str]:
        """As words of a command line behind ``railhil run``."""
        words = [*self.scenario_words, *self.law.words, "--seed", str(self.seed), "--pace", self.pace]
        words += ["--rate", f"{self.rate:g}"] if self.is_realtime else []
        words += ["--perturbed"] * self.perturbed
        words += ["--patience", f"{self.patience_s:g}"] if self.patience_s != PATIENCE_S else []
        return words + (["--bus", self.bus] if self.is_local else [])

    @property
    def is_local(self) -> bool:
        """True when all nodes are in one process."""
        return self.bus == "local"

    def load(self) -> AnyScenario:
        """The scenario, nominal whatever the seed draws.

        :raises InputError: it cannot be loaded, or leaves nothing to draw for a perturbed run.
        """
        scenario = load_any(self.scenario, self.settings)
        if self.perturbed:
            require_perturbations(scenario, "--perturbed")
        return scenario

    def as_json(self) -> dict[str, Any]:
        """All of it, flat: the keys of a certificate. ``rate`` is None in lockstep."""
        return {
            "scenario": self.scenario,
            "settings": list(self.settings),
            **self.law.as_json(),
            "seed": self.seed,
            "perturbed": self.perturbed,
            "pace": self.pace,
            "rate": self.rate if self.is_realtime else None,
            "patience_s": self.patience_s,
            "bus": self.bus,
        }
