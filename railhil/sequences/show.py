"""The result of ``railhil learn`` on the terminal, all from ``summary.json``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from rich.table import Table
from rich.text import Text

from railhil.common.digits import count_of, percent
from railhil.common.output import styled, titled_table
from railhil.sequences.plan import Plan

#: Runs that get a row of their own, besides the last.
_FIRST_RUNS = 5


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _rows(measure: Mapping[str, Any]) -> Table:
    inside = [f"within {limit}" for limit in measure["last"]["within"]]
    title = f"{measure['title']}, {measure['unit']}, by the number of the run"
    made = titled_table(title, ("run",), ("mean", "mean error", "rms", "95 %", *inside))
    last = measure["last"]
    by_run = measure["by_run"]
    shown = [*by_run[:_FIRST_RUNS], *(by_run[-1:] if len(by_run) > _FIRST_RUNS else [])]
    for name, one in [(str(one["run"]), one) for one in shown] + [(f"last {last['of']}", last)]:
        shares = [percent(share, 1) for share in one["within"].values()]
        figures = [_number(one[key]) for key in ("mean", "mean_error", "rms", "p95")]
        made.add_row(name, *figures, *shares)
    return made


def converged(measure: Mapping[str, Any], sequences: int) -> str:
    """Number of runs that the sequences need, in words."""
    found = measure["converged"]
    inside = f"{count_of(found['in_a_row'], 'run')} in a row within {found['limit']:g} {measure['unit']}"
    if not found["sequences"]:
        return f"no sequence had {inside}"
    most = "more than there were" if found["p90"] is None else f"at most {found['p90']:.0f}"
    median = "more than there were" if found["median"] is None else f"{found['median']:.0f}"
    return (
        f"runs until the first of {inside}: median {median}, in 90 % of the sequences {most} "
        f"({found['sequences']} of {sequences} came to it)"
    )


def lines(plan: Plan, summary: Mapping[str, Any], folder: Path) -> Iterator[str | Text | Table]:
    """The tables of a study, each with its sentences."""
    kind = "perturbed" if summary["perturbed"] else "nominal"
    sequences, runs = count_of(summary["sequences"], "sequence", spec=","), count_of(summary["runs"], f"{kind} run")
    yield (
        f"{sequences} of {runs} of {summary['scenario']}, "
        f"{summary['law']}, {summary['arithmetic']}, seeds {summary['seed']} to {summary['last_seed']}"
    )
    for measure in summary["measures"].values():
        yield _rows(measure)
        yield converged(measure, summary["sequences"])
        if missing := sum(one["runs"] - one["with_a_value"] for one in measure["by_run"]):
            without = count_of(missing, "run has", "runs have")
            yield f"{without} no {measure['title']}; they count as outside every limit"
    yield f"verdicts: {', '.join(f'{count:,} {name}' for name, count in summary['verdicts'].items())}"
    if summary["not_learned"]:
        yield f"{count_of(summary['not_learned'], 'run', spec=',')} left no record"
    for fault, count in summary["memory_refused"].items():
        yield styled(f"memory: slot {fault} in {count_of(count, 'run', spec=',')}", "bold yellow")
    if summary["runs_with_wraps"]:
        runs = count_of(summary["runs_with_wraps"], "run", spec=",")
        yield styled(f"the arithmetic wrapped in {runs}", "bold red")
