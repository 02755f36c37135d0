"""``railhil query``: SQL over the index of all run folders below a directory."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from railhil.cli.runs import add_index_arguments
from railhil.common.extras import need
from railhil.common.output import Output, table
from railhil.common.streams import add_json_argument, print_json

_TABLES = """\
tables, each with the column folder:
  folders       every folder: kind, made, scenario, law, seed, version, verdict, line
  runs          every run: its facts, and a column for each score
  requirements  outcomes of sentences: id, verdict, margin, unit, instant_s
  faults        injected faults: fault, begun_s, effect_s, ended_s, hits
  events        events.csv of every run
  reactions     rows of railhil faults: entry, detected_by, reaction, margin_ms
  figures       campaigns: law, score, figure (median, p95), value
  "summarize runs" tells the columns of one"""


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Register the subcommand."""
    parser = commands.add_parser(
        "query",
        examples=[
            'railhil query "select law, count(*) as runs, avg(stop_error_m) from runs group by law"',
            "railhil query \"select folder, id, margin from requirements where verdict = 'violated'\" runs --json",
        ],
        remark=lambda columns: _TABLES,
    )
    parser.add_argument("statement", metavar="SQL", help="a statement of DuckDB over the tables below")
    add_index_arguments(parser)
    add_json_argument(parser)


def work(namespace: argparse.Namespace) -> int:
    """Print the rows of the statement."""
    need("duckdb", "index", command="railhil query")
    from railhil.index.query import answer, rows_of
    from railhil.index.tables import open_index

    index = open_index(Path(namespace.folder), namespace.again)
    found = answer(index, namespace.statement)
    console = Output(stderr=namespace.json)
    rows = rows_of(found)
    if namespace.json:
        # Instants and decimals as text; JSON has no NaN.
        print_json(json.loads(json.dumps(rows, default=str), parse_constant=lambda text: None))
    else:
        console.print(table(*found.column_names, rows=(map(_shown, row.values()) for row in rows)))
    for remark in index.remarks:
        console.say(remark, style="yellow")
    return 0


def _shown(value: Any) -> str:
    return "" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
