"""``report.html`` of a campaign: distributions of the scores, and the worst runs; a function of results and folder."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa

from railhil.campaign.distributions import distributions
from railhil.campaign.plan import Plan, make_plan
from railhil.campaign.show import noted_words
from railhil.campaign.study import CAMPAIGN
from railhil.common.digits import count_of, percent
from railhil.common.errors import InputError
from railhil.judge.judging import Judging, Noted
from railhil.record.hash_list import REPORT, check_hash_list
from railhil.report.templates import render_page, write_html
from railhil.scenarios.given import RecordedController, is_law_name
from railhil.scenarios.scenario_documents import any_judged_sha256
from railhil.study.finished import finished_rows, finished_summary
from railhil.study.manifest import Manifest, read_manifest

#: Folder inside the campaign's folder for runs that are made again.
_AGAIN = "worst"


def page(plan: Plan, summary: Mapping[str, Any], table: pa.Table, folder: Path, railhil: str) -> str:
    """The report as one HTML document.

    :param railhil: the version that has begun the campaign.
    :param table: rows of ``results.parquet``.
    :param folder: of the campaign; runs that were made again in it are linked.
    """
    return render_page(
        "campaign.html.j2",
        "railhil.campaign",
        summary=summary,
        title=plan.scenario.title,
        asked=plan.judging.asked(plan.scenario),
        railhil=railhil,
        columns=plan.criteria,
        rows=[_row(plan, label, law) for label, law in summary["laws"].items()],
        worst=[
            _worst(label, run, folder, plan.judging) for label, law in summary["laws"].items() for run in law["worst"]
        ],
        spread_picture=distributions(summary, plan.criteria, table),
    )


def _row(plan: Plan, label: str, law: Mapping[str, Any]) -> dict[str, Any]:
    cells = []
    for criterion in plan.criteria:
        score = law["scores"][criterion.key]
        values = [score[name]["value"] for name in ("median", "p95")]
        cells.append(", ".join(criterion.shown(None if value is None else float(value)) for value in values))
    invalid = law["invalid"]["reasons"] if "invalid" in law else {}
    kinds = [*law["failures"].items(), *((f"INVALID: {kind}", count) for kind, count in invalid.items())]
    failures = "; ".join(f"{kind} ({count})" for kind, count in kinds)
    return {
        "label": label,
        "cells": cells,
        "passed": percent(law["inside"]["pass"]["share"]),
        "failures": failures,
        "noted": [words for one in plan.judging.noted if (words := _noted(one, law[one.key]))],
    }


def _noted(noted: Noted, found: Sequence[Mapping[str, Any]]) -> str:
    """Runs by what is noted of them, such as their worst stop, in words."""
    words = [
        f"{one['name']} in {count_of(one['runs'], 'run')}"
        + ("" if one[noted.value_key] is None else f" (largest {one[noted.value_key]:+.{noted.digits}f} {noted.unit})")
        for one in found
    ]
    return f"{noted.title}: {'; '.join(words)}" if words else ""


def _worst(label: str, run: Mapping[str, Any], folder: Path, judging: Judging) -> dict[str, Any]:
    place = f"{_AGAIN}/{label}-{run['seed']}"
    report = f"{place}/{REPORT}"
    return {
        "name": f"{label}-{run['seed']}",
        "label": label,
        "seed": run["seed"],
        "why": "; ".join([", ".join(run["why"]), *noted_words(run, judging), *run["failures"]]),
        "command": f"{run['command']} --out {shlex.quote(place)}",
        "link": report if (folder / report).is_file() else "",
    }


def _recorded(begun: Manifest, file: Path) -> dict[str, RecordedController]:
    """The controllers of users: named as in the campaign, and not loaded."""
    texts = [text for text in begun.request.laws if not is_law_name(text)]
    given = (law for law in begun.identity["laws"] if "form" in law)
    return {
        text: RecordedController.of_identity(text, law, begun.identity["arithmetic"], file)
        for text, law in zip(texts, given, strict=True)
    }


def report_of(folder: Path, out: Path) -> None:
    """Write the report of a finished campaign from its folder.

    :raises InputError: the campaign is not finished, damaged, changed, or of a scenario that has changed since.
    :raises OSError: it cannot be written.
    """
    begun = read_manifest(folder, CAMPAIGN)
    plan = make_plan(begun.request, _recorded(begun, folder / CAMPAIGN.manifest))
    check_hash_list(folder, CAMPAIGN.manifest, None)
    summary, table = finished_summary(CAMPAIGN, folder), finished_rows(CAMPAIGN, plan, folder)
    told, sha256 = summary.get("scenario_sha256"), any_judged_sha256(plan.scenario)
    if told != sha256:
        raise InputError(folder, "scenario", str(told), f"{sha256}, as it is now")
    write_html(page(plan, summary, table, folder, begun.railhil), out)
