"""The command line of the controller process."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from railhil.bus.can_settings import add_bus_arguments, named_bus
from railhil.bus.link import open_link
from railhil.bus.select import choose_bus
from railhil.bus.sent import SentFrames
from railhil.common.command_line import OneLineParser, accept_former_name, add_priority_argument, parse
from railhil.common.exit_codes import ignore_ending_signals
from railhil.common.python_process import kill_this_process, stop_this_process
from railhil.common.scheduling import cycle
from railhil.common.user_files import check_writable, refuse_unwritable
from railhil.controller_node.controller import make_controller_node, write_fault_log
from railhil.controller_node.laws import law_class
from railhil.controller_node.process_loop import FIRST_FRAME_S, run_controller
from railhil.controller_node.telemetry_file import law_document, write_telemetry
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.options import OR_YOURS, add_law_options, add_option, add_options, law_spec
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.scenario_pipe import OPTION, receive_scenario


def arguments() -> argparse.ArgumentParser:
    """Command line of the controller node."""
    parser = OneLineParser(
        prog="railhil node controller",
        description="Train speed controller on the bus.",
        examples=["railhil node controller yizhuang_05 --controller ipfc_plus -i socketcan -c vcan0"],
    )
    add_option(parser, "scenario")
    add_option(parser, "--controller", OR_YOURS)
    add_law_options(parser)
    add_option(parser, "--parameters")
    add_option(parser, "--memory-from")
    parser.add_argument("--telemetry", type=Path, metavar="FILE", help="write the telemetry of the arithmetic there")
    parser.add_argument(
        "--check", action="store_true", help="only make the controller and say what the law says of itself (JSON)"
    )
    add_options(parser, "--set", "--fault", "--fault-logs")
    accept_former_name(parser, "--fault-log", "--fault-logs")
    add_option(parser, "--seed", ", which only faults use here")
    add_option(parser, "--appear-timeout", default=FIRST_FRAME_S, usual=f"{FIRST_FRAME_S:g} s")
    add_options(parser, "--sent-file", OPTION)
    add_option(parser, "--patience", ": the bus administrator may wait for another node")
    add_priority_argument(parser, 0, "0")
    add_bus_arguments(parser)
    return parser


def _scenario(namespace: argparse.Namespace) -> AnyScenario:
    if namespace.handed_scenario is not None:
        return receive_scenario(namespace.handed_scenario)
    from railhil.scenarios.load import load_any

    return load_any(namespace.scenario, namespace.set, namespace.fault)


def _law(namespace: argparse.Namespace, scenario: AnyScenario) -> LawSpec:
    """The law, with the parameters and the memory of its files; their readers are imported only if there are such
    files."""
    parameters, memory = None, None
    if namespace.parameters is not None:
        from railhil.scenarios.parameters import load_parameters

        parameters = load_parameters(namespace.parameters)
    if namespace.memory_from is not None:
        from railhil.scenarios.memory_store import read_memory

        memory = read_memory(namespace.memory_from)
    return law_spec(namespace, scenario, namespace.controller, parameters, memory)


def main(words: Sequence[str] | None = None) -> int:
    """Serve one run; exit code 0 when it came to its end."""
    namespace = parse(arguments(), words)
    scenario = _scenario(namespace)
    law = _law(namespace, scenario)
    if namespace.check:
        # First load the law, then check whether it can be made as requested.
        print(json.dumps(law_document(law.controller, law_class(law, scenario))), flush=True)
        make_controller_node(scenario, RunSpec(law=law)).close()
        return 0
    if namespace.telemetry is not None:
        with refuse_unwritable("--telemetry", namespace.telemetry, "file"):
            check_writable(namespace.telemetry)
    choice = choose_bus(named_bus(namespace))
    print(f"controller: {choice.transport} ({choice.reason})", file=sys.stderr)
    node = make_controller_node(
        scenario,
        RunSpec(law=law, seed=namespace.seed, patience_s=namespace.patience),
        fd=choice.fd,
        bit_rate=getattr(namespace, "bitrate", None),
        folder=namespace.fault_logs,
        kill=kill_this_process,
        pause=stop_this_process,
    )
    link = open_link(choice.config, "controller")
    link.sent = SentFrames(namespace.sent_file, "controller") if namespace.sent_file else None
    try:
        with cycle("controller", namespace.realtime_priority):
            return run_controller(node, link, appear_s=namespace.appear_timeout, patience_s=namespace.patience)
    finally:
        node.close()
        # The telemetry is also written if the run ended early: the values measured until then are evidence.
        if namespace.telemetry is not None:
            ignore_ending_signals()
            write_telemetry(node, namespace.telemetry)
        if scenario.faults:
            ignore_ending_signals()
            write_fault_log(node)
        if link.sent is not None:
            # A foreign controller need not state it.
            link.sent.received = getattr(node, "received", None)
            link.sent.write()
