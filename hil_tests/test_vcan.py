"""The bench on kernel SocketCAN: the same bytes as everywhere else.

The nodes are forked from this process instead of started as commands, because the virtual machine that gives the
kernel (:mod:`hil_tests.machines.vcan_vm`) takes ten seconds and more to import them once.
"""

from __future__ import annotations

import multiprocessing
import socket
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import can
import pytest

from bus.frame import Frame, to_message
from bus.link import open_link
from bus.select import BusChoice, choose_bus
from controller_node.node import ControllerNode, ControllerOptions, run_controller
from hil_tests.bench import local_run
from plant_sim.node import PlantOptions, run_plant
from scenarios.model import Scenario
from supervisor.run import Run, RunOptions, RunResult

pytestmark = [pytest.mark.needs_socketcan, pytest.mark.timeout(600)]

_CONFIG = {"interface": "socketcan", "channel": "vcan0"}
_SEED = 1
_SHORT_S = 12.0


def _plant(scenario: Scenario) -> None:
    raise SystemExit(run_plant(scenario, PlantOptions(seed=_SEED), open_link(_CONFIG)))


def _controller(scenario: Scenario) -> None:
    raise SystemExit(run_controller(ControllerNode(scenario, ControllerOptions()), open_link(_CONFIG)))


def vcan_run(scenario: Scenario, folder: Path) -> tuple[RunResult, list[int | None]]:
    """One run of three processes on vcan0; the result and the exit codes of plant and controller."""
    fork = multiprocessing.get_context("fork")
    nodes = [fork.Process(target=target, args=(scenario,)) for target in (_controller, _plant)]
    for node in nodes:
        node.start()
    try:
        options = RunOptions(scenario.name, seed=_SEED, attach=True)
        result = Run(scenario, options, BusChoice(_CONFIG, "test"), folder).execute()
        for node in nodes:
            node.join(10)
        return result, [node.exitcode for node in nodes]
    finally:
        for node in nodes:
            node.kill()
            node.join()
