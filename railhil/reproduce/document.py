"""The result of ``railhil reproduce PAPER`` as one JSON document, as a page with its figures, and its tables as CSV.

``page.md`` and the tables are pure functions of the measured runs. The bytes of a figure also depend on the version of
matplotlib.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from railhil.charts.figure import Figure
from railhil.common.user_files import refuse_unwritable, whole_file
from railhil.reproduce.comparison import Line, Table
from railhil.reproduce.paper import Paper, Results

PAGE, RESULTS, RUNS = "page.md", "results.json", "runs"
#: Digits of a hash in a table; the document has all of them.
_DIGEST_DIGITS = 12
#: From this many successive seeds on, they are written as a range.
_MANY_SEEDS = 10


def write_page(paper: Paper, results: Results, figures: Sequence[Figure], folder: Path) -> None:
    """Write page, figures, tables and document into a folder; older ones of these names are replaced.

    :param figures: none where matplotlib is not installed.

    :raises InputError: the folder cannot be written.
    :raises RecordFailed: the disk is full.
    """
    texts = {PAGE: render_page(paper, results, figures)}
    texts |= {f"{table.name}.csv": render_csv(table) for table in paper.compare(results)}
    if figures:
        from railhil.report.pictures import printed

        texts |= {f"{picture.name}.svg": picture.svg + "\n" for picture in printed(figures)}
    texts |= render_parameters(paper, results)
    texts[RESULTS] = json.dumps(make_document(paper, results, figures), indent=2, allow_nan=False) + "\n"
    with refuse_unwritable("--out", folder, "folder"):
        for name, text in texts.items():
            (folder / name).parent.mkdir(exist_ok=True)
            with whole_file(folder / name) as draft:
                draft.write_text(text, encoding="utf-8", newline="\n")


def make_document(paper: Paper, results: Results, figures: Sequence[Figure] = ()) -> dict[str, Any]:
    """Runs, tables and statements of a paper, and the figures that stand beside the document."""
    return {
        "paper": paper.name,
        "title": paper.text.title,
        "source": paper.text.source,
        "railhil": results.railhil,
        "protocol": list(paper.text.protocol),
        "seeds": list(results.seeds),
        "runs": [
            {"run": entry.key, "again": entry.command, **results.runs[entry.key].as_json()}
            for entry in paper.plan(results.seeds)
            if entry.key in results.runs
        ],
        "tables": [
            {
                "name": table.name,
                "title": table.title,
                "note": table.note,
                "lines": [_line(table, line) for line in table.lines],
            }
            for table in paper.compare(results)
        ],
        "statements": [asdict(statement) for statement in paper.judge(results)],
        "figures": [{"name": one.name, "title": one.title, "caption": one.caption} for one in figures],
    }


def _line(table: Table, line: Line) -> dict[str, Any]:
    return {
        "quantity": line.quantity,
        "item": line.item,
        "unit": line.unit,
        "published": line.published,
        "measured": dict(zip(table.columns, line.measured, strict=True)),
        "ratio": dict(zip(table.columns, line.ratios, strict=True)) if table.with_ratio else {},
        "remark": line.remark,
    }


def render_parameters(paper: Paper, results: Results) -> dict[str, str]:
    """Content of the parameter files that the commands of the entries name, by path in the folder of the page."""
    sets = (entry.spec.law.parameters for entry in paper.plan(results.seeds))
    return {str(one.source): one.text for one in sets if one is not None and not one.source.is_absolute()}


def render_csv(table: Table) -> str:
    """A table as CSV: unrounded values, ratios only where they mean something."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    ratios = [f"{name} ratio" for name in table.columns] if table.with_ratio else []
    rows.writerow(["quantity", "item", "unit", "published", *table.columns, *ratios, "remark"])
    for line in table.lines:
        numbers = [line.published, *line.measured, *(line.ratios if table.with_ratio else ())]
        cells = ("" if value is None else repr(value) for value in numbers)
        rows.writerow([line.quantity, line.item, line.unit, *cells, line.remark])
    return text.getvalue()


