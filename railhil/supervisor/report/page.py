"""The HTML page, a pure function of the recorded runs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final
from urllib.parse import quote

from railhil.scenarios.model import watch_sentence
from railhil.supervisor.hash_list import REPORT, listed_file
from railhil.supervisor.judging import judging_of
from railhil.supervisor.report import jitter_panel as timing
from railhil.supervisor.report.assets import as_json, scripts, styles_text
from railhil.supervisor.report.distribution import charted, picture, spreads_of, worst_first
from railhil.supervisor.report.events_panel import event_rows, has_unusual
from railhil.supervisor.report.explore import explored
from railhil.supervisor.report.facts import facts, without_paths
from railhil.supervisor.report.figures import Panel, pictures, system_pictures
from railhil.supervisor.report.recorded import RecordedRun, told_apart
from railhil.supervisor.report.score_table import better_sentence, rows
from railhil.supervisor.report.templates import template

#: Above so many runs the page shows distributions, and figures and charts of the worst runs only.
RUNS_MAX, _WORST = 20, 6
#: The page's template.
TEMPLATE: Final = "report.html.j2"


def page(
    runs: Sequence[RecordedRun],
    notes: Sequence[str] = (),
    panels: Sequence[Panel] | None = None,
    links: Sequence[str] = (),
) -> str:
    """The report of one run or of several of one scenario, as one HTML document without external references.

    The same records give the same bytes: no date, no path, and no wall-clock figure of a lockstep run.

    :param notes: sentences on the comparison as a whole.
    :param panels: figures in reading order; None: those of a train that drives automatically to a stop.
    :param links: of the runs, shown for the worst ones of more than :data:`RUNS_MAX`.
    """
    runs = [replace(run, line=without_paths(run.line)) for run in told_apart(runs)]
    scenario = runs[0].scenario
    judging = judging_of(scenario)
    criteria = judging.criteria
    many = len(runs) > RUNS_MAX
    worst = worst_first(scenario, criteria, runs)[:_WORST] if many else []
    shown = [runs[place] for place in worst] if many else runs
    spreads, looks = spreads_of(scenario, criteria, runs) if many else ([], {})
    known = judging.deviations if scenario.published else None
    source, deviating = known() if known else ("", ())
    return template(TEMPLATE).render(
        scenario=scenario,
        runs=runs,
        watch=watch_sentence(scenario),
        notes=notes,
        columns=criteria,
        better=better_sentence(criteria),
        best="least" if all(criterion.better == "low" for criterion in criteria) else "best",
        rows=rows(scenario, criteria, runs),
        remark=judging.remark([run.score for run in runs]),
        stops=[(run.label, stop) for run in runs for stop in run.score.listed_stops],
        asked=judging.asked(scenario),
        published=judging.published if scenario.published else "",
        shown=shown,
        worst=[(runs[place], links[place] if links else "") for place in worst],
        events=[row for run in shown for row in event_rows(run.label, run.events)],
        quiet=[run.label for run in shown if not has_unusual(run.events)],
        facts=facts(runs),
        timing=timing.table(runs),
        timing_headings=timing.HEADINGS,
        pictures=system_pictures(scenario, shown) if panels is None else pictures(scenario, shown, panels),
        explored=explored(shown),
        spread_picture=picture(spreads, looks) if many else None,
        spread_data=as_json(charted(spreads, looks)),
        chart_scripts=scripts("explore.js", *(["distribution.js"] if many else [])),
        chart_styles=styles_text(),
        source=source,
        deviations=deviating,
    )


def write_report(
    runs: Sequence[RecordedRun], out: Path, notes: Sequence[str] = (), folders: Sequence[Path] = ()
) -> None:
    """Write the report completely or not at all.

    :param folders: of the runs, to link the worst ones of many.
    :raises InputError: it is a file of a signed folder.
    :raises OSError: it cannot be written.
    """
    text = page(runs, notes, links=[_link(folder, out) for folder in folders])
    with listed_file(out) as draft:
        draft.write_text(text, encoding="utf-8")


def _link(folder: Path, out: Path) -> str:
    """Address of a run relative to the report: its own report, else its folder."""
    target = folder / REPORT
    found = os.path.relpath(target if target.is_file() else folder, out.parent)
    return quote(Path(found).as_posix())
