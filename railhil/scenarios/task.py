"""Scenarios of plug-in systems: the part common to every scenario, and a section ``[task]`` defined by the system.

::

    schema_version = 1
    system = "two_carts"
    name = "two_carts_2m"
    title = "Two carts on a spring, 2 m"
    [task]                    # the system's own table, a subclass of Task
    duration_s = 10
    [timing]
    control_period_ms = 100
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Protocol

from pydantic import BaseModel, Field, create_model

from railhil.common.errors import InputError, Words
from railhil.faults.truth import HOLE_MAX_S
from railhil.scenarios.carried import Reach, check_carried
from railhil.scenarios.layers import Layers, add_own_words, faults_of_rows
from railhil.scenarios.model import AnyScenario, PublishedScore, Timing, list_injected_faults, text_sha256
from railhil.scenarios.reference import Key, keys
from railhil.scenarios.schema import (
    FAULT_TAGS,
    RUNNING_TIME_MAX_S,
    DefineTable,
    FaultRows,
    HuntTable,
    Name,
    Number,
    RequirementRows,
    Table,
    Text,
    TimingTable,
)
from railhil.scenarios.system import OfSystem, System
from railhil.scenarios.validation import Refuse, validate

_ALLOWED = "a scenario that railhil has written"


class ScenarioKind(Protocol):
    """Reads and writes the scenarios of a system."""

    def __init__(self, system: System) -> None:
        """For scenarios of that system."""

    def read(self, layers: Layers) -> AnyScenario:
        """Scenario from a file and its base files. Raises InputError."""

    def document(self, scenario: Any) -> dict[str, Any]:
        """All fields of a scenario, as JSON-compatible values."""

    def restore(self, fields: dict[str, Any], file: Path) -> AnyScenario:
        """The scenario of a document, with its hash computed by the present version. Raises InputError."""

    def judged_sha256(self, scenario: Any) -> str:
        """Hash of the data used by the run and by its evaluation."""

    @property
    def file_type(self) -> type[BaseModel]:
        """The schema of its files."""

    def list_keys(self) -> list[Key]:
        """All keys of its files, in the order of the schema."""

    def usual_keys(self) -> list[Key]:
        """The keys that a file based on another one changes most often, section by section."""


class Task(Table):
    """The section ``[task]`` of a system's scenario file; subclasses add keys, with units in their names.

    The meaning of a key is its ``Field(description=...)``.
    """

    #: Keys that change no frame of a run, only its evaluation.
    JUDGING: ClassVar[tuple[str, ...]] = ()
    #: Whether the plant lets a command wait for ``timing.loop_delay_s``.
    LOOP_DELAY: ClassVar[bool] = False

    duration_s: Annotated[float, Field(gt=0, le=RUNNING_TIME_MAX_S, description="how long the run lasts")]

    def reaches(self) -> Iterable[Reach]:
        """Ranges of the quantities of a run that the wire might not carry; keys begin with ``task``."""
        return ()

    @property
    def can_be_perturbed(self) -> bool:
        """Whether the plant makes random draws in a perturbed run."""
        return False

    @property
    def every_run_is_drawn(self) -> bool:
        """Whether the plant makes the same draws in every run: parameters can then be chosen on any run."""
        return False


class TaskFile(Table):
    """The part of a system's scenario file that is common to all systems."""

    schema_version: Literal[1]
    system: Name
    name: Name
    title: Text
    assumptions: Annotated[list[Text], Field(default_factory=list)]
    timing: TimingTable = TimingTable()
    published: Annotated[list[dict[Text, Text | Number]], Field(default_factory=list)]
    fault: Annotated[FaultRows, Field(default_factory=list)]
    requirement: RequirementRows
    define: DefineTable
    hunt: HuntTable = HuntTable()


@dataclass(frozen=True, slots=True)
class TaskScenario(OfSystem):
    """A scenario with a section defined by its system."""

    name: str
    title: str
    system: str
    timing: Timing
    task: Any
    published: tuple[PublishedScore, ...] = ()
    assumptions: tuple[str, ...] = ()
    sha256: str = ""
    #: See :class:`railhil.systems.ato.scenario.model.Scenario`.
    faults: tuple[str, ...] = ()

    @property
    def planned_s(self) -> float:
        """Planned duration of the run, in s."""
        return float(self.task.duration_s)

    @property
    def watch_weakened(self) -> str:
        """Watch limits that are higher than usual; not known for systems that plug in."""
        return ""

    @property
    def described(self) -> Mapping[str, object]:
        """Name of its system; the task has no further description."""
        return {"system": self.system}

    @property
    def can_be_perturbed(self) -> bool:
        """Whether the seed draws anything besides the noise."""
        return bool(self.task.can_be_perturbed)

    @property
    def every_run_is_drawn(self) -> bool:
        """Whether a perturbed run draws nothing that another run does not."""
        return bool(self.task.every_run_is_drawn)


