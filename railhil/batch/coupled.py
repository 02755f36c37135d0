"""Runs of many seeds without a bus, for systems whose laws use an ``Interface``; equal to runs of the nodes.

The part ``batch`` of such a system is :func:`run_coupled`, its part ``digest`` is :func:`command_digest`.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from railhil.batch.case import Batch, Case, SequenceRun
from railhil.batch.nodes import DIGITS
from railhil.controller_node.arithmetic import make
from railhil.controller_node.law_controller import maker_of
from railhil.controller_node.vector.law import Interface
from railhil.judge.result import Result
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec


def run_coupled(case: Case, seeds: Sequence[int]) -> Batch:
    """Run a case with each seed through the system's part ``direct``.

    :raises InputError: law, arithmetic or parameters do not fit, or a fault needs the nodes.
    """
    direct = case.scenario.installed_system.part("direct")
    runs: list[Result] = [direct(case.scenario, case.run(int(seed))) for seed in seeds]
    digests = [command_digest(case.scenario, run.trace) for run in runs]
    return Batch.of_results(case.scenario, seeds, runs, digests)


def digest_of(commands: ArrayLike) -> str:
    """First digits of the SHA-256 of raw commands, shape (control periods, commands), as 64-bit integers."""
    return hashlib.sha256(np.ascontiguousarray(commands, dtype="<i8").tobytes()).hexdigest()[:DIGITS]


def command_digest(scenario: AnyScenario, trace: Trace) -> str:
    """:func:`digest_of` a recorded run: the commands of the first poll in each control period."""
    interface: Interface = scenario.installed_system.part("interface")
    columns: list[NDArray[Any]] = []
    for item in interface.commands:
        port = item.telegram.PORT
        signal = dict(item.telegram.signals())[item.field].name
        periods = np.array(trace.times_ns(port), dtype=np.int64) // scenario.timing.control_period_ns
        columns.append(trace.raw(port, signal)[np.diff(periods, prepend=-1) > 0])
    return digest_of(np.stack(columns, axis=1))


def digest_of_run(run: Result) -> str:
    """Digest of a run: the system's own, or of its commands, or the first digits of that of its frames."""
    system = run.scenario.installed_system
    if system.digest is not None:
        return str(system.part("digest")(run.scenario, run.trace))
    if system.interface is not None:
        return command_digest(run.scenario, run.trace)
    return run.frames_sha256[:DIGITS]


def direct_sequence_run(scenario: AnyScenario, spec: RunSpec) -> SequenceRun:
    """One run of a sequence through the system's part ``direct``."""
    system = scenario.installed_system
    controller: Any = maker_of(system, scenario)(scenario, spec.law, make(spec.law.arithmetic))
    run: Result = system.part("direct")(scenario, spec, controller=controller)
    run.arithmetic = controller.counters
    return SequenceRun.of(run, digest_of_run(run), controller.kept())
