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


#: Figures of a measure over the sequences, with their headings.
_FIGURES = {"mean": "mean", "mean_error": "mean error", "rms": "rms", "median_error": "median error", "p95": "95 %"}


def run_rows(measure: Mapping[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Headings and rows of a measure by the number of the run; the last row is of the last runs together."""
    inside = [f"within {limit} {measure['unit']}" for limit in measure["last"]["within"]]
    rows = [
        [
            str(row.get("run", f"last {row.get('of')}")),
            *("-" if row[key] is None else f"{row[key]:.3f}" for key in _FIGURES),
            *(percent(share, 1) for share in row["within"].values()),
            f"{row['with_a_value']} of {row['runs']}",
        ]
        for row in (*measure["by_run"], measure["last"])
    ]
    return ["run", *_FIGURES.values(), *inside, "with a value"], rows


def _table(measure: Mapping[str, Any]) -> Table:
    (heads, rows), title = run_rows(measure), f"{measure['title']}, {measure['unit']}, by the number of the run"
    first = rows[:_FIRST_RUNS] + rows[max(_FIRST_RUNS, len(rows) - 2) :]
    return titled_table(title, heads[:1], heads[1:], first)


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
        yield _table(measure)
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
