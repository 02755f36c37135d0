"""``railhil reproduce PAPER --out DIR``: the page with its pictures, the tables as CSV, and the document.

``page.md`` and the tables are pure functions of the measured runs. The bytes of a picture also depend on the version of
matplotlib.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.common.whole_file import whole_file
from railhil.record.errors import not_written
from railhil.reproduce.document import Shown, document
from railhil.reproduce.paper import Paper, Results, Table

if TYPE_CHECKING:
    from railhil.report.figures import Picture

PAGE, RESULTS, RUNS = "page.md", "results.json", "runs"
#: Digits of a hash in a table; the document has all of them.
_DIGEST_DIGITS = 12
#: So many seeds that follow each other are written as a range.
_MANY_SEEDS = 10


def write_page(paper: Paper, results: Results, pictures: Sequence[Picture], folder: Path) -> None:
    """Write page, pictures, tables and document into a folder; older ones of these names are replaced.

    :raises InputError: the folder cannot be written.
    :raises RecordFailed: the disk is full.
    """
    files = {PAGE: page(paper, results, shown(pictures))}
    files |= {f"{table.name}.csv": csv_text(table) for table in paper.tables(results)}
    files |= {f"{picture.name}.svg": picture.svg + "\n" for picture in pictures}
    files |= parameter_files(paper, results)
    files[RESULTS] = json.dumps(document(paper, results, shown(pictures)), indent=2, allow_nan=False) + "\n"
    try:
        for name, text in files.items():
            (folder / name).parent.mkdir(exist_ok=True)
            with whole_file(folder / name) as draft:
                draft.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise not_written("--out", folder, "folder", error) from None


def parameter_files(paper: Paper, results: Results) -> dict[str, str]:
    """Content of the parameter files that the commands of the entries name, by path in the folder of the page."""
    sets = (planned.spec.law.parameters for planned in paper.planned(results.seeds))
    return {str(one.source): one.text for one in sets if one is not None and not one.source.is_absolute()}


def shown(pictures: Sequence[Picture]) -> list[Shown]:
    """What page and document say of the pictures."""
    return [Shown(one.name, one.title, one.caption) for one in pictures]


def csv_text(table: Table) -> str:
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


def page(paper: Paper, results: Results, pictures: Sequence[Shown] = ()) -> str:
    """The page as Markdown.

    :param pictures: those that stand beside the page.
    """
    return "\n".join(_lines(paper, results, pictures)).rstrip("\n") + "\n"


def _lines(paper: Paper, results: Results, pictures: Sequence[Shown]) -> Iterator[str]:
    yield from (f"# {paper.title}", "", f"{paper.source}.", "")
    seeds = "" if results.seeds == paper.seeds else f" --seeds {seeds_said(results.seeds, ',', '-')}"
    yield f"Written by `railhil reproduce {paper.name}{seeds} --out DIR`, railhil {version('railhil')}; the same seeds"
    yield from ("give the same page on every machine.", "", "## Protocol", "")
    yield from (f"* {sentence}" for sentence in paper.protocol)
    yield f"* Seeds: {seeds_said(results.seeds, ', ', ' to ')}."
    if missing := sum(one.key not in results.runs for one in paper.planned(results.seeds)):
        yield f"* {missing} of these runs were not made; figures that need them are missing below."
    yield ""
    for table in paper.tables(results):
        yield from (f"## {table.title}", "")
        numbers = range(table.first_number, len(table.headings) - 1)
        yield from _markdown(table.headings, _grouped([table.cells(line) for line in table.lines]), numbers)
        if table.note:
            yield from (table.note, "")
    if pictures:
        yield from ("## Figures", "")
    for one in pictures:
        yield from (f"### {one.title}", "", f"![{one.title}]({one.name}.svg)", "", one.caption, "")
    yield from ("## What follows and what does not", "")
    for statement in paper.statements(results):
        here = f"{statement.measured}{' ' * bool(statement.why)}{statement.why}"
        yield f"* {statement.at}: **{statement.verdict}**. Paper: {statement.claim} Here: {here}"
    yield ""
    if readings := paper.readings():
        yield from ("## How the paper is read", "")
        rows = [[one.at, one.reading, one.other] for one in readings]
        yield from _markdown(("where", "reading of this bench", "otherwise"), rows, ())
    # Last, because there may be hundreds.
    yield from ("## Runs", "")
    yield from _markdown(("run", "verdict", "SHA-256", "again"), _run_rows(paper, results), ())


def seeds_said(seeds: Sequence[int], comma: str, to: str) -> str:
    """Seeds in words; many that follow each other by the first and the last."""
    if len(seeds) >= _MANY_SEEDS and list(seeds) == list(range(seeds[0], seeds[0] + len(seeds))):
        return f"{seeds[0]}{to}{seeds[-1]}"
    return comma.join(map(str, seeds))


def _run_rows(paper: Paper, results: Results) -> Iterator[list[str]]:
    for planned in paper.planned(results.seeds):
        again = f"`{planned.again}`" if planned.again else ""
        if (found := results.runs.get(planned.key)) is None:
            yield [planned.key, "not made", "", again]
            continue
        verdict = f"{found.verdict}{': ' if found.reasons else ''}{'; '.join(found.reasons)}"
        digest = f"`{found.sha256[:_DIGEST_DIGITS]}`" if found.sha256 else "no log"
        yield [planned.key, verdict, digest, again]


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
