"""Command lines of the nodes that the supervisor starts itself."""

from __future__ import annotations

from pathlib import Path

from railhil.bus.select import BusChoice
from railhil.common.scheduling import HUB_PRIORITY, NODE_PRIORITY
from railhil.supervisor.jitter import TIMING
from railhil.supervisor.options import RunOptions
from railhil.supervisor.processes import Nodes
from railhil.supervisor.telemetry import FILE_NAME as TELEMETRY


def _scheduling(options: RunOptions, priority: int) -> list[str]:
    return ["--realtime-priority", str(priority)] if options.realtime_scheduling else []


def start_hub(nodes: Nodes, options: RunOptions, choice: BusChoice) -> None:
    """Start the hub of this run alone."""
    arguments = ["-c", choice.config["channel"], "--once", *_scheduling(options, HUB_PRIORITY)]
    nodes.start("hub", "railhil.bus.hub", arguments)


def start_nodes(nodes: Nodes, options: RunOptions, choice: BusChoice, folder: Path) -> None:
    """Start plant and controller; what they measure goes into the run folder."""
    plant = [*options.scenario_arguments, "--seed", str(options.seed), "--pace", options.pace]
    plant += ["--appear-timeout", str(options.appear_s), "--patience", str(options.patience_s)]
    plant += ["--perturbed"] * options.perturbed
    if options.pace == "realtime":
        plant += ["--rate", str(options.rate)]
        # A plant that is told nothing would ask by itself.
        plant += _scheduling(options, NODE_PRIORITY) or ["--realtime-priority", "0"]
        plant += ["--timing-file", str(folder / TIMING)]
    ours = ["supervisor"] if options.foreign else ["supervisor", "controller"]
    nodes.start("plant", "railhil.plant_sim", plant + choice.arguments, watches=ours)
    if options.foreign:
        return
    task = ["--task-period-ms", str(options.task_period_ms)] if options.task_period_ms else []
    law = [*options.law_arguments, *task, "--telemetry", str(folder / TELEMETRY)]
    law += ["--patience", str(options.patience_s), *_scheduling(options, NODE_PRIORITY)]
    nodes.start("controller", "railhil.controller_node", [*options.scenario_arguments, *law, *choice.arguments])
