"""Prints results of runs: scores beside the published ones, assumptions of the scenario, the verdict, the next step."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from shlex import quote

from rich.measure import Measurement
from rich.table import Column, Table

from railhil.common.digits import count_of
from railhil.common.output import Output, number, table, whole
from railhil.judge.judging import judging_of
from railhil.judge.record import Record
from railhil.judge.result import Result
from railhil.judge.score import Score
from railhil.judge.stops import ScoredStop, worst_stop
from railhil.record.hash_list import REPORT
from railhil.report.facts import answers_sentence, jitter_sentence, parameters_sentence, scheduling_sentence
from railhil.report.tables import published_text
from railhil.scenarios.given import KEY as GIVEN_KEY
from railhil.scenarios.model import AnyScenario, watch_sentence

#: Below this width columns are separated by one space, so that no number is truncated.
_TIGHT_COLUMNS = 66
_COLOURS = {"PASS": "bold green", "FAIL": "bold red"}


def score_table(scenario: AnyScenario, found: Sequence[tuple[str, Score]], tight: bool = False) -> Table:
    """Measured scores by label, then the rows of the published table (time and stop error without sign, as
    published)."""
    criteria = [criterion for criterion in judging_of(scenario).criteria if criterion.on_terminal]
    rows = table("", *(number(criterion.heading) for criterion in criteria), tight=tight)
    for label, score in found:
        values = (criterion.shown(score.values[criterion.key]) for criterion in criteria)
        rows.add_row(label, *values, style="bold")
    for row in scenario.published:
        values = (published_text(row, criterion) for criterion in criteria)
        rows.add_row(f"{row.controller} (published)", *values)
    return rows


def stop_table(stops: Sequence[ScoredStop], tight: bool) -> Table:
    """One line for each stop: what a terminal has room for."""
    numbers = (Column(column.heading, justify="right") for column in stops[0].headed if column.brief)
    rows = table(whole("stop"), *numbers, whole(""), tight=tight)
    for stop in stops:
        cells = (column.text for column in stop.headed if column.brief)
        rows.add_row(stop.planned.name, *cells, stop.verdict, style="bold red" if stop.missed else None)
    return rows


def _fitting(console: Output, make: Callable[[bool], Table]) -> Table:
    """A table with less space between its columns where the console is too narrow."""
    made = make(console.width < _TIGHT_COLUMNS)
    return make(True) if Measurement.get(console, console.options, made).minimum > console.width else made


def print_scores(
    console: Output, scenario: AnyScenario, found: Sequence[tuple[str, Score]], *, every_stop: bool = True
) -> None:
    """Title and table of completed runs, nothing if there are none; then the stops of runs with several. Stops with
    more than place and time come first, in a table for each run.

    :param every_stop: False: of stops with more than place and time only the worst of each run, in a line.
    """
    if any(value is not None for _, score in found for value in score.values.values()):
        console.say(scenario.title, style="italic")
        for _, score in found:
            if every_stop and (stops := score.listed_stops) and stops[0].columns:
                console.print(_fitting(console, partial(stop_table, stops)))
        console.print(_fitting(console, lambda tight: score_table(scenario, found, tight)))
    for label, score in found:
        stops = score.listed_stops
        if not stops or not stops[0].columns:
            for stop in stops:
                _print_stop(console, f"{label}: stop", stop)
        elif not every_stop and (worst := worst_stop(stops)) is not None:
            _print_stop(console, f"{label}: worst stop", worst)


def _print_stop(console: Output, label: str, stop: ScoredStop) -> None:
    error = "" if stop.error_m is None else f" {stop.error_m:+.4f} m"
    console.say(f"{label} {stop.planned.name}{error} {stop.verdict}")


def print_watch(console: Output, scenario: AnyScenario) -> None:
    """One line if the scenario's watches are weaker than usual, which makes the verdict less meaningful."""
    if sentence := watch_sentence(scenario):
        console.say(sentence, style="bold yellow")


def print_requirements(console: Output, score: Score) -> None:
    """One line: what the run makes of its requirements; those that it violates are among the reasons of its verdict."""
    found = score.requirements
    if not found:
        return
    counts = Counter(one.verdict for one in found)
    said = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    console.say(f"{count_of(len(found), 'requirement')}: {said}")


