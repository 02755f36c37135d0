"""``report.html`` of a recorded sequence (``railhil sequence run``): its runs one after another; a function of the
folder."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from railhil.charts.figure import Area, Chart, Curve, Figure
from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.judge.criteria import Criterion
from railhil.judge.judging import system_pictures
from railhil.judge.record import Record, checked_record
from railhil.record.hash_list import check_hash_list
from railhil.report.distribution import limits_of
from railhil.report.origin import recorded_sentence
from railhil.report.study_page import Table, study_page
from railhil.report.templates import Link, address_of, write_html
from railhil.scenarios.parameters import DIGEST_DIGITS
from railhil.sequences.evidence import SEQUENCE, Made, differences, read_evidence, run_name


def report_of(folder: Path, out: Path) -> None:
    """Write the report of a sequence, whole or not.

    :raises InputError: it has no finished run, or a run is not as recorded.
    :raises OSError: it cannot be written.
    """
    evidence = read_evidence(folder)
    check_hash_list(folder, SEQUENCE, None)
    if not evidence.made:
        raise InputError(folder / SEQUENCE, "made", Words("no run"), "a finished run")
    for problem in differences(folder, evidence):
        raise InputError(folder / SEQUENCE, "", Words(problem), "a sequence as it was recorded")
    runs = [
        checked_record(str(folder / run_name(one.run)), None).copy_with(label=f"run {one.run}") for one in evidence.made
    ]
    first, law, judging = evidence.first, evidence.first.law, runs[0].judging
    verdicts = [one.verdict for one in evidence.made]
    counts = [(verdict, count_of(verdicts.count(verdict), "run")) for verdict in dict.fromkeys(verdicts)]
    finished = f"{len(runs)} of {count_of(evidence.runs, 'run')}"
    facts = [
        ("Scenario", f"{runs[0].scenario.name}, sha256 {runs[0].scenario.sha256}"),
        ("Seed", str(first.seed)),
        ("Began with", f"memory sha256 {evidence.began.sha256}"),
        ("SHA-256 of the sequence", evidence.sha256 or "not complete"),
    ]
    parts = [
        _table(judging.criteria, evidence.made, runs, out),
        _scores(judging.criteria, runs),
        *system_pictures(runs[0].scenario, list(dict.fromkeys((runs[0], runs[-1])))),
        Table("facts", "Facts", (), facts, "facts"),
    ]
    title = f"Sequence on {runs[0].scenario.title}"
    lead = f"{finished} of {law.label} in {law.arithmetic}, each with the memory that the one before has left."
    recorded = recorded_sentence([run.certificate for run in runs])
    write_html(study_page(title, lead, parts, counts, recorded=recorded), out)


def _table(criteria: Sequence[Criterion], made: Sequence[Made], runs: Sequence[Record], out: Path) -> Table:
    heads = [
        "run",
        "verdict",
        *(f"{one.title} ({one.unit_typeset})" for one in criteria),
        "began with",
        "left",
        "frames",
    ]
    rows: list[list[str | Link]] = [
        [
            Link(str(one.run), address_of(run.folder, out)),
            one.verdict,
            *(criterion.shown(run.score.values[criterion.key]) for criterion in criteria),
            *(
                "-" if sha256 is None else sha256[:DIGEST_DIGITS]
                for sha256 in (one.memory_before_sha256, one.memory_after_sha256, one.frames_sha256)
            ),
        ]
        for one, run in zip(made, runs, strict=True)
    ]
    return Table("runs", "Runs", heads, rows, note="The last three columns begin hashes (SHA-256) of sequence.json.")


def _scores(criteria: Sequence[Criterion], runs: Sequence[Record]) -> Figure:
    numbers = np.arange(1.0, len(runs) + 1.0)
    charts = []
    for criterion in criteria:
        found = [run.score.with_sign(criterion) for run in runs]
        values = np.array([np.nan if value is None else value for value in found], dtype=np.float64)
        limits = [Area(None, (limit, limit), "line", "limit") for limit in limits_of(runs[0].scenario, criterion)]
        label = f"{criterion.title} ({criterion.unit_typeset})"
        charts.append(
            Chart([Curve(criterion.title, numbers, values)], "number of the run", label, areas=limits, share=0.5)
        )
    return Figure("scores", "Scores by the number of the run", "Lines across a chart: limits of the scenario.", charts)
