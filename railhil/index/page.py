"""The page of an index: one HTML file without external references, whose rows are data that its program shows."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from importlib.resources import files
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

from railhil.charts import static_text
from railhil.common.errors import InputError
from railhil.index.curves import all_curves, curves, speed_columns
from railhil.index.find import RUN
from railhil.index.rows import FACTS, LISTS
from railhil.index.show import Row, all_rows, doubts
from railhil.index.tables import Index
from railhil.judge.judging import Judging
from railhil.report.display_columns import ShownColumn
from railhil.report.templates import template, write_html
from railhil.scenarios.system import names, system_named

#: Newest runs whose speeds are in a page that nobody serves, and those of them with all signals.
CURVES_MAX: Final = 200
SIGNALS_MAX: Final = 12
#: Digits of a hash that are shown.
_HASH_DIGITS = 12
#: Columns of every row; the others are those of a run.
_COMMON = ("folder", "kind", "dated_by", "scenario", "system", "law", "seed", "version", "verdict", "line", "problem",
           "is_signed", "has_report")  # fmt: skip
#: What is told of a run when it is compared.
_OF_RUNS = (
    *(name for name in FACTS if name not in ("controller", "seed")), *LISTS, "host", "operator", "parameters",
    "memory_sha256", "why", "ended", "command", "sim_time_s", "wall_time_s", "speed_factor",
)  # fmt: skip


def page(index: Index, links: str, is_served: bool = False) -> str:
    """The page.

    :param links: address of the directory from the page, with ``/`` at its end; empty: they are the same.
    :param is_served: whether ``railhil panel`` serves it: then it leads to recorded runs and their reports.
    """
    rows = all_rows(index)
    return template("index.html.j2", "railhil.index").render(
        title=f"Runs below {index.root.resolve().name}",
        data=_script_json(_data(index, rows, links, is_served)),
        remarks=[*index.remarks, *doubts(rows)],
        chart_styles=static_text("charts.css") + static_text("uPlot.min.css"),
        chart_scripts="".join(
            [*map(static_text, ("uPlot.iife.min.js", "view.js", "charts.js")),
             files("railhil.index").joinpath("static", "index.js").read_text(encoding="utf-8")]
        ),
    )  # fmt: skip


def write_page(index: Index, out: Path) -> None:
    """Write the page completely or not at all.

    :raises OSError: it cannot be written.
    """
    below = os.path.relpath(index.root, out.resolve().parent)
    write_html(page(index, "" if below == "." else f"{quote(Path(below).as_posix())}/"), out)


def _script_json(document: Any) -> str:
    """A JSON text that cannot end the element that holds it."""
    return json.dumps(document, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def _data(index: Index, rows: Sequence[Row], links: str, is_served: bool) -> dict[str, Any]:
    runs = [row for row in rows if row["kind"] == RUN and not row["problem"]]
    folders: dict[str, list[str]] = {}
    for row in runs:
        folders.setdefault(str(row["system"]), []).append(row["folder"])
    speeds = speed_columns(index.root, {name: own for name, own in folders.items() if name in names()})
    columns = {name: _column([row.get(name) for row in rows]) for name in (*_COMMON, *_OF_RUNS)}
    columns["made"] = _column([round(row["made"].timestamp()) for row in rows])
    keys = [*index.score_keys, *(f"signed_{key}" for key in index.score_keys)]
    scores = {key: _column([row.get(key) for row in rows]) for key in keys}
    sentences = {row["folder"]: place for place, row in enumerate(rows)}
    return {
        "written": round(datetime.now(UTC).timestamp()),
        "links": links,
        "root": str(index.root),
        "served": is_served,
        "columns": columns,
        "scores": {key: one for key, one in scores.items() if one["values"] != [None]},
        "systems": {name: _system(name, speeds) for name in folders},
        "requirements": [
            [sentences[one["folder"]], one["id"], one["verdict"], one["margin"], one["unit"], one["says"]]
            for one in index.tables["requirements"].to_pylist()
        ],
        "new": [place for place, row in enumerate(rows) if row["is_new"]],
        # A page that is served asks for those of the runs that are compared.
        "curves": {} if is_served else _curves(index.root, runs, speeds),
    }


def _curves(root: Path, runs: Sequence[Row], speeds: Mapping[str, ShownColumn]) -> dict[str, Any]:
    """Points by folder."""
    found = {row["folder"]: all_curves(root / row["folder"]) for row in runs[-SIGNALS_MAX:]}
    for row in runs[-CURVES_MAX:-SIGNALS_MAX]:
        if row["system"] in speeds:
            found[row["folder"]] = curves(root / row["folder"], [speeds[row["system"]]])
    return {folder: one for folder, one in found.items() if one}


def _column(values: Sequence[Any]) -> dict[str, Any]:
    """Each value once, and the place of the value of each row."""
    known: dict[str, int] = {}
    found: list[Any] = []
    places = []
    for value in values:
        shown = value[:_HASH_DIGITS] if isinstance(value, str) and len(value) == 64 and " " not in value else value
        key = repr(shown)
        if key not in known:
            known[key] = len(found)
            found.append(shown)
        places.append(known[key])
    return {"values": found, "rows": places}


def _system(name: str, speeds: Mapping[str, ShownColumn]) -> dict[str, Any]:
    """Scores of a system and its speed, as pages show them; empty if it is not installed."""
    try:
        judging: Judging = system_named(name).part("judging")
    except InputError:
        return {"criteria": [], "speed": None}
    criteria = [
        {"key": one.key, "title": one.title, "unit": one.unit_typeset, "digits": one.digits, "better": one.better,
         "signed": one.signed, "brief": one.on_terminal}
        for one in judging.criteria
    ]  # fmt: skip
    return {"criteria": criteria, "speed": speeds[name].name if name in speeds else None}