def print_verdict(console: Output, verdict: str, line: str) -> None:
    """One line: the verdict and its reason."""
    console.say(f"{verdict}: {line}" if line else verdict, style=_COLOURS.get(verdict, "bold yellow"))


def assumption_lines(scenario: AnyScenario, name: str, folder: Path, verbose: bool) -> list[str]:
    """What the scenario says of its values that are chosen: one summary line, or all of them.

    :param name: with which the scenario is loaded again, its name or its file.
    :param folder: the run folder; its report lists them.
    """
    sentences = scenario.assumptions
    if verbose or not sentences:
        return [f"assumed: {sentence}" for sentence in sentences]
    where = f"listed in {folder / REPORT}" if (folder / REPORT).is_file() else f"railhil scenarios {quote(name)}"
    return [f"assumed: {count_of(len(sentences), 'choice')} that the scenario names ({where}, or --verbose)"]


def next_step(run: Record, folder: Path) -> str:
    """Advice after a FAIL, depending on the cause; empty for other verdicts and for a foreign controller."""
    certificate = run.certificate
    if run.verdict != "FAIL" or certificate.get("foreign") or certificate.get("attached"):
        return ""
    # A system's advice is about its laws.
    if not certificate.get(GIVEN_KEY) and (advice := run.judging.advice(run, folder)):
        return advice
    shown = folder / REPORT
    return f"next: {shown} shows where" if shown.is_file() else f"next: railhil report {folder} draws the run"


def print_result(
    console: Output,
    run: Record,
    result: Result,
    notes: Sequence[str],
    report: str,
    verbose: bool,
    lost: str = "",
) -> None:
    """Table, facts of the run, verdict and, after a FAIL, advice.

    :param notes: further lines on the results of the run.
    :param verbose: print all assumptions of the scenario, and the time of the command after the last frame.
    :param report: the line about ``report.html``, empty if none was requested.
    :param lost: the point of no return in words, at the end of the verdict's line; empty: none.
    """
    scenario, folder = run.scenario, result.place
    print_scores(console, scenario, [(f"{run.label} {run.certificate['arithmetic']} (measured)", result.score)])
    console.say(f"parameters: {parameters_sentence(run)}", style="dim")
    for line in assumption_lines(scenario, run.certificate.get("scenario") or scenario.name, folder, verbose):
        console.say(line, style="dim")
    print_watch(console, scenario)
    console.say(
        f"{result.sim_time_s:.2f} s simulated in {result.wall_time_s:.2f} s = {result.speed_factor:.0f} times "
        f"real time, {count_of(result.frames, 'frame')} on {result.transport}, "
        f"first frame after {result.first_frame_s:.2f} s"
    )
    if verbose:
        after_s = (time.monotonic_ns() - result.last_frame_ns) / 1e9
        console.say(f"all files written {after_s:.2f} s after the last frame")
    if result.timing is not None and result.timing.jitter is not None:
        timing = result.timing.as_json()
        if result.timing.pace:
            console.say(result.timing.pace, style="bold yellow")
        console.say(f"{jitter_sentence(timing['lateness'])} (measured by the {timing['source']})")
        console.say(f"answers: {answers_sentence(timing)}")
        console.say(f"scheduling: {scheduling_sentence(timing)}")
    if result.summary is not None:
        console.say(f"arithmetic: {result.summary.sentence()}")
    for heading, said in result.target.rows if result.target is not None else ():
        console.say(f"{heading.lower()}: {said}")
    console.say(f"frames.log sha256 {result.frames_sha256}")
    if result.other_frames:
        console.say(f"without {count_of(result.other_frames, 'frame')} of others: sha256 {result.telegrams_sha256}")
    console.say(f"run folder {folder}")
    for line in notes:
        console.say(line)
    if report:
        console.say(report)
    if run.caution:
        console.say(run.caution, style="bold yellow")
    print_requirements(console, result.score)
    print_verdict(console, run.verdict, "; ".join(filter(None, (run.line, lost))))
    if advice := next_step(run, folder):
        console.say(advice)
