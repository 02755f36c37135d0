"""``railhil run --panel``: the panel's process beside a run."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from railhil.bus.select import BusChoice
from railhil.common.command_line import whole_number
from railhil.common.errors import InputError, Words
from railhil.common.extras import install_command
from railhil.common.output import Output
from railhil.scenarios.run_spec import RunSpec

_PORT_MAX = 65535
_END_S = 2.0


def add_panel_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of a run with a panel."""
    parser.add_argument(
        "--panel",
        nargs="?",
        const=8765,
        type=whole_number(0, _PORT_MAX),
        metavar="PORT",
        help="serve a page of the run on 127.0.0.1 (default port 8765; 0: any), see railhil panel",
    )


def check_panel(namespace: argparse.Namespace, spec: RunSpec) -> None:
    """Refuse a panel that could not hear or serve anything.

    :raises InputError: the run has no bus, or the extra is not installed.
    """
    if namespace.panel is None:
        return
    if spec.is_local:
        raise InputError(
            "command line", "--panel", Words("beside --bus local"), "a run over a bus, which it listens to"
        )
    try:
        import websockets  # noqa: F401
    except ImportError as error:
        found = Words(f"module {error.name} is not installed")
        raise InputError("command line", "--panel", found, install_command("panel"), "the extra [panel]") from None


@contextmanager
def panel_beside(namespace: argparse.Namespace, spec: RunSpec, choice: BusChoice, console: Output) -> Iterator[None]:
    """The panel's process while a run is made; nothing without ``--panel``."""
    if namespace.panel is None:
        yield
        return
    words = [*spec.scenario_words, "--port", str(namespace.panel), "--controller", spec.law.controller]
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "railhil.panel", *words, *choice.arguments], stdin=subprocess.DEVNULL
    )
    try:
        yield
    finally:
        process.terminate()
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
