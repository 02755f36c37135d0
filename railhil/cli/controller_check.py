"""Checks the controllers before the first run of a comparison: each is made once, in its own process, without a bus."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass

from railhil.common.errors import InputError
from railhil.record.telemetry import LawOrigin, law_origin
from railhil.run.make import NeverBegan
from railhil.scenarios.run_spec import RunSpec

_CHECK_S = 120.0


@dataclass(frozen=True, slots=True)
class Checked:
    """A law's declarations, and the line and exit code with which it refused (empty and 0 if it can run)."""

    indexings: tuple[str, ...]
    origin: LawOrigin
    line: str
    exit_code: int

    def require(self) -> None:
        """Continue only if the controller can run.

        :raises NeverBegan: it refused to run.
        """
        if self.exit_code:
            raise NeverBegan(self.line, self.exit_code)


def check_controllers(wanted: Sequence[RunSpec]) -> list[Checked]:
    """Make the controller of each run, all at once.

    :raises NeverBegan: a process ended before it could describe its law.
    """
    with ExitStack() as stack:
        started = []
        for spec in wanted:
            command = [sys.executable, "-P", "-m", "railhil.controller_node", *spec.scenario_words]
            command += [*spec.law.words, "--check"]
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            stack.callback(process.wait)
            stack.callback(process.kill)
            started.append(process)
        return [_answer(spec, process) for spec, process in zip(wanted, started, strict=True)]


def _answer(spec: RunSpec, process: subprocess.Popen[str]) -> Checked:
    said, complaint = process.communicate(timeout=_CHECK_S)
    lines = [line for line in complaint.splitlines() if line.strip()]
    line = lines[-1] if lines else f"{spec.law.controller}: exit code {process.returncode}"
    try:
        document = json.loads(said)
        indexings, origin = tuple(map(str, document["indexings"])), law_origin(document)
    except (ValueError, LookupError, TypeError, AttributeError):
        raise NeverBegan(line, process.returncode or InputError.exit_code) from None
    return Checked(indexings, origin, line, process.returncode)
