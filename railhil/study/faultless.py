"""What random faults of a scenario need to know: the telegrams of its run without faults, and what can be injected."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory

from railhil.common.errors import InputError
from railhil.faults.capability import why_not
from railhil.faults.language import parse
from railhil.faults.random_faults import Sent
from railhil.record.trace import Trace
from railhil.run.make import run_into
from railhil.scenarios.fault_list import fault_texts, list_disturbed_signals
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import System


def sent_ports(trace: Trace, ports: Iterable[str]) -> dict[str, Sent]:
    """Times at which a run sent each of the ports; ports that it never sent are left out."""
    found = {}
    for port in ports:
        times_s = trace.times_s(port)
        if len(times_s):
            apart_s = max((float(after - before) for before, after in pairwise(times_s)), default=0.0)
            found[port] = Sent(float(times_s[0]), float(times_s[-1]), apart_s)
    return found


def faultless_run(base: RunSpec, out: Path | None = None) -> tuple[float, dict[str, Sent]]:
    """Duration in s of the timetable, or of the run without faults if that is shorter; the telegrams of that run with
    their times.

    :param out: folder in which its own is made for a moment; None: that of the operating system.
    :raises InputError, NeverBegan: as :func:`run_into`.
    """
    with TemporaryDirectory(dir=out) as folder:
        result = run_into(Path(folder), replace(base, faults=()), keep=False)
    scenario, trace = result.scenario, result.trace
    return min(scenario.planned_s, trace.end_s), sent_ports(trace, list_disturbed_signals(scenario.installed_system))


def can_inject_in(system: System, base: RunSpec, text: str) -> bool:
    """Whether a run like ``base`` can inject a fault."""
    try:
        found = fault_texts([text], system, lambda row: Path("drawn"))
    except InputError:
        return False
    return not why_not(parse(found[0]), "local" if base.is_local else "hub", base.pace)
