"""``report.html`` of a campaign: distributions of the scores, and the worst runs; a function of results and folder."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

from railhil.campaign.distributions import distributions
from railhil.campaign.plan import Plan
from railhil.campaign.show import failure_sentences, headline, invalid_runs, noted_words, tables, texts_of
from railhil.common.digits import count_of, percent
from railhil.judge.judging import Judging
from railhil.record.hash_list import REPORT
from railhil.report.study_page import Part, Table, study_page
from railhil.report.templates import Link
from railhil.study.execute import Outcome

#: Folder inside the campaign's folder for runs that are made again.
_AGAIN = "worst"
_WORST_NOTE = (
    "The command makes a run again on the bench, with log and report. Given in the campaign's folder it puts the run "
    "where this page finds it: written again (railhil report FOLDER), the page links it."
)


def page(plan: Plan, made: Outcome, recorded: str) -> str:
    """The report as one HTML document. Runs that were made again in the folder of the campaign are linked.

    :param recorded: as in :func:`~railhil.report.study_page.study_page`.
    """
    summary, judging = made.summary, plan.judging
    lead = f"{headline(summary)}: {judging.asked(plan.scenario)}."
    worst = [_worst(label, run, made.folder, judging) for label, law in summary["laws"].items() for run in law["worst"]]
    parts: list[Part] = [
        *failure_sentences(summary),
        distributions(summary, plan.criteria, made.table),
        *(_table(place, one) for place, one in enumerate(tables(summary, judging), 1)),
        Table("worst", "Worst runs", ("law", "seed", "why", "command"), worst, "sources", _WORST_NOTE),
    ]
    title = f"Campaign on {plan.scenario.title}"
    warnings = [f"{text}." for text in summary["warnings"]]
    return study_page(title, lead, parts, [*_verdicts(summary)], warnings, recorded)


def _verdicts(summary: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """A badge for each law: PASS if each of its runs that says something has passed."""
    for label, law in summary["laws"].items():
        passed, said = law["inside"]["pass"], summary["runs"] - invalid_runs(law)
        low, high = passed["interval"]
        badge = "INVALID" if not said else "PASS" if passed["runs"] == said else "FAIL"
        of = f"of {count_of(summary['runs'], 'run', spec=',')}"
        interval = f"{summary['confidence']:.0%} interval {100 * low:.2f} to {100 * high:.2f}%"
        yield badge, f"{label}: {percent(passed['share'])} {of} pass, {interval}"


def _table(place: int, made: Any) -> Table:
    """A table of the terminal; each row names its law."""
    heads, rows = texts_of(made)
    for before, row in pairwise(rows):
        row[0] = row[0] or before[0]
    return Table(f"table-{place}", str(made.title), heads, rows)


def _worst(label: str, run: Mapping[str, Any], folder: Path, judging: Judging) -> list[str | Link]:
    place = f"{_AGAIN}/{label}-{run['seed']}"
    report, seed = f"{place}/{REPORT}", str(run["seed"])
    return [
        label,
        Link(seed, report) if (folder / report).is_file() else seed,
        "; ".join([", ".join(run["why"]), *noted_words(run, judging), *run["failures"]]),
        f"{run['command']} --out {shlex.quote(place)}",
    ]
