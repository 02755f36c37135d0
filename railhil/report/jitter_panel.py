"""The timing of runs in words and as table rows, from ``score.json`` alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from railhil.common.digits import count_of
from railhil.judge.jitter import LATE_MS, PLANT
from railhil.report.recorded import RecordedRun

HEADINGS = ("law", "cycles", "p50", "p99", "p99.9", "max", f"over {LATE_MS:g} ms", "polls", "missed")
_FIGURES = (("p50", "p50_ms"), ("p99", "p99_ms"), ("p99.9", "p999_ms"), ("max", "max_ms"))
_BY_PLANT = "the plant, at the beginning of each cycle and at each answer"
_BY_RECORDER = (
    "the supervisor, by the arrival of each tick (the plant has left no table here): the transport time counts too, "
    "and an answer that came too late for the plant counts as an answer"
)


def timing_of(run: RecordedRun) -> dict[str, Any]:
    """``run.timing`` of a run, empty if there is none."""
    found: dict[str, Any] = run.score_document.get("run", {}).get("timing") or {}
    return found


def jitter_sentence(jitter: Mapping[str, Any]) -> str:
    """Lateness of the cycles in one line."""
    text = ", ".join(f"{name} {jitter[key]:.3f} ms" for name, key in _FIGURES)
    return f"lateness of {count_of(jitter['cycles'], 'cycle')}: {text}"


def answers_sentence(timing: Mapping[str, Any]) -> str:
    """Missed polls, and the latency of the answers per port, in one line."""
    text = f"{timing['missed_polls']} of {count_of(timing['polls'], 'poll')} missed"
    for item in timing["answers"]:
        figures = (f"{name} {item[key]:.3f} ms" for name, key in _FIGURES if key in item)
        text += f"; {item['port']} {', '.join(figures)}"
    return text


def scheduling_sentence(timing: Mapping[str, Any]) -> str:
    """The scheduling granted to each process; processes with the same are named together."""
    roles: dict[str, list[str]] = {}
    for role, sentence in timing["scheduling"].items():
        roles.setdefault(sentence, []).append(role)
    text = "; ".join(f"{' and '.join(names)}: {sentence}" for sentence, names in roles.items())
    return text if "plant" in timing["scheduling"] else f"{text}; plant and controller were started elsewhere"


def timing_rows(document: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Facts on the timing of a run, from its ``score.json``."""
    rows: list[tuple[str, str]] = []
    run = document.get("run", {})
    timing = run.get("timing") or {}
    jitter = document.get("jitter")
    if jitter is None:
        missed = timing.get("missed_polls")
        return [] if missed is None else [("Timing", f"lockstep: no timing, missed polls {missed}")]
    rows.append(("Jitter", jitter_sentence(jitter)))
    if timing.get("lateness"):
        rows.append(("Measured by", _BY_PLANT if timing["source"] == PLANT else _BY_RECORDER))
        if timing.get("pace"):
            rows.append(("Pace", timing["pace"]))
        rows.append(("Answers", answers_sentence(timing)))
        rows.append(("Scheduling", scheduling_sentence(timing)))
    if run:
        rows.append(("Wall time", f"{run['sim_time_s']:.2f} s simulated in {run['wall_time_s']:.2f} s of wall time"))
    return rows


def timed(runs: Sequence[RecordedRun]) -> list[RecordedRun]:
    """The real-time runs, with their timing."""
    return [run for run in runs if timing_of(run).get("lateness")]


def table(runs: Sequence[RecordedRun]) -> list[tuple[str, ...]]:
    """A row per real-time run, cells under :data:`HEADINGS`; empty if all runs were in lockstep."""
    found = []
    for run in timed(runs):
        timing = timing_of(run)
        late = timing["lateness"]
        figures = (f"{late[key]:.3f}" for _, key in _FIGURES)
        counts = (str(timing["polls"]), str(timing["missed_polls"]))
        found.append((run.label, str(late["cycles"]), *figures, f"{late['late_share']:.3%}", *counts))
    return found
