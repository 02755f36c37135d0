"""A campaign on the terminal and in a notebook: tables up to 100 columns wide, all from ``summary.json``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.table import Table
from rich.text import Text

from railhil.campaign.plan import Plan
from railhil.campaign.summary import QUANTILES, all_limits, key_of
from railhil.charts.figure import Figure
from railhil.charts.notebook import html_cell, html_figure, html_paragraph, html_table
from railhil.common.digits import count_of, percent, text_beside_limit
from railhil.common.output import styled, titled_table
from railhil.judge.criteria import STOP_WITHIN_M, Criterion, limit_key, limited
from railhil.judge.judging import Judging, Noted

_QUANTILE_TITLES = {"median": "median", "p95": "95th percentile"}


def _number(value: float | str | None, digits: int) -> str:
    """A figure of ``summary.json``: a number, ``inf``, ``-inf``, or no bound."""
    return "-" if value is None else f"{float(value):.{digits}f}"


def _interval(bounds: Sequence[float | str | None], digits: int) -> str:
    low, high = (_number(bound, digits) for bound in bounds)
    return f"{low}..{high}"


def _digits(criterion: Criterion) -> int:
    return criterion.digits if criterion.statistics_digits is None else criterion.statistics_digits


def _limits(summary: Mapping[str, Any], criteria: Sequence[Criterion]) -> list[Criterion]:
    """The criteria whose limits the scenario has."""
    return [criterion for criterion in limited(criteria) if limit_key(criterion) in summary["limits"]]


def _share(found: Mapping[str, Any]) -> str:
    low, high = found["interval"]
    return f"{percent(found['share'])}\n{100 * low:.2f}..{100 * high:.2f}"


def _scores(summary: Mapping[str, Any], criteria: Sequence[Criterion]) -> Table:
    level = f"{summary['confidence']:.0%} CI"
    titles = [title for name in QUANTILES for title in (_QUANTILE_TITLES[name], level)]
    made = titled_table("Scores", ("law", "score", "unit"), titles)
    for label, law in summary["laws"].items():
        for i, criterion in enumerate(criteria):
            score, digits = law["scores"][criterion.key], _digits(criterion)
            cells = []
            for key in QUANTILES:
                value = score[key]["value"]
                cells.append(criterion.without if value in ("inf", "-inf") else _number(value, digits))
                cells.append(_interval(score[key]["interval"], digits))
            made.add_row("" if i else label, criterion.title, score["unit"], *cells)
    return made


def _inside(summary: Mapping[str, Any], judging: Judging) -> Table:
    criteria = _limits(summary, judging.criteria)
    limits = summary["limits"]
    title = "Runs inside " + " and ".join(criterion.bound(limits[limit_key(criterion)]) for criterion in criteria)
    counts = {"not_stopped": "not\nstopped"} | {extra.counted: extra.heading for extra in judging.extras}
    counts |= {"runs_with_wraps": "with\nwraps"}
    counts = {key: head for key, head in counts.items() if all(key in law for law in summary["laws"].values())}
    invalid = ["INVALID"] if any("invalid" in law for law in summary["laws"].values()) else []
    inside = [*map(key_of, criteria), all_limits(criteria)]
    heads = [
        *(key.replace("_", " ") for key in inside),
        "PASS",
        *invalid,
        *counts.values(),
    ]
    made = titled_table(title, ("law",), heads)
    for label, law in summary["laws"].items():
        shares = [_share(law["inside"][key]) for key in (*inside, "pass")]
        made.add_row(label, *shares, *(f"{invalid_runs(law):,}" for _ in invalid), *(f"{law[key]:,}" for key in counts))
    return made


def _stops(summary: Mapping[str, Any]) -> Table:
    """Shares at fixed distances, independent of the scenario's limit, so that the stricter figures are shown too."""
    heads = [f"{limit:g} m" for limit in STOP_WITHIN_M]
    rows = ([label, *map(_share, law["stopped_within_m"].values())] for label, law in summary["laws"].items())
    return titled_table("Runs that stopped within", ("law",), heads, rows)


def _against(summary: Mapping[str, Any], criteria: Sequence[Criterion]) -> Table:
    heads = ("median difference", f"{summary['confidence']:.0%} CI", "better in", "equal in")
    made = titled_table(f"Against {summary['baseline']}, run by run on the same seeds", ("law", "score", "unit"), heads)
    for label, scores in summary["against_baseline"].items():
        for i, criterion in enumerate(one for one in criteria if one.key in scores):
            score, digits = scores[criterion.key], _digits(criterion)
            apart = score["median_difference"]
            made.add_row(
                "" if i else label,
                criterion.title,
                score["unit"],
                f"{float(apart['value']):+.{digits}f}",
                _interval(apart["interval"], digits),
                percent(score["better"]["share"], 1),
                percent(score["equal_runs"] / summary["runs"], 1),
            )
    return made


def _noted(summary: Mapping[str, Any], noted: Noted) -> Table:
    """How many runs have each name, and the value of largest size."""
    made = titled_table(f"Runs by their {noted.title}", ("law", noted.title), ("runs", f"largest\n{noted.unit}"))
    for label, law in summary["laws"].items():
        for i, one in enumerate(law[noted.key]):
            value = one[noted.value_key]
            shown = "-" if value is None else f"{value:+.{noted.digits}f}"
            made.add_row("" if i else label, one["name"], f"{one['runs']:,}", shown)
    return made


