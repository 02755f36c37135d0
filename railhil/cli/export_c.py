"""``railhil export-c``: write a control law as C99, from the same source that the bench runs."""

from __future__ import annotations

import argparse
import contextlib
import sys
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from railhil.common.command_line import OneLineParser, parse
from railhil.common.errors import InputError, OptionError, Words
from railhil.common.exit_codes import run_guarded
from railhil.common.output import Output, number, table
from railhil.controller_node.cost import estimated_cycles
from railhil.controller_node.export.bundle import control_of, make_bundle, write_bundle
from railhil.controller_node.export.control import Control, Source
from railhil.controller_node.laws import is_floating
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.options import add_option, add_options
from railhil.scenarios.parameters import load_parameters
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.system import System

if TYPE_CHECKING:
    from railhil.controller_node.export.c28x import LawStream


def arguments() -> argparse.ArgumentParser:
    """Command line of the export."""
    parser = OneLineParser(
        prog="railhil export-c",
        description="Write a control law as C99 for the target.",
        examples=[
            "railhil export-c ipfc_plus --out build/ipfc_plus",
            "railhil export-c ipfc_plus yizhuang_05 --arithmetic float32 --out build/float",
        ],
    )
    add_options(parser, "law", "scenario", "--set")
    add_option(parser, "--out DIR", ", new or empty", required=True, type=Path)
    add_options(parser, "--indexing", "--parameters")
    add_option(parser, "--arithmetic", choices=("iq", "float32"), usual="iq where the law has it, else float32")
    add_option(parser, "--fmu", ", built by a C compiler (needs the extra [fmi])")
    parser.add_argument("--fmi-version", choices=("2.0", "3.0"), help="FMI of the FMU (default: 2.0)")
    listing = "write NAME_c28x.txt too: the law as C28x instructions, and print their cycles beside the estimate"
    parser.add_argument("--c28x", action="store_true", help=listing)
    parser.add_argument("--force", action="store_true", help="write into a folder that is not empty")
    return parser


def _run(scenario: AnyScenario, law: LawSpec, controller: Any) -> None:
    """A run of the bench in this process, of which only the control periods are used."""
    # Plant and supervisor are needed only for a log that contains such a run.
    from railhil.bus.errors import BusError
    from railhil.plant_sim.any_plant import PlantError
    from railhil.run.local import local_run

    # The inputs that the law received before an error are a log too.
    with TemporaryDirectory() as folder, contextlib.suppress(BusError, PlantError):
        local_run(scenario, Path(folder), RunSpec(law=law), controller=controller)


def _arithmetic(namespace: argparse.Namespace, system: System) -> str:
    """The arithmetic in which the law is written.

    :raises InputError: it cannot be written in the requested one.
    """
    floating = is_floating(namespace.law, system.laws)
    asked: str | None = namespace.arithmetic
    if floating and asked == "iq":
        raise InputError("command line", "--arithmetic", asked, f"float32: {namespace.law} has no fixed-point formats")
    return asked or ("float32" if floating else "iq")


def _instructions(control: Control) -> tuple[LawStream, int]:
    """The law as C28x instructions, and the control periods in which they were compared with it.

    :raises InputError: it has no straight line of instructions, or these give other results.
    """
    from railhil.controller_node.export.c28x import LawStream
    from railhil.controller_node.export.reference import count_equal_periods

    law = control.law
    if law.arithmetic != "iq":
        raise OptionError("--c28x", "used only with the arithmetic iq")
    try:
        stream = LawStream(control.programs)
    except ValueError as error:
        allowed = "a law whose operations are straight lines of instructions"
        raise InputError("command line", "--c28x", Words(f"{law.controller} has {error}"), allowed) from error
    return stream, count_equal_periods(control, stream.function, "its C28x instructions")


def main() -> int:
    """Write the files and list them."""
    namespace = parse(arguments())
    if namespace.fmi_version and not namespace.fmu:
        raise OptionError("--fmi-version", "used only with --fmu")
    parameters = None if namespace.parameters is None else load_parameters(namespace.parameters)
    scenario = load_any(namespace.scenario, namespace.set)
    system = scenario.installed_system
    system.refuse_whole_runs("export-c", namespace.scenario)
    law = LawSpec(namespace.law, _arithmetic(namespace, system), indexing=namespace.indexing, parameters=parameters)
    bundle = make_bundle(scenario, law, lambda controller: _run(scenario, law, controller))
    # A law that may wrap is refused here, and must not run on a chip either.
    system.part("controller")(scenario, law)
    if namespace.c28x:
        control = control_of(scenario, law)
        stream, periods = _instructions(control)
        bundle.files[f"{bundle.source.name}_c28x.txt"] = stream.listing()
    write_bundle(bundle, namespace.out, force=namespace.force)
    if not namespace.c28x:
        # The instructions of an earlier export are not those of this law.
        (namespace.out / f"{bundle.source.name}_c28x.txt").unlink(missing_ok=True)
    fmu = namespace.out / f"{bundle.source.name}.fmu"
    if namespace.fmu:
        from railhil.controller_node.export.fmu import write_fmu

        write_fmu(bundle, scenario, law, fmu, namespace.fmi_version or "2.0")
    _list(bundle.files, f"{namespace.law} {_size(bundle.source)}", namespace.out)
    if namespace.fmu:
        print(f"wrote {fmu}")
    if namespace.c28x:
        _list_cycles(stream, control.programs.step_counts())
        print(f"a model: every word of {periods} control periods is the law's, no chip has run it")
    return 0


def _size(source: Source) -> str:
    """Resources that a law needs on the target."""
    words = source.constant_words + sum(source.table_words.values())
    return (
        f"on the target: {source.ram_words} words of RAM, {words} words of constants, "
        f"stack about {max(source.stack_words.values())} words (estimate for cl2000)"
    )


def _list(files: Mapping[str, str], size: str, folder: Path) -> None:
    """The files and their needs on the target."""
    console = Output()
    console.print(table("file", number("bytes"), rows=((name, str(len(text))) for name, text in files.items())))
    console.say(f"{size}; not run on a C28x")
    console.say(f"wrote {folder}: make -C {folder} check, railhil target qemu {folder}")


def _list_cycles(stream: LawStream, counts: Counter[str]) -> None:
    """Cycles of the instructions of one control period, beside the estimate from the operations."""
    listing = table("one control period", *map(number, ("operations", "C28x cycles", "estimate")))
    for name, cycles in stream.cycles.most_common():
        estimate = estimated_cycles(Counter({name: counts[name]})) if name in counts else ""
        listing.add_row(name, str(counts[name] or ""), str(cycles), str(estimate))
    listing.add_row("together", "", str(stream.cycles.total()), str(estimated_cycles(counts)))
    Output().print(listing)
    print(f"{len(stream.period)} instructions, {stream.words} words; in {stream.inactive} cycles the pipeline waits")


if __name__ == "__main__":
    sys.exit(run_guarded("railhil export-c", main))
