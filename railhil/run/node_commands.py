"""The bus of a run, command lines of the nodes that the supervisor starts itself, and the effect of faults on both."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.bus.link.pipes import Pipes
from railhil.bus.select import BusChoice, choose_bus, no_bus, own_pipes
from railhil.common.errors import InputError
from railhil.common.scheduling import HUB_PRIORITY, NODE_PRIORITY
from railhil.faults import parse_faults
from railhil.live.processes import Nodes
from railhil.live.sockets import make_private_socket
from railhil.record.run_folder import TELEMETRY, TIMING
from railhil.record.senders import sent_file
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.scenario_pipe import offer_scenario


def _scheduling(run: RunSpec, priority: int) -> list[str]:
    return ["--realtime-priority", str(priority)] if run.asks_for_fifo else []


def needs_orders(faults: Iterable[str]) -> bool:
    """Whether some of a run's faults need a hub that takes orders."""
    found = parse_faults(faults)
    if not found:
        return False
    # A run without faults does not load the injection.
    from railhil.bus.injector.bus_faults import need_orders

    return need_orders(found)


def start_hub(nodes: Nodes, run: RunSpec, choice: BusChoice, faults: Sequence[str] = ()) -> None:
    """Start the hub of this run alone.

    :param faults: faults of the run; some need a hub that takes orders.
    """
    arguments = ["-c", choice.config["channel"], "--once", *_scheduling(run, HUB_PRIORITY)]
    arguments += ["--faults"] * needs_orders(faults)
    nodes.start("hub", "railhil.bus.hub", arguments)


def start_nodes(
    nodes: Nodes,
    run: RunSpec,
    choice: BusChoice,
    folder: Path,
    scenario: AnyScenario,
    pipes: Pipes | None = None,
) -> None:
    """Start plant and controller; their measurements go into the run folder.

    :param scenario: the loaded scenario of the run, which is passed to the nodes. With faults they log their
        injections, and the controller needs the seed.
    :param pipes: between the nodes, instead of a bus.
    """
    faulty = bool(scenario.faults)
    logged = ["--fault-logs", str(folder)] if faulty else []
    patience = ["--patience", str(run.patience_s)]
    with offer_scenario(scenario) as (words, inherits):

        def start(role: str, module: str, own: Sequence[str], watches: Sequence[str] = ()) -> None:
            bus = choice.arguments if pipes is None else ["-i", HUB_INTERFACE, "-c", pipes.ends[role].channel]
            ends = () if pipes is None else pipes.ends[role].descriptors
            shared = [*run.scenario_words, *words, *patience, *logged]
            nodes.start(role, module, [*shared, *own, *bus], watches, [*inherits, *ends])
            if pipes is not None:
                pipes.handed_over(role)

        foreign = run.start_up.foreign
        ours = ["supervisor"] if foreign else ["supervisor", "controller"]
        start("plant", "railhil.plant_sim", _of_plant(run, folder), ours)
        if not foreign:
            law = [*run.law.words, "--telemetry", str(folder / TELEMETRY)]
            law += ["--sent-file", str(sent_file(folder, "controller")), *_scheduling(run, NODE_PRIORITY)]
            law += ["--seed", str(run.seed)] if faulty else []
            start("controller", "railhil.controller_node", law)


def _of_plant(run: RunSpec, folder: Path) -> list[str]:
    words = ["--seed", str(run.seed), "--pace", run.pace, "--appear-timeout", str(run.start_up.appear_s)]
    words += ["--perturbed"] * run.perturbed + run.number_words
    words += run.plant_fmu.words if run.plant_fmu is not None else []
    if run.is_realtime:
        words += ["--rate", str(run.rate)]
        # Without the option a plant would request it by itself.
        words += _scheduling(run, NODE_PRIORITY) or ["--realtime-priority", "0"]
        words += ["--timing-file", str(folder / TIMING)]
    return [*words, "--sent-file", str(sent_file(folder, "plant"))]


def longest_stop_s(texts: Iterable[str]) -> float:
    """The longest time in s for which one of a run's faults stops the controller's process; 0: none does."""
    stops = (
        one
        for one in parse_faults(texts)
        if (one.place.level, one.place.name, one.what) == ("node", "controller", "stop")
    )
    return max((one.duration_s or 0.0 for one in stops), default=0.0)


@contextmanager
def chosen_bus(spec: RunSpec, scenario: AnyScenario) -> Iterator[BusChoice]:
    """The bus of one run; the socket of the run's own hub is in a temporary folder. A run in lockstep that would get a
    hub unasked, and whose faults need no hub, gets pipes between its nodes.

    :raises InputError: the chosen bus cannot carry a run.
    """
    if spec.is_local:
        yield no_bus(spec.can, spec.pace)
        return
    with make_private_socket() as private:
        choice = choose_bus(spec.can, None if spec.start_up.joins else private)
        interface = choice.config.get("interface")
        if interface == "virtual":
            allowed = "an interface that other processes can open"
            raise InputError("command line", "--interface", interface, allowed)
        # A run that waits for its start may get faults of the bus meanwhile.
        may_need_hub = spec.is_realtime or spec.start_up.waits or needs_orders(scenario.faults)
        if gets_pipes(spec.can, choice) and not may_need_hub:
            choice = own_pipes()
        yield choice


def gets_pipes(given: Mapping[str, Any], choice: BusChoice) -> bool:
    """Whether a run in lockstep whose faults need no hub gets pipes instead of the chosen bus: the choice is a hub of
    its own that the user has not named."""
    return choice.needs_hub and "interface" not in given