def _errors(run: Mapping[str, Any], summary: Mapping[str, Any], judging: Judging) -> str:
    """The values of a run that have a limit, what is noted of it, and its failures."""
    criteria = _limits(summary, judging.criteria)
    values = [(criterion, run[limit_key(criterion)], summary["limits"][limit_key(criterion)]) for criterion in criteria]
    said = ", ".join(
        f"{criterion.brief} {text_beside_limit(value, limit, 3, '+' if criterion.signed else '')} {criterion.unit}"
        for criterion, value, limit in values
        if value is not None
    )
    failed = f"{run.get('verdict', 'FAIL')}: {'; '.join(run['failures'])}" if run["failures"] else ""
    return "; ".join(filter(None, (said, *noted_words(run, judging), failed)))


def noted_words(run: Mapping[str, Any], judging: Judging) -> list[str]:
    """What is noted of one of the worst runs, in words."""
    return [words for one in judging.noted if (words := one.shown(run[one.key], run[one.value_key]))]


def failure_sentences(summary: Mapping[str, Any]) -> Iterator[str]:
    """Number of runs and reasons, for each law that has failed or has runs that say nothing about it."""
    runs = count_of(summary["runs"], "run", spec=",")
    for label, law in summary["laws"].items():
        if failed := summary["runs"] - law["inside"]["pass"]["runs"] - invalid_runs(law):
            kinds = "; ".join(f"{kind} ({count:,})" for kind, count in law["failures"].items())
            yield f"{label}: FAIL in {failed:,} of {runs}: {kinds}"
        if invalid := invalid_runs(law):
            kinds = "; ".join(f"{kind} ({count:,})" for kind, count in law["invalid"]["reasons"].items())
            yield f"{label}: INVALID in {invalid:,} of {runs}: {kinds}"


def invalid_runs(law: Mapping[str, Any]) -> int:
    """Number of runs that say nothing about the controller."""
    return int(law["invalid"]["runs"]) if "invalid" in law else 0


def tables(summary: Mapping[str, Any], judging: Judging) -> list[Table]:
    """All tables of a campaign."""
    criteria = judging.criteria
    found = [_scores(summary, criteria), _inside(summary, judging)]
    if all("stopped_within_m" in law for law in summary["laws"].values()):
        found.append(_stops(summary))
    found += [_noted(summary, one) for one in judging.noted]
    if summary["against_baseline"]:
        found.append(_against(summary, criteria))
    return found


def headline(summary: Mapping[str, Any]) -> str:
    """The runs of a campaign in a sentence."""
    return (
        f"{summary['runs']:,} perturbed runs of {summary['scenario']} per law, seeds {summary['first_seed']} to "
        f"{summary['last_seed']}, {summary['arithmetic']}, indexed by {summary['indexing']}"
    )


def passed(summary: Mapping[str, Any]) -> str:
    """The share of runs of each law that passed."""
    shares = {label: law["inside"]["pass"]["share"] for label, law in summary["laws"].items()}
    return ", ".join(f"{label} PASS {percent(share)}" for label, share in shares.items())


def texts_of(made: Table) -> tuple[list[str], list[list[str]]]:
    """Headings and rows of a table as texts."""
    heads = [str(column.header).replace("\n", " ") for column in made.columns]
    columns = [[str(text) for text in column.cells] for column in made.columns]
    return heads, [list(row) for row in zip(*columns, strict=True)]


def cell_html(summary: Mapping[str, Any], judging: Judging, figure: Figure, folder: Path) -> str:
    """A campaign in a cell of a notebook.

    :param figure: of the distributions of its scores.
    """
    found = [html_paragraph(text) for text in (headline(summary), *summary["warnings"], passed(summary))]
    for made in tables(summary, judging):
        numbers = [place for place, column in enumerate(made.columns) if column.justify == "right"]
        found.append(html_table(str(made.title), *texts_of(made), numbers))
    found += [html_paragraph(sentence) for sentence in failure_sentences(summary)]
    return html_cell(*found, html_figure(figure), html_paragraph(str(folder)))


def lines(plan: Plan, summary: Mapping[str, Any], folder: Path) -> Iterator[str | Text | Table]:
    """All tables, then the worst runs with the commands that repeat them on the bench."""
    judging = plan.judging
    yield headline(summary)
    for made in tables(summary, judging):
        for warning in summary["warnings"]:
            yield styled(warning, "bold red")
        yield made
        yield ""
    if any(law.get("not_stopped") for law in summary["laws"].values()):
        yield "A run that did not stop counts as infinitely bad in the quantiles of scores that it lacks."
    yield from failure_sentences(summary)
    yield styled("Worst runs, and the command that makes each again on the bench", "bold")
    for label, law in summary["laws"].items():
        for run in law["worst"]:
            yield f"{label}: {', '.join(run['why'])}: {_errors(run, summary, judging)}"
            yield styled(f"  {run['command']}", "dim")
