"""``report.html`` of a campaign: distributions of the scores, and the worst runs; a function of results and folder."""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pyarrow as pa

from railhil.campaign.manifest import MANIFEST, read_manifest
from railhil.campaign.parts import RESULTS, SUMMARY
from railhil.campaign.plan import Plan, make_plan
from railhil.campaign.results_table import NotThePart, column_of, numbers, read_results, rows_of
from railhil.common.digits import percent
from railhil.common.errors import InputError, Words
from railhil.record.hash_list import REPORT, check_hash_list, listed_file
from railhil.report.distribution import Spread, limits_of, picture
from railhil.report.styles import styles
from railhil.report.templates import script, styles_text, template
from railhil.scenarios.stored import any_judged_sha256

#: Folder in that of the campaign for runs that are made again.
_AGAIN = "worst"


def page(plan: Plan, summary: Mapping[str, Any], table: pa.Table, folder: Path) -> str:
    """The report as one HTML document.

    :param table: rows of ``results.parquet``.
    :param folder: of the campaign; runs that were made again in it are linked.
    """
    labels = [entry.label for entry in plan.entries]
    looks = dict(zip(labels, styles([entry.law.controller for entry in plan.entries]), strict=True))
    by_law = {label: rows_of(table, label) for label in labels}
    spreads = [
        Spread(
            criterion,
            limits_of(plan.scenario, criterion),
            {label: numbers(rows, column_of(criterion)) for label, rows in by_law.items()},
        )
        for criterion in plan.criteria
    ]
    return template("campaign.html.j2", "railhil.campaign").render(
        summary=summary,
        title=plan.scenario.title,
        asked=plan.judging.asked(plan.scenario),
        columns=plan.criteria,
        rows=[_row(plan, label, law) for label, law in summary["laws"].items()],
        worst=[_worst(label, run, folder) for label, law in summary["laws"].items() for run in law["worst"]],
        spread_picture=picture(spreads, looks),
        chart_scripts=script(),
        chart_styles=styles_text(),
    )


def _row(plan: Plan, label: str, law: Mapping[str, Any]) -> dict[str, Any]:
    cells = []
    for criterion in plan.criteria:
        score = law["scores"][criterion.key]
        values = [score[name]["value"] for name in ("median", "p95")]
        cells.append(", ".join(criterion.shown(None if value is None else float(value)) for value in values))
    failures = "; ".join(f"{kind} ({count})" for kind, count in law["failures"].items())
    return {"label": label, "cells": cells, "passed": percent(law["inside"]["pass"]["share"]), "failures": failures}


def _worst(label: str, run: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    place = f"{_AGAIN}/{label}-{run['seed']}"
    report = f"{place}/{REPORT}"
    return {
        "name": f"{label}-{run['seed']}",
        "label": label,
        "seed": run["seed"],
        "why": "; ".join([", ".join(run["why"]), *run["failures"]]),
        "command": f"{run['command']} --out {shlex.quote(place)}",
        "link": report if (folder / report).is_file() else "",
    }


def report_of(folder: Path, out: Path) -> None:
    """Write the report of a finished campaign from its folder.

    :raises InputError: the campaign is not finished, damaged, changed, or of a scenario that has changed since.
    :raises OSError: it cannot be written.
    """
    plan = make_plan(read_manifest(folder).request)
    check_hash_list(folder, MANIFEST, None)
    try:
        summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
        table = read_results(folder / RESULTS, plan.judging)
    except FileNotFoundError as error:
        found = Words(f"no {Path(error.filename).name}")
        raise InputError(folder, "campaign", found, "a finished one (railhil campaign --resume)") from None
    except (NotThePart, ValueError) as error:
        raise InputError(
            folder, "campaign", Words(str(error)), f"{SUMMARY} and {RESULTS} as they were written"
        ) from None
    if table.num_rows != (wanted := sum(chunk.runs for chunk in plan.chunks())):
        raise InputError(folder / RESULTS, "rows", table.num_rows, f"{wanted}, as many as {MANIFEST} names runs")
    told = summary.get("scenario_sha256") if isinstance(summary, dict) else None
    if told != (sha256 := any_judged_sha256(plan.scenario)):
        raise InputError(folder, "scenario", str(told), f"{sha256}, as it is now")
    text = page(plan, summary, table, folder)
    with listed_file(out) as draft:
        draft.write_text(text, encoding="utf-8")
