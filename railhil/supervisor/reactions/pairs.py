"""Runs with two random faults: the rules of every run hold in each of them."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from railhil.supervisor.reactions.evaluate import Seen
from railhil.supervisor.result import RunResult

#: Verdicts with which a run may end.
_ENDS = ("PASS", "FAIL", "INVALID", "TOOL ERROR")
#: Beginning of the sentence for a broken rule (:mod:`railhil.supervisor.invariants`).
_RULE = "invariant"


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


def judged_pair(number: int, faults: Sequence[str], seen: Seen, result: RunResult) -> PairRun:
    """The rules of every run, as far as one run shows them."""
    failures = [text for text in result.score.failures if text.startswith(_RULE)]
    if seen.verdict not in _ENDS:
        failures.append(f"the run ended with {seen.verdict}")
    if seen.verdict == "TOOL ERROR":
        failures.append(f"tool error: {seen.line}")
    return PairRun(number, faults, seen.verdict, failures)
