"""``railhil replay``: a recorded log drives one node, whose answers are compared with the recorded ones."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from railhil.bus.ident import PACES, PltIdent, is_perturbed
from railhil.common.digits import count_of
from railhil.common.errors import InputError, OptionError, Words, did_you_mean
from railhil.common.exit_codes import FAIL, PASS
from railhil.common.output import Output
from railhil.common.streams import add_json_argument, print_json
from railhil.judge.record import Record, checked_record
from railhil.scenarios.given import NamedCode, RecordedController, refuse_beside
from railhil.scenarios.options import OR_YOURS, add_controller_fmu_options, add_fmu_options, add_option, named_code
from railhil.scenarios.plant_fmu import KEY as FMU_KEY
from railhil.scenarios.plant_fmu import OPTION as FMU_OPTION
from railhil.scenarios.run_spec import LawSpec, RunSpec


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "replay",
        examples=[
            "railhil replay runs/mine --node controller",
            "railhil replay runs/mine --node plant --port TRN_SPEED",
        ],
    )
    add_option(parser, "log")
    parser.add_argument("--node", choices=("controller", "plant"), required=True, help="the node that is driven")
    add_option(parser, "--scenario")
    add_option(parser, "--controller", OR_YOURS, usual="that of the certificate")
    add_option(parser, "--arithmetic", usual="that of the certificate")
    parser.add_argument(
        "--port", action="append", default=[], metavar="PORT", help="compare only this port (default: all of the node)"
    )
    add_fmu_options(parser)
    add_controller_fmu_options(parser)
    add_json_argument(parser)


def work(namespace: argparse.Namespace) -> int:
    """Replay, compare, print; exit code 0 for equal frames, 1 for others."""
    # Laws and plant are loaded only by processes that compute with them.
    from railhil.run.replay import facts, replay

    record = checked_record(namespace.log, namespace.scenario)
    spec = _spec(record, namespace)
    _check(record, namespace.node, spec)
    replayed = replay(namespace.node, list(record.frames()), record.scenario, spec)
    ports = _ports(record.log, namespace.port, sorted(replayed.ports))
    first = replayed.first(ports)
    if namespace.json:
        print_json({**facts(replayed, ports), "notes": list(record.unused)})
        return PASS if replayed.same(ports) else FAIL
    console = Output()
    for note in record.unused:
        console.say(note)
    law = f" ({spec.law.label} {spec.law.arithmetic})" if namespace.node == "controller" else f" (seed {spec.seed})"
    console.say(
        f"{namespace.node}{law} driven by {record.log}: {count_of(replayed.frames, 'frame')}, "
        f"{replayed.sim_time_s:.2f} s in {replayed.wall_time_s:.2f} s = {replayed.speed_factor:.0f} times real time"
    )
    for name in ports:
        found = replayed.ports[name]
        more = f", {found.unrecorded} answers to polls without a recorded one" if found.unrecorded else ""
        console.say(f"{name}: {found.equal} of {count_of(found.recorded, 'frame')} equal{more}")
    if first is not None:
        console.say(f"first difference: {first.sentence}")
    return PASS if replayed.same(ports) else FAIL


def _spec(record: Record, namespace: argparse.Namespace) -> RunSpec:
    """The run of a record: from its certificate, else from its handshake and the command line.

    :raises InputError: no such law; for the plant, another FMU than the run's.
    """
    controller, arithmetic, (fmu, given) = namespace.controller, namespace.arithmetic, named_code(namespace)
    system = record.system
    if namespace.node == "controller" and fmu is not None:
        raise OptionError(FMU_OPTION, "used only with --node plant")
    if record.certificate:
        # The controller needs no plant.
        left_out = {FMU_KEY} if namespace.node == "controller" else set()
        kept = {key: value for key, value in record.certificate.items() if key not in left_out}
        spec = RunSpec.from_json(kept, record.log, NamedCode(fmu))
    else:
        ident = record.trace.ident(PltIdent)
        assert ident is not None, "checked_record has read it"
        pace = PACES[ident.pace] if 0 < ident.pace < len(PACES) else "lockstep"
        spec = RunSpec(
            law=LawSpec(system.law), seed=ident.seed, perturbed=is_perturbed(ident), pace=pace, plant_fmu=fmu
        )
    law = spec.law
    if given is not None:
        refuse_beside(given, {"--arithmetic": arithmetic})
        return replace(spec, law=LawSpec.of_given(given, law.indexing, law.task_period_ms))
    if isinstance(law.given, RecordedController) and namespace.node == "controller":
        raise law.given.refuse()
    if controller is not None and controller != law.controller:
        # Parameters and memory belong to the other law.
        law = LawSpec(controller, law.arithmetic, law.indexing, task_period_ms=law.task_period_ms)
    if arithmetic is not None:
        law = replace(law, arithmetic=arithmetic)
    if law.given is None:
        # The law of a controller of the user's is not one of the system's; the plant needs neither.
        system.check_law(law.controller, "command line", "--controller")
    return replace(spec, law=law)


def _check(record: Record, node: str, spec: RunSpec) -> None:
    """Refuse a record that the nodes of this version cannot be driven with.

    :raises InputError: another wire contract; for the plant, a run in real time.
    """
    now = record.system.contract.sha256
    if record.trace.contract.sha256 != now:
        raise InputError(record.log, "DBC", record.trace.contract.sha256, f"{now}: the wire contract of this version")
    if node == "plant" and spec.is_realtime:
        found = Words("a run in real time")
        raise InputError(record.log, "pace", found, "lockstep: which answers came in time is not in the record")


def _ports(log: Path, asked: list[str], there: list[str]) -> list[str]:
    """The ports to compare.

    :raises InputError: the record has no frame of a port.
    """
    for name in asked:
        if name not in there:
            raise InputError("command line", "--port", name, ", ".join(there), did_you_mean(name, there))
    if not there:
        raise InputError(log, "", Words("has no frame of the node"), "a record of a run with its answers")
    return asked or there
