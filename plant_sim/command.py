"""The command line of the plant process."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from railhil.bus.can_settings import add_bus_arguments, named_bus
from railhil.bus.errors import BusUnavailable
from railhil.bus.link import open_link
from railhil.bus.select import choose_bus
from railhil.bus.sent import SentFrames
from railhil.common.command_line import OneLineParser, accept_former_name, add_priority_argument, parse
from railhil.common.errors import OptionError
from railhil.common.exit_codes import ignore_ending_signals
from railhil.common.patience import Lifelines
from railhil.common.scheduling import NODE_PRIORITY, cycle
from railhil.common.user_files import check_writable, refuse_unwritable
from railhil.plant_sim.node import PlantNode, make_plant_node
from railhil.scenarios.options import add_fmu_options, add_options, add_run_options, named_fmu, run_spec
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.scenario_pipe import OPTION, receive_scenario


def arguments() -> argparse.ArgumentParser:
    """Command line of the plant node."""
    parser = OneLineParser(
        prog="railhil node plant",
        description="Train simulator and bus administrator.",
        examples=["railhil node plant yizhuang_05 -i socketcan -c vcan0"],
    )
    add_run_options(parser)
    add_options(parser, "--set", "--fault")
    add_fmu_options(parser)
    parser.add_argument(
        "--timing-file", type=Path, metavar="FILE", help="realtime: file for lateness and latencies, written at the end"
    )
    add_options(parser, "--fault-logs", "--lifeline", "--sent-file", OPTION)
    accept_former_name(parser, "--fault-log", "--fault-logs")
    add_priority_argument(parser, None, f"{NODE_PRIORITY} with --pace realtime, else 0")
    add_bus_arguments(parser)
    return parser


def _check_timing_file(path: Path, pace: str) -> None:
    if pace != "realtime":
        raise OptionError("--timing-file", "used only with --pace realtime")
    with refuse_unwritable("--timing-file", path, "file"):
        check_writable(path)


def _need_orders(faults: Sequence[str]) -> bool:
    """Whether some of a run's faults need a hub that takes orders."""
    if not faults:
        return False
    # A plant without faults does not load the injection.
    from railhil.bus.injector.bus_faults import need_orders
    from railhil.faults.language import parse as parse_fault

    return need_orders(map(parse_fault, faults))


def run_plant(node: PlantNode, priority: int, timing_file: Path | None) -> None:
    """Run the plant to its end.

    :param priority: SCHED_FIFO priority to request, 0 for normal scheduling.
    :param timing_file: where to write the timing of a real-time run, even if it ends early.
    """
    try:
        with cycle("plant", priority):
            node.run()
    finally:
        if node.faults.sent is not None:
            ignore_ending_signals()
            node.faults.write_logs()
        if timing_file is not None and node.timing is not None:
            ignore_ending_signals()
            node.timing.write(timing_file)


def main(words: Sequence[str] | None = None) -> int:
    """Run one scenario; exit code 0 when it came to its end."""
    namespace = parse(arguments(), words)
    if namespace.timing_file is not None:
        _check_timing_file(namespace.timing_file, namespace.pace)
    # The plant does not depend on the law.
    run = replace(run_spec(namespace, LawSpec()), plant_fmu=named_fmu(namespace))
    scenario = run.load() if namespace.handed_scenario is None else receive_scenario(namespace.handed_scenario)
    choice = choose_bus(named_bus(namespace))
    print(f"plant: {choice.transport} ({choice.reason})", file=sys.stderr)
    priority = namespace.realtime_priority
    if priority is None:
        priority = NODE_PRIORITY if run.is_realtime else 0
    link = open_link(choice.config, "plant")
    link.lifelines = Lifelines(dict(namespace.lifeline))
    link.sent = SentFrames(namespace.sent_file, "plant") if namespace.sent_file else None
    try:
        if link.disturber is None and _need_orders(scenario.faults):
            raise BusUnavailable(f"{link.where}: takes no orders to disturb it, it must be a hub started with --faults")
        node = make_plant_node(
            scenario,
            run,
            link,
            fd=choice.fd,
            appear_s=namespace.appear_timeout,
            fault_log=namespace.fault_logs,
            disturber=link.disturber,
            packed=link.packed,
        )
        try:
            run_plant(node, priority, namespace.timing_file)
        finally:
            if link.sent is not None:
                link.sent.received = node.received
    finally:
        link.close()
        link.tell_trouble()
        if link.sent is not None:
            link.sent.write()
    return 0
