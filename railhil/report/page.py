"""The HTML page, a pure function of the recorded runs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from railhil.charts.figure import Figure
from railhil.judge.judging import system_pictures
from railhil.judge.record import Record
from railhil.judge.stops import worst_stop
from railhil.report.display_columns import ShownColumn
from railhil.report.distribution import picture, spreads_of, worst_first
from railhil.report.facts import TIMING_HEADINGS, facts, lateness_figures, timing_table, without_paths
from railhil.report.noise import Noise, noise_figures
from railhil.report.origin import folder_files, recorded_sentence
from railhil.report.over_time import RunColumns, columns_of, reactions, signals
from railhil.report.recorded import distinct_labels
from railhil.report.styles import styles
from railhil.report.tables import better_sentence, event_rows, has_unusual, rows
from railhil.report.templates import Link, address_of, render_page, write_html
from railhil.scenarios.model import watch_sentence

#: Number of runs above which the page shows distributions, and figures and charts of the worst runs only.
RUNS_MAX, _WORST = 20, 6
#: The page's template.
TEMPLATE: Final = "report.html.j2"


def page(
    runs: Sequence[Record],
    notes: Sequence[str] = (),
    links: Sequence[str] = (),
    files: Sequence[tuple[str, Sequence[Link]]] = (),
    noise: Sequence[Noise] = (),
) -> str:
    """The report of one run or of several of one scenario, as one HTML document without external references.

    The same records give the same bytes: no absolute path, and no wall-clock figure of a lockstep run.

    :param notes: sentences on the comparison as a whole.
    :param links: of the runs, shown for the worst ones of more than :data:`RUNS_MAX`.
    :param files: of the runs that are drawn, by label.
    :param noise: other runs of the laws, which a campaign has.
    """
    runs = [run.copy_with(label=label) for run, label in zip(runs, distinct_labels(runs), strict=True)]
    scenario, judging = runs[0].scenario, runs[0].judging
    criteria = judging.criteria
    many = len(runs) > RUNS_MAX
    worst = worst_first(scenario, criteria, runs)[:_WORST] if many else []
    shown = [runs[place] for place in worst] if many else runs
    spreads, looks = spreads_of(scenario, criteria, runs) if many else ([], {})
    columns = [
        columns_of(run, number, style)
        for number, (run, style) in enumerate(zip(shown, styles([run.controller for run in shown]), strict=True))
        if run.can_be_drawn
    ]
    own = [*system_pictures(scenario, shown), *lateness_figures(shown)]
    among = [] if many or not noise else noise_figures(runs, noise)
    pictures = [*own[:1], *reactions(columns), *own[1:], *among]
    opened, further = signals(columns, [one for one in pictures if isinstance(one, Figure)])
    known = judging.deviations if scenario.published else None
    source, deviating = known() if known else ("", ())
    return render_page(
        TEMPLATE,
        title=scenario.title,
        scenario=scenario,
        runs=runs,
        without_paths=without_paths,
        watch=watch_sentence(scenario),
        recorded=recorded_sentence([run.certificate for run in runs]),
        noise=noise if among else (),
        files=files,
        notes=notes,
        columns=criteria,
        better=better_sentence(criteria),
        best="least" if all(criterion.better == "low" for criterion in criteria) else "best",
        rows=rows(scenario, criteria, runs),
        remark=judging.remark([run.score for run in runs]),
        worst_stops=[worst_stop(run.score.listed_stops) for run in runs if run.score.listed_stops],
        stops=[(run.label, stop) for run in runs for stop in run.score.listed_stops],
        requirements=[(run.label, one) for run in runs for one in run.score.requirements],
        asked=judging.asked(scenario),
        published=judging.published if scenario.published else "",
        shown=shown,
        worst=[(runs[place], links[place] if links else "") for place in worst],
        events=[row for run in shown for row in event_rows(run.label, run.events)],
        quiet=[run.label for run in shown if not has_unusual(run.events)],
        facts=facts(runs),
        timing=timing_table(runs),
        timing_headings=TIMING_HEADINGS,
        pictures=pictures,
        opened=opened,
        further=further,
        run_names=json.dumps([run.label for run in shown]),
        over=_over(columns),
        spread_picture=picture(spreads, looks) if many else None,
        source=source,
        deviations=deviating,
    )


def _over(runs: Sequence[RunColumns]) -> ShownColumn | None:
    """The position, if it never decreases in any run: then all charts over time can also be drawn over it."""
    if not runs:
        return None
    name = runs[0].shown.position
    places = [run.values.get(name) for run in runs]
    steady = all(
        one is not None and np.isfinite(one).all() and np.all(np.diff(one) >= 0) and np.ptp(one) > 0 for one in places
    )
    return runs[0].shown.named(name) if steady else None


def write_report(runs: Sequence[Record], out: Path, notes: Sequence[str] = (), noise: Sequence[Noise] = ()) -> None:
    """Write the report with links to the folders of the runs completely or not at all.

    :raises InputError: it is a file of a signed folder.
    :raises OSError: it cannot be written.
    """
    links = [address_of(run.folder, out) for run in runs]
    labels = distinct_labels(runs)
    files = [(label, folder_files(run, out)) for label, run in zip(labels, runs, strict=True)]
    write_html(page(runs, notes, links, files if len(runs) <= RUNS_MAX else (), noise), out)
