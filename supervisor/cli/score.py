"""``railhil score``: the same numbers again, from the log alone."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from rich.console import Console

from bus.exitcodes import FAIL, INVALID, PASS
from bus.ident import CtlIdent, PltIdent
from dbc import wire_contract
from scenarios.errors import InputError, Words
from scenarios.load import load
from scenarios.model import Scenario
from supervisor.cli.show import print_verdict, score_table
from supervisor.framelog import read_log
from supervisor.score import score
from supervisor.trace import Trace, trace_of


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser("score", help="score a recorded log")
    parser.add_argument("log", help="frames.log, or the run folder that holds it")
    parser.add_argument("--scenario", help="shipped name or TOML file (default: what certificate.json says)")
    parser.add_argument("--json", action="store_true", help="machine-readable output")
    parser.set_defaults(work=work)


def log_path(text: str) -> Path:
    """Path of the candump log that a user named by itself or by its run folder."""
    path = Path(text)
    return path / "frames.log" if path.is_dir() else path


def recorded_scenario(log: Path, name: str | None) -> Scenario:
    """The scenario that a log was recorded with: by name, else from the certificate beside the log.

    :raises InputError: neither says it.
    """
    if name is not None:
        return load(name)
    path = log.parent / "certificate.json"
    try:
        document: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        return load(str(document["scenario"]))
    except (OSError, KeyError, TypeError, ValueError):
        raise InputError(
            path, "scenario", Words("no such entry"), "a certificate beside the log, or --scenario"
        ) from None


def checked_trace(log: Path, scenario: Scenario) -> Trace:
    """Telegrams of a log, after its handshake was compared with scenario and DBC.

    :raises InputError: the log belongs to something else, or is no log.
    """
    trace = trace_of(read_log(log))
    ident = trace.ident(PltIdent)
    if ident is None:
        raise InputError(log, "PLT_IDENT", Words("no such telegram"), "a log that railhil recorded from its start")
    wanted_wire = int(wire_contract().sha256[:8], 16)
    if ident.wire_hash != wanted_wire:
        raise InputError(log, "DBC hash", f"{ident.wire_hash:08x}", f"{wanted_wire:08x} (the DBC of this installation)")
    wanted = int(scenario.sha256[:8], 16)
    if ident.scenario_hash != wanted:
        raise InputError(log, "scenario hash", f"{ident.scenario_hash:08x}", f"{wanted:08x} ({scenario.name})")
    return trace


def work(namespace: argparse.Namespace) -> int:
    """Score and print; the exit code is the verdict."""
    log = log_path(namespace.log)
    if not log.is_file():
        raise InputError(log, "file", Words("no such file"), "a candump log")
    scenario = recorded_scenario(log, namespace.scenario)
    trace = checked_trace(log, scenario)
    result = score(scenario, trace)
    if namespace.json:
        print(json.dumps(result.as_json(), indent=2))
    else:
        console = Console()
        label = "recorded" if trace.ident(CtlIdent) is None else "from the log"
        if result.itae is not None:
            console.print(score_table(scenario, result, label))
        print_verdict(console, result.verdict, "; ".join(result.failures))
    return {"PASS": PASS, "FAIL": FAIL}.get(result.verdict, INVALID)
