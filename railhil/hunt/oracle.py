"""One case as a run through the nodes in this process, and what it violates.

What is judged: the requirements of the hunt; the rules that hold in every run (failures of the score that begin with
``invariant``), each as the requirement ``INV-n``; a defect of the bench itself (a run that ends with an error), as
``BENCH``; and a controller of the user that fails, as ``CONTROLLER``. A run that is INVALID is
not judged, except for one reason: some of its faults changed nothing, and others acted. Such a run says what the others
do.
"""

from __future__ import annotations

import re
import traceback
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from railhil.common.errors import InputError
from railhil.common.exit_codes import FAIL, INVALID, PASS, TOOL_ERROR, USAGE
from railhil.judge.events.event import LEVEL, REFUSED, RecordedEvent
from railhil.judge.reactions.evaluate import RULE, VERDICTS
from railhil.judge.requirements.outcome import Outcome, judge_requirements
from railhil.judge.requirements.requirement import Requirement
from railhil.judge.result import Result
from railhil.run.make import NeverBegan, run_into
from railhil.scenarios.run_spec import RunSpec

#: Ids of a defect of the bench, and of a controller of the user that fails: it raises, or gives no answer.
BENCH, CONTROLLER = "BENCH", "CONTROLLER"
#: Beginning of the ids of the rules of every run.
RULE_ID = "INV"
_RULE = re.compile(rf"{RULE} (\w+): (.*)", re.DOTALL)
#: Parts of a journey that cells tell apart.
_PHASES = 4
#: Verdicts of a case that are not those of a run: a fault cannot be injected, no frame came.
REFUSED_CASE, NONE = "refused", "none"


@dataclass(frozen=True, slots=True)
class Judged:
    """What came of a case. ``violated``: id of a requirement -> sentence; ``outcomes``: of the requirements, in their
    order; ``cells``: combinations of watch, level, cause and phase of the journey that the run reached; ``detail``: why
    there is no verdict; ``idle``: places in the case of the faults that changed nothing, while others acted."""

    verdict: str
    violated: Mapping[str, str] = field(default_factory=dict)
    outcomes: tuple[Outcome, ...] = ()
    cells: tuple[str, ...] = ()
    frames_sha256: str = ""
    detail: str = ""
    idle: tuple[int, ...] = ()

    @property
    def is_valid(self) -> bool:
        """Whether the run could be judged."""
        return self.verdict in ("PASS", "FAIL")


def broken_rules(failures: Iterable[str]) -> dict[str, str]:
    """The rules of every run that a run breaks, by id; of each the first sentence."""
    found: dict[str, str] = {}
    for failure in failures:
        if match := _RULE.fullmatch(failure):
            found.setdefault(f"{RULE_ID}-{match[1]}", match[2])
    return found


def _cells(events: Sequence[RecordedEvent], planned_s: float) -> tuple[str, ...]:
    """The cells of a run, in order."""
    found = set()
    for event in events:
        if event.kind in (LEVEL, REFUSED):
            phase = min(int(_PHASES * event.time_s / planned_s), _PHASES) if planned_s > 0 else 0
            found.add(f"{event.source} {event.level or event.kind} {event.cause} {phase}")
    return tuple(sorted(found))


def _where(error: BaseException) -> str:
    """The error and the line of code that has raised it."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text} (in {last.name} of {Path(last.filename).name})"


def _said(outcome: Outcome) -> str:
    """How a requirement is violated."""
    margin = "" if outcome.margin is None else f", margin {outcome.margin:.4g} {outcome.unit}".rstrip()
    instant = "" if outcome.instant_s is None else f" at {outcome.instant_s:.2f} s"
    return f"{outcome.says}{margin}{instant}"


def _idle(result: Result) -> tuple[int, ...]:
    """Places of the faults that changed nothing, if that is the only reason against the run and others acted."""
    if result.exit_code != INVALID or result.line != result.missed or not any(one.hits for one in result.faults):
        return ()
    own = len(result.scenario.faults) - len(result.spec.faults)
    places = tuple(one.number - 1 - own for one in result.faults if one.missed)
    # The scenario's own faults stay: without them it is another scenario.
    return places if all(place >= 0 for place in places) else ()


def judge_result(result: Result, requirements: Sequence[Requirement] = ()) -> Judged:
    """What a run violates."""
    if idle := _idle(result):
        code = {"PASS": PASS, "FAIL": FAIL}[result.score.verdict]
        acted = replace(result, exit_code=code, line="; ".join(result.score.failures))
        return replace(judge_result(acted, requirements), idle=idle)
    verdict = VERDICTS.get(result.exit_code, f"exit code {result.exit_code}")
    cells = _cells(result.events, result.scenario.planned_s)
    found = Judged(verdict, cells=cells, frames_sha256=result.frames_sha256)
    if result.exit_code == TOOL_ERROR:
        return replace(found, violated={BENCH: result.line})
    if result.exit_code == USAGE and result.spec.law.given is not None:
        return replace(found, violated={CONTROLLER: result.line})
    if not found.is_valid:
        return replace(found, detail=result.line)
    outcomes = judge_requirements(result.as_record(), requirements)
    violated = {outcome.id: _said(outcome) for outcome in outcomes if outcome.violated}
    return replace(found, violated=violated | broken_rules(result.score.failures), outcomes=outcomes)


def run_case(
    base: RunSpec,
    requirements: Sequence[Requirement],
    faults: Sequence[str],
    seed: int,
    folder: Path | None = None,
) -> Judged:
    """Make the run of a case and judge it.

    :param base: the run without the faults of the case; the scenario's own faults are kept.
    :param folder: the run folder, which is kept; None: a private one, which is not.
    """
    spec = replace(base, faults=tuple(faults), seed=seed)
    try:
        if folder is not None:
            return judge_result(run_into(folder, spec), requirements)
        with TemporaryDirectory(prefix="railhil-hunt-") as private:
            return judge_result(run_into(Path(private) / "run", spec, keep=False), requirements)
    except InputError as error:
        return Judged(REFUSED_CASE, detail=str(error))
    except NeverBegan as error:
        return Judged(NONE, detail=str(error))
    except Exception as error:
        # Any exception is a finding: the hunt looks for defects of the bench, too.
        return Judged(VERDICTS[TOOL_ERROR], {BENCH: _where(error)}, detail=_where(error))
