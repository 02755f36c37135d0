"""The page of a study, written when it ends and again from its folder."""

from __future__ import annotations

from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from pkgutil import resolve_name

from railhil.run.report import say_report
from railhil.scenarios.given import RecordedController
from railhil.study.execute import Outcome
from railhil.study.finished import finished_rows, finished_summary, repeated_plan
from railhil.study.manifest import read_manifest
from railhil.study.plan import C, P, Study


def write_page(study: Study[P, C], plan: P, made: Outcome, out: Path) -> None:
    """Write the page of a finished study. It says when, where, by whom and with which version the study was begun.

    :raises InputError: the manifest is damaged.
    :raises OSError: it cannot be written.
    """
    # Without the extra ``report`` a study has no page.
    from railhil.report.origin import recorded_sentence
    from railhil.report.templates import write_html

    recorded = recorded_sentence([asdict(read_manifest(made.folder, study))])
    write_html(resolve_name(study.page)(plan, made, recorded), out)


def page_line(study: Study[P, C], plan: P, made: Outcome) -> str:
    """Write the page at the end of a study; returns the line of :func:`~railhil.run.report.say_report`, empty if it
    does not end with a page."""
    ends_so = bool(study.page) and study.ends_with_page
    return say_report(made.folder, partial(write_page, study, plan, made)) if ends_so else ""


def report_of(study: Study[P, C], folder: Path, out: Path) -> None:
    """Write the page of a finished study from its folder.

    :raises InputError: the study is not finished, damaged, changed, or of a scenario that has changed since.
    :raises OSError: it cannot be written.
    """
    begun, file = read_manifest(folder, study), folder / study.manifest
    # Controllers of the user are named as in the study, and not loaded.
    code = {
        text: RecordedController.of_identity(text, entry, begun.identity["arithmetic"], file)
        for text, entry in study.controllers(begun.request, begun.identity).items()
    }
    named = replace(study, make_plan=partial(study.make_plan, code=code)) if code else study
    plan, _ = repeated_plan(named, folder)
    made = Outcome(folder, finished_rows(study, plan, folder), finished_summary(study, folder))
    write_page(study, plan, study.completed(made), out)
