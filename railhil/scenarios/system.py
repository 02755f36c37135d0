"""Systems: what the bench needs to know about one kind of train and task (entry point group ``railhil.systems``).

A scenario file selects one with ``system = "..."``; railhil's own is ``ato``. A system names its parts by reference,
``module:object``: each process imports only those that it needs, and no package has to import another.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from importlib.resources import files
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, Words, did_you_mean
from railhil.common.held_code import OURS, held_sha256
from railhil.common.law_order import in_order
from railhil.common.plug_ins import entries, plugged_in
from railhil.dbc import Contract, system_contract
from railhil.faults.truth import Truth

GROUP = "railhil.systems"
#: The system of a scenario that does not name one.
DEFAULT = "ato"
#: Milestone numbers in RUN_EVENT that systems may use for their own events.
OWN_EVENTS = range(32, 256)


@dataclass(frozen=True, slots=True)
class System:
    """One kind of train and task. Every part is a reference, ``module:object``, unless it says otherwise.

    ``ports``: port table, ``package:file``. ``scenarios``: reads its scenario files
    (:class:`railhil.scenarios.task.ScenarioKind`). ``plant``: makes the plant from (scenario, seed, perturbed, rate)
    (:class:`railhil.plant_sim.any_plant.AnyPlant`), and from the run's number after these if the system is
    ``numbered``: a seed then is a sequence of runs that differ. ``controller``: makes the controller's side of the bus
    from (scenario, law, controller, fd, bit_rate) (:class:`railhil.controller_node.any_controller.AnyController`).
    ``laws``: entry point group of its laws. ``law``: the default law. ``arithmetic``: the default of its runs.
    ``events``: its own milestones by name, numbers in :data:`OWN_EVENTS`. ``judging``: a
    :class:`railhil.supervisor.judging.Judging`. ``pictures``: makes the figures of its report from (scenario, recorded
    runs with the gaps of their records, :class:`railhil.supervisor.sampled.DrawnTrace`), each a
    :class:`railhil.charts.figure.Figure`. ``own``: parts used by some
    modules only: ``task``, ``interface``, ``batch``
    (:func:`railhil.batch.run_batch`) with ``digest`` and, if it has compiled loops, ``kernel``, the name of their
    module, and ``one_by_one`` (why its batch makes each run of a scenario by itself; empty: it makes many at once),
    and ``direct`` (:func:`railhil.run.coupled.direct_run`; without them campaign and audit run the nodes),
    ``together`` (makes runs of one scenario and law together that differ in seed, number and memory:
    :func:`railhil.batch.stopping.runs.run_together`; for sequences of runs), ``audit``
    (:data:`railhil.audit.bars.OwnLook`), ``export`` (:class:`railhil.controller_node.export.control.Control`; without
    it a law is exported by ``interface``), ``catalogue`` (path of its fault catalogue; without it that of ``ato``),
    ``faulty_plant`` and ``fmu_plant`` (:mod:`railhil.plant_sim.faults.plants`) and ``picture``: draws scenario and
    trace into a file (without it: :mod:`railhil.supervisor.report.signals_picture`). For faults
    (:mod:`railhil.faults`): ``truth``: where the truth is on its bus; ``named``: commands by name, each a port and
    a signal (``PORT.Signal``); ``units``: first words of the ports of each unit, if a train has several;
    ``injects``: places of faults inside its plant (``sensor.speed``).
    """

    name: str
    title: str
    ports: str
    plant: str
    controller: str
    laws: str
    law: str
    judging: str
    pictures: str
    scenarios: str = "railhil.scenarios.task:TaskScenarios"
    arithmetic: str = "iq"
    events: Mapping[str, int] = field(default_factory=dict)
    own: Mapping[str, str] = field(default_factory=dict)
    truth: Truth | None = None
    named: Mapping[str, str] = field(default_factory=dict)
    units: tuple[str, ...] = ()
    injects: tuple[str, ...] = ()
    numbered: bool = False

    def part(self, name: str) -> Any:
        """The object that one of this system's references names.

        :param name: a field, or an entry of ``own``.
        :raises InputError: there is no such part, or it cannot be imported.
        """
        reference = self.own.get(name) or getattr(self, name, None)
        if not isinstance(reference, str):
            raise InputError(f"system {self.name}", name, Words("no such part"), "a reference, module:object")
        module, _, attribute = reference.partition(":")
        try:
            with plugged_in():
                return getattr(import_module(module), attribute)
        except Exception as error:
            # Plug-in code may raise anything.
            cause = f"{type(error).__name__}: {error}"
            raise InputError(f"system {self.name}", name, reference, "a part that can be imported", cause) from error

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
        """Hash over the package that contains the plant: :func:`~railhil.common.plug_ins.held_sha256`.

        None if that package is railhil itself, whose hash is in every certificate.

        :raises InputError: the package cannot be imported.
        """
        name = self.plant.partition(":")[0].partition(".")[0]
        if name == __name__.partition(".")[0]:
            return None
        self.part("plant")
        return held_sha256(name)

    def law_sha256(self, name: str) -> str | None:
        """Hash over what the distribution of one of its laws holds; None for a law of railhil, whose hash is in every
        certificate, and for one that is not installed."""
        law = entries(self.laws).get(name)
        return None if law is None or law.module.partition(".")[0] == OURS else held_sha256(law.module, law.dist)

    def law_names(self) -> list[str]:
        """Names of the installed laws for this system, in the order of every table."""
        return in_order(entries(self.laws))

    def check_law(self, name: str, source: str | Path, key: str) -> None:
        """Refuse a name that no law of this system has.

        :param source, key: where the name comes from, for the error.
        :raises InputError: there is no such law.
        """
        known = self.law_names()
        if name not in known:
            raise InputError(source, key, name, ", ".join(known), did_you_mean(name, known))


def names() -> list[str]:
    """Names of the installed systems, sorted."""
    return sorted(entries(GROUP))


def system_named(name: str, file: str | Path = "scenario") -> System:
    """The installed system of that name.

    :param file: the file that names it, for the error.
    :raises InputError: there is none, or its entry point is not usable.
    """
    found = entries(GROUP)
    if name not in found:
        allowed = f"one that is installed: {', '.join(sorted(found))}"
        raise InputError(file, "system", name, allowed, did_you_mean(name, found))
    entry = found[name]
    try:
        with plugged_in():
            system = entry.load()
    except Exception as error:
        # Plug-in code may raise anything.
        cause = f"{type(error).__name__}: {error}"
        raise InputError(file, "system", entry.value, "an entry point that can be imported", cause) from error
    if not isinstance(system, System) or system.name != name:
        raise InputError(file, "system", entry.value, f"an entry point in {GROUP} naming a System called {name}")
    for event, number in system.events.items():
        if number not in OWN_EVENTS:
            allowed = f"{OWN_EVENTS.start} to {OWN_EVENTS[-1]}"
            raise InputError(f"system {name}", f"events.{event}", number, allowed)
    return system
