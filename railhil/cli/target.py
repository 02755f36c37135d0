"""``railhil target qemu``: what a controller needs on an emulated board, and whether it computes there what it computes
on a host."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from railhil.common.command_line import OneLineParser, parse
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import FAIL, PASS, run_guarded
from railhil.common.output import Output
from railhil.controller_node.arithmetic import make
from railhil.controller_node.boards import shipped_boards
from railhil.controller_node.boards.emulator import Emulator
from railhil.controller_node.boards.given import PREFIX, USUAL, EmulatedController
from railhil.controller_node.cost import cost_of
from railhil.controller_node.export.bundle import control_of
from railhil.run.local import unrecorded_run
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.options import add_option, add_options
from railhil.scenarios.run_spec import LawSpec, RunSpec

#: Wall time for the reference log: a board computes some thousand control periods, on a busy machine.
_LOG_S = 300.0
_TICKS = "ticks "


def arguments() -> argparse.ArgumentParser:
    """Command line of the targets."""
    parser = OneLineParser(prog="railhil target", description="A controller in C on its target.")
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="KIND")
    qemu = kinds.add_parser(
        "qemu",
        help="an emulated board: image, reference log, a run in the loop",
        examples=["railhil target qemu build/ipfc_plus", "railhil target qemu build/ipfc_plus --board cortex_m3"],
    )
    qemu.add_argument("folder", metavar="DIR", help="an export (railhil export-c) or a C controller")
    add_option(qemu, "scenario", ", for which the folder was made")
    add_options(qemu, "--set", "--indexing")
    said = f"{', '.join(shipped_boards())}, or the folder of one such as ./myboard (default: {USUAL})"
    qemu.add_argument("--board", default=USUAL, metavar="NAME", help=said)
    return parser


def main() -> int:
    """Print size, log and figures of a run; exit code 1 if a word of the log differs on the board."""
    namespace = parse(arguments())
    given = EmulatedController(f"{PREFIX}{namespace.folder}@{namespace.board}")
    scenario = load_any(namespace.scenario, namespace.set)
    console = Output()
    if (said := check_log(given)) and not said.endswith("each"):
        console.say(f"reference log: {said}")
        return FAIL
    if said:
        console.say(f"reference log: {said}")
    law = LawSpec.of_given(given, namespace.indexing)
    result = unrecorded_run(scenario, RunSpec(scenario=namespace.scenario, settings=tuple(namespace.set), law=law))
    assert result.target is not None, "an emulated board states its figures"
    for heading, words in result.target.rows:
        console.say(f"{heading.lower()}: {words}")
    if given.law:
        console.say(f"estimate for the C28x: {_estimate(law, scenario)}")
    console.say(f"run: {result.verdict}, {result.sim_time_s:.2f} s in {result.wall_time_s:.2f} s")
    console.say(f"railhil run {namespace.scenario} --controller {given.text}")
    return PASS


def check_log(given: EmulatedController, optimisation: str = "-O2") -> str:
    """What the board says of the export's reference log; empty where there is none, or the board has no files.

    :raises InputError: see :meth:`~railhil.controller_node.boards.Board.build` and :class:`Emulator`.
    """
    name = given.name
    log = Path(given.folder.text, f"{name}_log.txt")
    if not log.is_file() or not given.board.table.log_arguments:
        return ""
    emulator = Emulator(given.board, given.board.build_log(log.parent, name, optimisation), _LOG_S)
    lines = [line for line in emulator.run(log, _LOG_S).splitlines() if not line.startswith(_TICKS)]
    if not lines:
        raise InputError(log, "", Words("no word about it from the board"), "a reference log")
    return lines[-1]


def _estimate(law: LawSpec, scenario: AnyScenario) -> str:
    """Cycles of the installed law of which the folder is an export."""
    assert law.given is not None
    installed = LawSpec(law.given.law, law.arithmetic, law.indexing)
    programs = control_of(scenario, installed).programs
    cost = cost_of(programs, make(law.arithmetic), scenario.timing.control_period_ns)
    return f"{cost.cycles} cycles a control period from RAM, {cost.cycles_flash} from flash"


if __name__ == "__main__":
    sys.exit(run_guarded("railhil target", main))
