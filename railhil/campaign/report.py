"""``report.html`` of a campaign: distributions of the scores, and the worst runs; a function of results and folder."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from typing import Any

import pyarrow as pa

from railhil.campaign.distributions import distributions
from railhil.campaign.plan import Plan, make_plan
from railhil.campaign.show import failure_sentences, headline, invalid_runs, noted_words, tables, texts_of
from railhil.campaign.study import CAMPAIGN
from railhil.common.digits import count_of, percent
from railhil.common.errors import InputError
from railhil.judge.judging import Judging
from railhil.record.hash_list import REPORT, check_hash_list
from railhil.report.origin import recorded_sentence
from railhil.report.study_page import Part, Table, study_page
from railhil.report.templates import Link, write_html
from railhil.scenarios.given import RecordedController, is_law_name
from railhil.scenarios.scenario_documents import any_judged_sha256
from railhil.study.finished import finished_rows, finished_summary
from railhil.study.manifest import Manifest, read_manifest

#: Folder inside the campaign's folder for runs that are made again.
_AGAIN = "worst"
_WORST_NOTE = (
    "The command makes a run again on the bench, with log and report. Given in the campaign's folder it puts the run "
    "where this page finds it: written again (railhil report FOLDER), the page links it."
)


def page(plan: Plan, summary: Mapping[str, Any], table: pa.Table, folder: Path, recorded: str) -> str:
    """The report as one HTML document.

    :param recorded: when, where, by whom and with which version it was begun, in a sentence.
    :param table: rows of ``results.parquet``.
    :param folder: of the campaign; runs that were made again in it are linked.
    """
    judging = plan.judging
    lead = f"{headline(summary)}: {judging.asked(plan.scenario)}. {recorded}"
    worst = [_worst(label, run, folder, judging) for label, law in summary["laws"].items() for run in law["worst"]]
    parts: list[Part] = [
        *failure_sentences(summary),
        distributions(summary, plan.criteria, table),
        *(_table(place, made) for place, made in enumerate(tables(summary, judging), 1)),
        Table("worst", "Worst runs", ("law", "seed", "why", "command"), worst, "sources", _WORST_NOTE),
    ]
    title = f"Campaign on {plan.scenario.title}"
    return study_page(title, lead, parts, [*_verdicts(summary)], [f"{text}." for text in summary["warnings"]])


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


def _recorded(begun: Manifest, file: Path) -> dict[str, RecordedController]:
    """The controllers of users: named as in the campaign, and not loaded."""
    texts = [text for text in begun.request.laws if not is_law_name(text)]
    given = (law for law in begun.identity["laws"] if "form" in law)
    return {
        text: RecordedController.of_identity(text, law, begun.identity["arithmetic"], file)
        for text, law in zip(texts, given, strict=True)
    }


def report_of(folder: Path, out: Path) -> None:
    """Write the report of a finished campaign from its folder.

    :raises InputError: the campaign is not finished, damaged, changed, or of a scenario that has changed since.
    :raises OSError: it cannot be written.
    """
    begun = read_manifest(folder, CAMPAIGN)
    plan = make_plan(begun.request, _recorded(begun, folder / CAMPAIGN.manifest))
    check_hash_list(folder, CAMPAIGN.manifest, None)
    summary, table = finished_summary(CAMPAIGN, folder), finished_rows(CAMPAIGN, plan, folder)
    told, sha256 = summary.get("scenario_sha256"), any_judged_sha256(plan.scenario)
    if told != sha256:
        raise InputError(folder, "scenario", str(told), f"{sha256}, as it is now")
    write_html(page(plan, summary, table, folder, recorded_sentence([asdict(begun)])), out)
