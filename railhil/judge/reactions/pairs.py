"""Runs with two random faults: the rules of every run hold in each of them."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from typing import Any

from railhil.faults.random_faults import Sent
from railhil.judge.reactions.evaluate import RULE
from railhil.judge.reactions.facts import VERDICTS
from railhil.judge.result import Result
from railhil.record.trace import Trace

#: Verdicts with which a run may end.
_ENDS = ("PASS", "FAIL", "INVALID", "TOOL ERROR")


@dataclass(frozen=True, slots=True)
class PairRun:
    """One run. ``failures``: rules that it breaks, empty if it keeps all."""

    number: int
    faults: Sequence[str]
    verdict: str
    failures: list[str] = field(default_factory=list)

    @property
    def words(self) -> str:
        """The faults as words of a command line."""
        return " ".join(f"--fault {shlex.quote(fault)}" for fault in self.faults)

    def as_json(self) -> dict[str, Any]:
        """All fields."""
        return asdict(self)


def sent_ports(trace: Trace, ports: Iterable[str]) -> dict[str, Sent]:
    """Times at which a run sent each of the ports; ports that it never sent are left out."""
    found = {}
    for port in ports:
        times_s = trace.times_s(port)
        if len(times_s):
            apart_s = max((float(after - before) for before, after in pairwise(times_s)), default=0.0)
            found[port] = Sent(float(times_s[0]), float(times_s[-1]), apart_s)
    return found


def judged_pair(number: int, faults: Sequence[str], result: Result) -> PairRun:
    """The rules of every run, checked on one run."""
    verdict = VERDICTS.get(result.exit_code, f"exit code {result.exit_code}")
    failures = [text for text in result.score.failures if text.startswith(RULE)]
    if verdict not in _ENDS:
        failures.append(f"the run ended with {verdict}")
    if verdict == "TOOL ERROR":
        failures.append(f"tool error: {result.line}")
    return PairRun(number, faults, verdict, failures)
