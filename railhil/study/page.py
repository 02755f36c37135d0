"""What people see of a study: tables on the terminal, and the report beside the results."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
from rich.table import Table

from railhil.common.errors import InputError, Words
from railhil.common.output import table
from railhil.record.hash_list import check_hash_list, listed_file
from railhil.study.parts import SUMMARY
from railhil.study.plan import C, P, Study
from railhil.study.table import RESULTS, NotThePart, read_table


def columns(title: str, left: Sequence[str], right: Sequence[str]) -> Table:
    """An empty table: columns of words, and then of numbers."""
    made = table(tight=True)
    made.title, made.title_justify, made.title_style = title, "left", "bold"
    for name in left:
        made.add_column(name, no_wrap=True)
    for name in right:
        made.add_column(name, justify="right", no_wrap=True)
    return made


def finished(study: Study[P, C], plan: P, folder: Path) -> tuple[dict[str, Any], pa.Table]:
    """Summary and rows of a finished study, as they were written.

    :raises InputError: it is not finished, or damaged.
    """
    check_hash_list(folder, study.manifest, None)
    try:
        summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
        rows = read_table(folder / RESULTS, study.columns(plan))
    except FileNotFoundError as error:
        found = Words(f"no {Path(error.filename).name}")
        raise InputError(folder, study.kind, found, f"a finished one ({study.command} --resume)") from None
    except (NotThePart, ValueError) as error:
        allowed = f"{SUMMARY} and {RESULTS} as they were written"
        raise InputError(folder, study.kind, Words(str(error)), allowed) from None
    if rows.num_rows != (wanted := sum(chunk.runs for chunk in plan.chunks())):
        allowed = f"{wanted}, as many as {study.manifest} names runs"
        raise InputError(folder / RESULTS, "rows", rows.num_rows, allowed)
    return summary if isinstance(summary, dict) else {}, rows


def write_page(text: str, path: Path) -> None:
    """Write a report, which is entered into the list of its folder. Raises InputError, OSError."""
    with listed_file(path) as draft:
        draft.write_text(text, encoding="utf-8")
