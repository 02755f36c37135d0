"""Prints the result of a run."""

from __future__ import annotations

import time
from collections.abc import Sequence

from railhil.cli.remarks import assumed, next_step
from railhil.cli.show import print_scores, print_verdict, print_watch
from railhil.common.digits import count_of
from railhil.common.output import Output
from railhil.judge.result import Result
from railhil.report.facts import parameters_sentence
from railhil.report.recorded import RecordedRun
from railhil.report.timing import answers_sentence, jitter_sentence, scheduling_sentence


def print_result(
    console: Output,
    run: RecordedRun,
    result: Result,
    notes: Sequence[str],
    report: str,
    verbose: bool,
) -> None:
    """Table, facts of the run, verdict and, after a FAIL, what to try.

    :param notes: lines on what else has come of the run.
    :param verbose: print all that the scenario assumes, and how long the command took after the last frame.
    :param report: the line about ``report.html``, empty if none was requested.
    """
    scenario, folder = run.scenario, result.place
    print_scores(console, scenario, [(f"{run.label} {run.certificate['arithmetic']} (measured)", result.score)])
    console.say(f"parameters: {parameters_sentence(run)}", style="dim")
    for line in assumed(scenario, folder, verbose):
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
    print_verdict(console, run.verdict, run.line)
    if advice := next_step(run, folder):
        console.say(advice)
