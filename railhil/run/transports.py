"""The bus of a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from railhil.bus.select import BusChoice, choose_bus, no_bus, own_pipes
from railhil.common.errors import InputError
from railhil.live.sockets import private_socket
from railhil.run.node_commands import needs_orders
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec


@contextmanager
def chosen_bus(spec: RunSpec, scenario: AnyScenario) -> Iterator[BusChoice]:
    """The bus of one run; the socket of the run's own hub is in a temporary folder. A run in lockstep that would get a
    hub unasked, and whose faults need no hub, gets pipes between its nodes.

    :raises InputError: the chosen bus cannot carry a run.
    """
    if spec.is_local:
        yield no_bus(spec.can, spec.pace)
        return
    with private_socket() as private:
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
