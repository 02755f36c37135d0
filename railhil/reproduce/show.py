"""Prints the result of ``railhil reproduce`` on a terminal."""

from __future__ import annotations

from collections.abc import Iterable

from railhil.common.output import Output, table
from railhil.reproduce.paper import FOLLOWS, FOLLOWS_NOT, IN_PART, Paper, Results, Table

_COLOURS = {FOLLOWS: "green", IN_PART: "yellow", FOLLOWS_NOT: "red"}


def show_papers(console: Output, papers: Iterable[Paper]) -> None:
    """The papers and the number of entries of their protocols."""
    rows = table()
    for name in ("paper", "title", "entries"):
        rows.add_column(name, justify="right" if name == "entries" else "left")
    for paper in papers:
        rows.add_row(paper.name, paper.title, str(len(paper.planned(paper.seeds))))
    console.print(rows)


def show(console: Output, paper: Paper, results: Results) -> None:
    """Protocol, tables and statements."""
    console.say(paper.title, style="bold")
    console.say(paper.source, style="dim")
    for sentence in paper.protocol:
        console.say(f"- {sentence}", style="dim")
    for one in paper.tables(results):
        console.say("")
        _show_table(console, one)
    console.say("")
    console.say("What follows and what does not", style="bold")
    for statement in paper.statements(results):
        console.say(f"{statement.verdict}: {statement.at}: {statement.claim}", style=_COLOURS.get(statement.verdict))
        console.say(f"    here: {statement.measured}{f' {statement.why}' if statement.why else ''}")
    for found in results.runs.values():
        if found.verdict == "INVALID":
            console.say(f"INVALID: {found.key}: {'; '.join(found.reasons)}", style="bold yellow")


def _show_table(console: Output, shown: Table) -> None:
    console.say(shown.title, style="bold")
    rows = table(tight=True)
    for place, name in enumerate(shown.headings):
        is_number = shown.first_number <= place < len(shown.headings) - 1
        rows.add_column(name, justify="right" if is_number else "left", no_wrap=is_number)
    before = ""
    for line in shown.lines:
        first, *cells = shown.cells(line)
        if before and first != before and line.item:
            rows.add_section()
        rows.add_row("" if first == before else first, *cells)
        before = first
    console.print(rows)
    if shown.note:
        console.say(shown.note, style="dim")