class TaskScenarios:
    """See :class:`ScenarioKind`; the system's part ``task`` is a subclass of :class:`Task`."""

    def __init__(self, system: System) -> None:
        self._system = system
        self.file_type: type[BaseModel] = create_model(
            "ScenarioFile", __base__=TaskFile, task=(system.part("task"), ...)
        )

    def read(self, layers: Layers) -> TaskScenario:
        table = layers.merge()
        file: Any = validate(self.file_type, table, lambda keys: layers.origin(*keys), FAULT_TAGS)
        timing, refuse = file.timing.in_ns(), layers.refuse
        ports = [port.name for port in self._system.contract.ports if port.period_ns]
        for port, period_ns in {"": timing.control_period_ns, **timing.port_period_ns}.items():
            keys = ("timing", "port_period_ms", port) if port else ("timing", "control_period_ms")
            if port and port not in ports:
                raise refuse(keys, Words("no such port"), f"one of {', '.join(ports)}")
            if period_ns <= 0 or timing.base_tick_ns <= 0 or period_ns % timing.base_tick_ns:
                raise refuse(keys, period_ns / 1e6, f"a whole multiple of base_tick_ms = {timing.base_tick_ns / 1e6:g}")
        check_carried(self._system.contract, file.task.reaches(), refuse)
        self._check_ages(timing, refuse)
        for row, published in enumerate(file.published):
            if not isinstance(published.get("controller"), str):
                raise refuse(("published", row, "controller"), published.get("controller"), "the name of a law")
        if file.timing.loop_delay_s and "loop_delay_s" in file.timing.model_fields_set and not file.task.LOOP_DELAY:
            allowed = "0, or no such key: the delays of this system are in its task"
            raise refuse(("timing", "loop_delay_s"), file.timing.loop_delay_s, allowed)
        made = self._make_scenario(
            file.name,
            file.title,
            timing,
            file.task,
            tuple(map(PublishedScore.of, file.published)),
            tuple(file.assumptions),
            faults_of_rows(table.get("fault", ()), self._system, lambda row: layers.origin("fault", row)),
        )
        return add_own_words(made, layers, self.read, lambda one: one.task.model_dump(exclude={*one.task.JUDGING}))

    def _check_ages(self, timing: Timing, refuse: Refuse) -> None:
        """Refuse periods with which a reading of a healthy run would be older than the interface of the system's laws
        allows, or the truth would be sent too seldom for a verdict."""
        if not timing.port_period_ns:
            # The periods of the port table fit.
            return
        truth = self._system.truth
        if truth is not None and (period_ns := timing.port_period_ns.get(truth.port, 0)) > HOLE_MAX_S * 1e9:
            allowed = f"at most {HOLE_MAX_S * 1e3:g}: no verdict without the truth for longer"
            raise refuse(("timing", "port_period_ms", truth.port), period_ns / 1e6, allowed)
        interface = self._system.optional_part("interface")
        if interface is None:
            return
        for reading in interface.readings:
            port = reading.telegram.PORT
            period_ns = timing.port_period_ns.get(port, 0)
            most_ns = interface.age_max_ns(reading)
            if period_ns - timing.base_tick_ns > most_ns:
                allowed = f"at most {(most_ns + timing.base_tick_ns) / 1e6:g}: an older {reading.name} is not used"
                raise refuse(("timing", "port_period_ms", port), period_ns / 1e6, allowed)

    def _make_scenario(
        self,
        name: str,
        title: str,
        timing: Timing,
        task: Any,
        published: tuple[PublishedScore, ...],
        assumptions: tuple[str, ...],
        faults: tuple[str, ...],
    ) -> TaskScenario:
        made = TaskScenario(name, title, self._system.name, timing, task, published, assumptions, faults=faults)
        return replace(made, sha256=text_sha256(self._select_used(made)))

    def _select_used(self, scenario: TaskScenario, judging: bool = False) -> dict[str, Any]:
        document = self.document(scenario)
        used = {key: document[key] for key in ("name", "system", "timing", "task")}
        if not judging:
            for key in scenario.task.JUDGING:
                used["task"].pop(key, None)
        if scenario.faults:
            used["faults"] = document["faults"] if judging else list_injected_faults(scenario.faults)
        return used

    def document(self, scenario: Any) -> dict[str, Any]:
        timing = scenario.timing
        return {
            "name": scenario.name,
            "title": scenario.title,
            "system": scenario.system,
            "timing": {
                "base_tick_ns": timing.base_tick_ns,
                "control_period_ns": timing.control_period_ns,
                "loop_delay_s": timing.loop_delay_s,
                "port_period_ns": dict(timing.port_period_ns),
            },
            "task": scenario.task.model_dump(mode="json"),
            "published": [row.as_table() for row in scenario.published],
            "assumptions": list(scenario.assumptions),
            "sha256": scenario.sha256,
            "faults": list(scenario.faults),
        }

    def restore(self, fields: dict[str, Any], file: Path) -> TaskScenario:
        task_type = self._system.part("task")
        try:
            timing = Timing(**fields["timing"])
            # Converted through JSON, so that arrays get the types of the table.
            task = validate(task_type, json.loads(json.dumps(fields["task"])), lambda keys: file)
            published = tuple(map(PublishedScore.of, fields["published"]))
            # Version 0.1.0 had no faults.
            rest = tuple(fields["assumptions"]), tuple(map(str, fields.get("faults", ())))
            return self._make_scenario(str(fields["name"]), str(fields["title"]), timing, task, published, *rest)
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(file, "", Words(f"{type(error).__name__}: {error}"), _ALLOWED) from None

    def judged_sha256(self, scenario: Any) -> str:
        return text_sha256(self._select_used(scenario, judging=True))

    def list_keys(self) -> list[Key]:
        return keys(self.file_type)

    def usual_keys(self) -> list[Key]:
        """All keys of the task, and the two periods."""
        periods = ("timing.base_tick_ms", "timing.control_period_ms")
        return [key for key in self.list_keys() if key.name.startswith("task.") or key.name in periods]