def render_page(paper: Paper, results: Results, figures: Sequence[Figure] = ()) -> str:
    """The page as Markdown.

    :param figures: those that stand beside the page.
    """
    return "\n".join(_lines(paper, results, figures)).rstrip("\n") + "\n"


def _lines(paper: Paper, results: Results, figures: Sequence[Figure]) -> Iterator[str]:
    text = paper.text
    yield from (f"# {text.title}", "", f"{text.source}.", "")
    seeds = "" if results.seeds == text.seeds else f" --seeds {format_seeds(results.seeds, ',', '-')}"
    yield f"Written by `railhil reproduce {paper.name}{seeds} --out DIR`, railhil {results.railhil}; the same seeds"
    yield from ("give the same page on every machine.", "", "## Protocol", "")
    yield from (f"* {sentence}" for sentence in text.protocol)
    yield f"* Seeds: {format_seeds(results.seeds, ', ', ' to ')}."
    if missing := sum(one.key not in results.runs for one in paper.plan(results.seeds)):
        yield f"* {missing} of these runs were not made; figures that need them are missing below."
    yield ""
    for table in paper.compare(results):
        yield from (f"## {table.title}", "")
        numbers = range(table.first_number, len(table.headings) - 1)
        yield from _markdown(table.headings, _grouped([table.cells(line) for line in table.lines]), numbers)
        if table.note:
            yield from (table.note, "")
    if figures:
        yield from ("## Figures", "")
    for one in figures:
        yield from (f"### {one.title}", "", f"![{one.title}]({one.name}.svg)", "", one.caption, "")
    yield from ("## What follows and what does not", "")
    for statement in paper.judge(results):
        here = f"{statement.measured}{' ' * bool(statement.why)}{statement.why}"
        yield f"* {statement.at}: **{statement.verdict}**. Paper: {statement.claim} Here: {here}"
    yield ""
    if text.readings:
        yield from ("## How the paper is read", "")
        rows = [[one.at, one.reading, one.other] for one in text.readings]
        yield from _markdown(("where", "reading of this bench", "otherwise"), rows, ())
    # The table of the runs comes last, because there may be hundreds.
    yield from ("## Runs", "")
    yield from _markdown(("run", "verdict", "SHA-256", "again"), _run_rows(paper, results), ())


def format_seeds(seeds: Sequence[int], comma: str, to: str) -> str:
    """Seeds in words; many that follow each other by the first and the last."""
    if len(seeds) >= _MANY_SEEDS and list(seeds) == list(range(seeds[0], seeds[0] + len(seeds))):
        return f"{seeds[0]}{to}{seeds[-1]}"
    return comma.join(map(str, seeds))


def _run_rows(paper: Paper, results: Results) -> Iterator[list[str]]:
    for entry in paper.plan(results.seeds):
        again = f"`{entry.command}`" if entry.command else ""
        if (found := results.runs.get(entry.key)) is None:
            yield [entry.key, "not made", "", again]
            continue
        verdict = f"{found.verdict}{': ' if found.reasons else ''}{'; '.join(found.reasons)}"
        digest = f"`{found.sha256[:_DIGEST_DIGITS]}`" if found.sha256 else "no log"
        yield [entry.key, verdict, digest, again]


def _grouped(rows: Sequence[list[str]]) -> Iterator[list[str]]:
    """The same rows, with the first cell only where it changes."""
    before = ""
    for row in rows:
        yield ["" if row[0] == before else row[0], *row[1:]]
        before = row[0]


def _markdown(
    headings: Sequence[str], rows: Iterator[list[str]] | Sequence[list[str]], right: Sequence[int]
) -> Iterator[str]:
    """A table; ``right``: places of the columns of numbers."""
    yield f"| {' | '.join(headings)} |"
    yield f"|{'|'.join('---:' if place in right else '---' for place in range(len(headings)))}|"
    for row in rows:
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |"
    yield ""
