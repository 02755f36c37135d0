"""Systems: the bench's description of one kind of train and task (entry point group ``railhil.systems``).

A scenario file selects one with ``system = "..."``; railhil's own is ``ato``. A system names its parts by reference,
``module:object``: each process imports only those that it needs, and no package has to import another.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import InitVar, dataclass, field, fields
from functools import cache
from importlib import import_module
from importlib.resources import files
from math import nan
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.common.held_code import OURS, held_sha256
from railhil.common.plug_ins import cause_of, entries, guard_plug_in, sort_laws
from railhil.dbc import Contract, system_contract
from railhil.faults.truth import Truth
from railhil.scenarios.model import PublishedScore, Timing

if TYPE_CHECKING:
    from railhil.scenarios.task import ScenarioKind

GROUP = "railhil.systems"
#: The system of a scenario that does not name one.
DEFAULT = "ato"
#: Milestone numbers in RUN_EVENT that systems may use for their own events.
OWN_EVENTS = range(32, 256)
#: The law without a program of a system with an ``interface``.
_GIVEN_OVER_INTERFACE = "railhil.controller_node.vector.given:GivenVectorLaw"
#: Field of each part that had another name in version 0.1.0.
_RENAMED = {"together": "sequence_batch"}


@dataclass(frozen=True, slots=True)
class System:
    """One kind of train and task. A part is a reference, ``module:object``; the optional ones are None where absent."""

    name: str
    title: str
    #: Port table, ``package:file``.
    ports: str
    #: Makes the plant from (scenario, seed, perturbed, rate), and the run's number after these if the system is
    #: ``numbered`` (:class:`railhil.plant_sim.any_plant.AnyPlant`).
    plant: str
    #: Makes the controller's side of the bus from (scenario, law, controller, fd, bit_rate)
    #: (:class:`railhil.controller_node.controller.AnyController`).
    controller: str
    #: Entry point group of its laws.
    laws: str
    #: The default law.
    law: str
    #: A :class:`railhil.judge.judging.Judging`.
    judging: str
    #: Makes the figures of its report from (scenario, recorded runs with the gaps of their records,
    #: :class:`railhil.record.sampling.DrawnTrace`), each a :class:`railhil.charts.figure.Figure`.
    pictures: str
    #: Reads its scenario files (:class:`railhil.scenarios.task.ScenarioKind`).
    scenarios: str = "railhil.scenarios.task:TaskScenarios"
    #: The default arithmetic of its runs.
    arithmetic: str = "iq"
    #: Its own milestones by name, numbers in :data:`OWN_EVENTS`.
    events: Mapping[str, int] = field(default_factory=dict)
    #: References by the name of their field, as systems of version 0.1.0 give the parts below.
    own: InitVar[Mapping[str, str] | None] = None
    #: Ports and signals of the truth on its bus.
    truth: Truth | None = None
    #: Commands by name, each a port and a signal, ``PORT.Signal``.
    named: Mapping[str, str] = field(default_factory=dict)
    #: First words of the ports of each unit, if a train has several.
    units: tuple[str, ...] = ()
    #: Places of faults inside its plant, such as ``sensor.speed``.
    injects: tuple[str, ...] = ()
    #: Commands that take only a section of its runs (``--section``), which is a scenario of another system.
    by_section: tuple[str, ...] = ()
    #: Whether a seed gives a sequence of different runs.
    numbered: bool = False
    #: The section ``[task]`` of its scenario files (:class:`railhil.scenarios.task.Task`).
    task: str | None = None
    #: Readings, commands and notes of its laws (:class:`railhil.controller_node.vector.law.Interface`).
    interface: str | None = None
    #: Makes a run without a bus (:func:`railhil.run.coupled.direct_run`); without it the audit runs the nodes.
    direct: str | None = None
    #: Couples plant and law for it (:func:`railhil.run.coupled.couple_over_interface`, which is used without it).
    coupling: str | None = None
    #: Makes many runs of a case (:func:`railhil.systems.ato.batch.run_batch`); without it campaigns run the nodes.
    batch: str | None = None
    #: Makes runs of a case from vectors (:class:`railhil.systems.ato.batch.VectorRuns`); without it such runs go
    #: through the nodes.
    vectors: str | None = None
    #: Function of a scenario: names of the numbers that its key ``draws`` gives, None for a number without effect;
    #: without it its runs cannot be given draws and noise.
    draws: str | None = None
    #: Function of scenario and recorded trace that equals the digest of the batch; needed with ``batch``.
    digest: str | None = None
    #: Name of the module with the batch's compiled loops.
    kernel: str | None = None
    #: Function of a scenario: reason for which the batch makes each run by itself; empty if it makes many at once.
    one_by_one: str | None = None
    #: Makes runs of one scenario and law at once that differ in seed, number and memory
    #: (:func:`railhil.systems.stop.batch.run_together`); without it sequences make them one after the other.
    sequence_batch: str | None = None
    #: How its laws are tuned (:class:`railhil.tuning.trials.Tuning`); without it the default law is the reference.
    tuning: str | None = None
    #: Its own examination in the audit (:data:`railhil.audit.bars.OwnLook`).
    audit: str | None = None
    #: Largest errors against float64 of quantities that its laws note, by name.
    audit_limits: str | None = None
    #: The law whose commands are computed by code of the user, and its readings
    #: (:class:`railhil.controller_node.given.computing.SkeletonLaw`); without it ``interface`` gives them.
    given: str | None = None
    #: Exports its laws as C (:class:`railhil.controller_node.export.control.Control`); without it ``interface`` does.
    export: str | None = None
    #: Path of its fault catalogue; without it the catalogue of ``ato`` is used.
    catalogue: str | None = None
    #: Path of the requirements that ship with it (:func:`railhil.judge.requirements.requirement.read_requirements`).
    requirements: str | None = None
    #: Its plants with faults and with an FMU (:mod:`railhil.plant_sim.faults.plants`).
    faulty_plant: str | None = None
    fmu_plant: str | None = None
    #: Draws scenario and trace into a file; without it :mod:`railhil.report.pictures` does.
    picture: str | None = None
    #: Reads a line from a file of another tool, for ``railhil new line --from``
    #: (:func:`railhil.systems.ato.scenario.importers.new_line.read_new_line`).
    new_line: str | None = None
    #: Lists the least traction work of its sections, for ``railhil bound``
    #: (:data:`railhil.scenarios.section_bound.ListBounds`).
    bound: str | None = None
    #: Sentences on what its runs are not, for the help of a command.
    statement: str | None = None

    def __post_init__(self, own: Mapping[str, str] | None) -> None:
        if self.given is None and self.interface is not None:
            object.__setattr__(self, "given", _GIVEN_OVER_INTERFACE)
        optional = {item.name for item in fields(self) if item.default is None} - {"truth"}
        for given, reference in (own or {}).items():
            name = _RENAMED.get(given, given)
            if name not in optional:
                allowed = ", ".join(sorted(optional))
                raise InputError(f"system {self.name}", "own", given, allowed, did_you_mean(given, optional))
            object.__setattr__(self, name, reference)

    def part(self, name: str) -> Any:
        """The object that the reference in one of this system's fields names.

        :raises InputError: the system has no such part, or it cannot be imported.
        """
        reference = getattr(self, name, None)
        if not isinstance(reference, str):
            raise InputError(f"system {self.name}", name, Words("no such part"), "a reference, module:object")
        module, _, attribute = reference.partition(":")
        try:
            with guard_plug_in():
                return getattr(import_module(module), attribute)
        except Exception as error:
            # Plug-in code may raise anything.
            cause = cause_of(error)
            raise InputError(f"system {self.name}", name, reference, "a part that can be imported", cause) from error

    def optional_part(self, name: str) -> Any:
        """Like :meth:`part`; None if the system has none.

        :raises InputError: it cannot be imported.
        """
        return None if getattr(self, name) is None else self.part(name)

    @property
    def scenario_kind(self) -> ScenarioKind:
        """Reads and writes its scenarios.

        :raises InputError: the part ``scenarios`` cannot be imported, or has the methods of version 0.1.0.
        """
        kind: ScenarioKind = self.part("scenarios")(self)
        if not hasattr(kind, "restore"):
            allowed = "one with the method restore, which was called stored in version 0.1.0"
            raise InputError(f"system {self.name}", "scenarios", self.scenarios, allowed)
        return kind

    @property
    def port_table(self) -> Path:
        """File of the port table.

        :raises InputError: the package is missing, or is not on a file system.
        """
        package, _, name = self.ports.partition(":")
        try:
            return Path(str(files(package))) / name
        except (ImportError, TypeError) as error:
            raise InputError(f"system {self.name}", "ports", self.ports, "package:file", str(error)) from error

    @property
    def contract(self) -> Contract:
        """The system's wire contract.

        :raises ContractError: the port table is unusable.
        """
        return system_contract(self.port_table)

    def code_sha256(self) -> str | None:
        """Hash over the package that contains the plant: :func:`~railhil.common.held_code.held_sha256`.

        None if that package is railhil itself, whose hash is in every certificate.

        :raises InputError: the package cannot be imported.
        """
        name = self.plant.partition(":")[0].partition(".")[0]
        if name == __name__.partition(".")[0]:
            return None
        self.part("plant")
        return held_sha256(name)

    def law_sha256(self, name: str) -> str | None:
        """Hash over the distribution of one of its laws. None for a law of railhil, whose hash is in every certificate,
        and for a law that is not installed."""
        law = entries(self.laws).get(name)
        return None if law is None or law.module.partition(".")[0] == OURS else held_sha256(law.module, law.dist)

    def refuse_whole_runs(self, command: str, scenario: str) -> None:
        """Refuse a scenario of which the command takes only a section.

        :param scenario: its name or file, as the command was given it.
        :raises InputError: it is one.
        """
        if command in self.by_section:
            allowed = f"one of its sections: railhil {command} with --section 1; railhil run {scenario} --section 1"
            raise InputError(f"railhil {command}", "scenario", scenario, f"{allowed} runs it")

    def law_names(self) -> list[str]:
        """Names of the installed laws for this system, in the order of every table."""
        return sort_laws(entries(self.laws))

    def check_law(self, name: str, source: str | Path, key: str) -> None:
        """Refuse a name that no law of this system has.

        :param source, key: origin of the name, for the error.
        :raises InputError: there is no such law.
        """
        known = self.law_names()
        if name not in known:
            raise InputError(source, key, name, ", ".join(known), did_you_mean(name, known))


def names() -> list[str]:
    """Names of the installed systems, sorted."""
    return sorted(entries(GROUP))


def told_systems(columns: int) -> str:
    """The installed systems, each with its title and what its runs are not, for a help of this width."""
    width = max(columns - 2, 40)
    lines = ["systems, of which a scenario names one:"]
    for name in sorted(names(), key=lambda name: name != DEFAULT):
        system = system_named(name)
        said = "; ".join([system.title, *(system.optional_part("statement") or ())])
        lines += wrap(f"{name:<6}{said}", width, initial_indent="  ", subsequent_indent=" " * 8)
    return "\n".join(lines)


def system_named(name: str, file: str | Path = "scenario") -> System:
    """The installed system of that name.

    :param file: the file that names it, for the error.
    :raises InputError: there is none, or its entry point is not usable.
    """
    return _system_named(name, file, tuple(sys.path))


@cache
def _system_named(name: str, file: str | Path, path: tuple[str, ...]) -> System:
    """The system, loaded and checked once for each ``sys.path``, on which the entry points depend: a panel asks for it
    several times a second. Raises InputError."""
    found = entries(GROUP)
    if name not in found:
        allowed = f"one that is installed: {', '.join(sorted(found))}"
        raise InputError(file, "system", name, allowed, did_you_mean(name, found))
    entry = found[name]
    try:
        with guard_plug_in():
            system = entry.load()
    except InputError:
        # The message tells what to change.
        raise
    except Exception as error:
        # Plug-in code may raise anything.
        cause = cause_of(error)
        raise InputError(file, "system", entry.value, "an entry point that can be imported", cause) from error
    if not isinstance(system, System) or system.name != name:
        raise InputError(file, "system", entry.value, f"an entry point in {GROUP} naming a System called {name}")
    for event, number in system.events.items():
        if number not in OWN_EVENTS:
            allowed = f"{OWN_EVENTS.start} to {OWN_EVENTS[-1]}"
            raise InputError(f"system {name}", f"events.{event}", number, allowed)
    return system


class OfSystem:
    """Base of the scenarios: each names its system in its documents, and gives it to the code that runs or judges
    it."""

    __slots__ = ()
    #: Its name.
    system: str

    @property
    def installed_system(self) -> System:
        """The system of the scenario.

        :raises InputError: it is not installed, or not usable.
        """
        return system_named(self.system)

    @property
    def usual_law(self) -> str:
        """The law of its runs when none is asked for: that of its system."""
        return self.installed_system.law

    @property
    def marks(self) -> Mapping[str, Sequence[float | None]]:
        """Planned instants at which faults may begin (:data:`railhil.scenarios.fault_list.Marks`)."""
        return {}


@dataclass(frozen=True, slots=True)
class UnknownScenario(OfSystem):
    """A scenario of which only the system and the first 32 bit of the hash are known. Displays of its run show the data
    of the wire, and no data of the scenario's file (target, timetable, stopping point).

    The port table gives ticks and periods, see :class:`railhil.scenarios.model.AnyScenario`.
    """

    system: str
    #: First 32 bit of the hash in hexadecimal digits.
    sha256: str
    timing: Timing

    @classmethod
    def from_handshake(cls, system: str, scenario_hash: int, contract: Contract) -> UnknownScenario:
        """The number in a handshake telegram."""
        return cls(system, f"{scenario_hash:08x}", Timing(base_tick_ns=contract.base_tick_ns))

    @property
    def name(self) -> str:
        """For titles."""
        return f"unknown scenario {self.sha256}"

    @property
    def title(self) -> str:
        """For titles."""
        return self.name

    @property
    def planned_s(self) -> float:
        """Not known."""
        return nan

    @property
    def described(self) -> Mapping[str, object]:
        """Nothing."""
        return {}

    assumptions: tuple[str, ...] = ()
    published: tuple[PublishedScore, ...] = ()
    faults: tuple[str, ...] = ()
    watch_weakened: str = ""
    can_be_perturbed: bool = False
    every_run_is_drawn: bool = False
