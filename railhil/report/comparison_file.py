"""The files of a comparison in addition to the run folders: ``compare.json`` and ``compare.csv``."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from railhil.common.errors import describe_os_error
from railhil.common.user_files import RecordFailed, whole_file
from railhil.common.version import full_version
from railhil.judge.record import Record
from railhil.record.documents import COMPARISON
from railhil.record.hash_list import HASH_LIST, HASH_LIST_KEY, write_hash_list
from railhil.record.run_folder import json_text, recorded_by
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

#: Name in the folder of a comparison, next to ``compare.json``.
_TABLE = "compare.csv"


def _row(folder: Path, run: Record) -> dict[str, Any]:
    """One law, without wall-clock figures."""
    found, row = run.score, run.published
    parameters = run.certificate.get("parameters")
    return {
        "label": run.label,
        "controller": run.controller,
        "parameters_sha256": parameters["sha256"] if parameters else None,
        "seed_was_trained": run.seed_was_trained,
        "verdict": run.verdict,
        "line": run.line,
        "scores": dict(found.values),
        "signed": dict(found.signed),
        "published": None if row is None else dict(row.values),
        "frames_sha256": run.certificate.get("frames_sha256"),
        "folder": folder.name,
    }


def _flat(row: dict[str, Any]) -> dict[str, Any]:
    published = row["published"] or {}
    return {
        **{key: row[key] for key in ("label", "controller", "parameters_sha256", "seed_was_trained", "verdict")},
        **row["scores"],
        **{f"signed_{key}": value for key, value in row["signed"].items()},
        **{f"published_{key}": published.get(key) for key in row["scores"]},
        **{key: row[key] for key in ("frames_sha256", "folder")},
    }


def write_comparison(
    folder: Path,
    scenario: AnyScenario,
    common: RunSpec,
    runs: Sequence[tuple[Path, Record]],
    notes: Sequence[str] = (),
) -> dict[str, Any]:
    """Write both files atomically; ``compare.json`` comes last and marks the comparison as complete.

    :param common: one of the runs, which gives the common properties.
    :param runs: run folders below ``folder`` with their recorded runs, in order.
    :param notes: sentences on the comparison as a whole.
    :returns: the content of ``compare.json``.
    :raises RecordFailed: they cannot be written; then neither exists.
    """
    rows = [_row(path, run) for path, run in runs]
    document = {
        **{key: value for key, value in common.as_json().items() if key not in ("controller", "parameters")},
        "scenario_sha256": scenario.sha256,
        "railhil": full_version(),
        "recorded": recorded_by(),
        "notes": list(notes),
        "watch_weakened": scenario.watch_weakened,
        "runs": rows,
        **runs[0][1].judging.counted([run.score for _, run in runs]),
        "published": [row.as_table() for row in scenario.published],
        HASH_LIST_KEY: HASH_LIST,
    }
    try:
        with whole_file(folder / _TABLE) as draft, draft.open("w", encoding="utf-8", newline="") as stream:
            table = csv.DictWriter(stream, list(_flat(rows[0])), lineterminator="\n")
            table.writeheader()
            table.writerows(_flat(row) for row in rows)
        with whole_file(folder / COMPARISON) as draft:
            draft.write_text(json_text(document), encoding="utf-8")
            write_hash_list(folder, {COMPARISON: draft})
    except OSError as error:
        for name in (_TABLE, HASH_LIST):
            (folder / name).unlink(missing_ok=True)
        reason = f"{describe_os_error(error)}; the runs in it are kept"
        raise RecordFailed(f"comparison {folder} cannot be written: {reason}") from error
    return document
