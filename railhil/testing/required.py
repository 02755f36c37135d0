"""The sentences that markers of a test require (``requires=``), and what its runs have shown of them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from railhil.common.digits import count_of
from railhil.common.errors import InputError
from railhil.judge.requirements.outcome import Outcome
from railhil.judge.requirements.requirement import Requirement, requirements_in
from railhil.judge.requirements.sentence import KEPT, OPEN, VIOLATED
from railhil.testing.requirements import NOT_SHOWN, PROPERTY
from railhil.testing.result import Run


def problem_of(name: str, says: str) -> str:
    """What is wrong with the name or the sentence of a marker; empty: nothing."""
    try:
        _requirement(name, says)
    except InputError as error:
        return str(error)
    return ""


def _requirement(name: str, says: str) -> Requirement:
    (found,) = requirements_in({"requirement": [{"id": name, "says": says}]}, "")
    return found


def required_tables(required: Iterable[tuple[str, str]]) -> list[dict[str, Any]]:
    """Names and sentences of markers as a run takes requirements; the same one of two markers counts once."""
    return [_requirement(name, says).as_json() for name, says in dict.fromkeys(required)]


@dataclass(frozen=True, slots=True)
class Shown:
    """What the runs of a test have shown of a requirement.

    ``verdict``: kept, violated or NOT SHOWN: no run has kept it, since its antecedent was never met, the end of the
    record came first, or no run was judged. ``worst``: the outcome with the smallest margin, a violated one first.
    ``met``: number of times that its antecedent was met, over all runs. ``line``: reason against the test; empty: none.
    """

    name: str
    verdict: str
    worst: Outcome | None
    met: int
    line: str

    def fact(self, has_failed: bool) -> tuple[str, str]:
        """As a property of the test.

        :param has_failed: by itself: then nothing that was not shown is the reason.
        """
        worst = self.worst
        verdict = "" if has_failed and self.verdict == NOT_SHOWN else self.verdict
        values = {
            "verdict": verdict, "margin": worst and worst.margin, "unit": worst.unit if worst else "",
            "instant_s": worst and worst.instant_s, "antecedent_met": self.met,
        }  # fmt: skip
        return f"{PROPERTY}.{self.name}", json.dumps(values)


def shown(name: str, says: str, runs: Sequence[Run]) -> Shown:
    """What the finished runs of a test have shown of a requirement."""
    found = [(run, run.outcome.requirements[name]) for run in runs if name in run.outcome.requirements]
    outcomes = [outcome for _, outcome in found]
    sized = [one for one in outcomes if one.margin is not None]
    worst = min(sized, key=lambda one: one.margin or 0.0, default=None)
    met = sum(one.antecedent_met for one in outcomes)
    for run, outcome in found:
        if outcome.violated:
            return Shown(name, VIOLATED, worst or outcome, met, f"{outcome.line} (run folder {run.folder})")
    if any(one.kept for one in outcomes):
        return Shown(name, KEPT, worst, met, "")
    count = count_of(len(outcomes), "run")
    if not outcomes or all(run.verdict == "INVALID" for run, _ in found):
        why = f"none of {count} could be judged" if outcomes else "the test has finished no run"
    elif any(one.verdict == OPEN for one in outcomes):
        why = f"the end of the record comes before the decision in {count}"
    else:
        why = f"its antecedent was never met in {count}"
    return Shown(name, NOT_SHOWN, worst, met, f"{NOT_SHOWN}: requirement {name}: {says}: {why}")
