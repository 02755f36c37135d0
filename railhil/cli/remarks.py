"""Lines beside the figures of a run: what its scenario assumes, and what to try after a FAIL."""

from __future__ import annotations

from pathlib import Path

from railhil.cli.bus_run import law_names
from railhil.common.law_order import LAW_ORDER
from railhil.scenarios.model import Scenario
from railhil.supervisor.report.recorded import REPORT, RecordedRun
from railhil.supervisor.score import WRAP_FAILURE

#: The shipped law that knows the train's position.
_WITH_POSITION = "ipfc_plus"


def assumed(scenario: Scenario, folder: Path, verbose: bool) -> list[str]:
    """What the scenario chooses where its sources say nothing: in one line, or all of it.

    :param folder: of the run; its report lists them.
    """
    sentences = scenario.assumptions
    if verbose or not sentences:
        return [f"assumed: {sentence}" for sentence in sentences]
    where = f"listed in {folder / REPORT}" if (folder / REPORT).is_file() else f"railhil scenarios {scenario.name}"
    return [f"assumed: {len(sentences)} choices of the scenario that its sources leave open ({where}, or --verbose)"]


def next_step(run: RecordedRun, folder: Path) -> str:
    """What to try after a FAIL, from what went wrong; empty for other verdicts and a controller that is not ours."""
    certificate, scenario, score = run.certificate, run.scenario, run.score
    if run.verdict != "FAIL" or certificate.get("foreign") or certificate.get("attached"):
        return ""
    name = certificate.get("scenario") or scenario.name
    if any(text.startswith(WRAP_FAILURE) for text in score.failures):
        return f"next: railhil audit {name} --controller {run.controller} says which quantity wraps"
    errors = ("stop error", "time error")
    only_errors = all(text.startswith(errors) for text in score.failures)
    if not only_errors or run.controller == _WITH_POSITION or certificate.get("indexing") != "time":
        shown = folder / REPORT
        return f"next: {shown} shows where" if shown.is_file() else f"next: railhil report {folder} draws the run"
    steps = []
    if _WITH_POSITION in law_names():
        steps.append(f"the same with --controller {_WITH_POSITION}, which knows its position")
    if run.controller in LAW_ORDER and not certificate.get("parameters"):
        steps.append(f"railhil tune {run.controller} {name}, which searches its parameters")
    return f"next: {'; or '.join(steps)}" if steps else ""
