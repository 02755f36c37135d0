"""A finished study: its summary and rows, its plan with the present installation, and the differences of a run that is
made again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pyarrow as pa

from railhil.common.errors import InputError, Words
from railhil.common.user_files import given_json
from railhil.record.documents import SUMMARY
from railhil.record.hash_list import check_hash_list
from railhil.study.manifest import differing_values, read_manifest, shown_value
from railhil.study.plan import C, P, Study
from railhil.study.table import RESULTS, NotThePart, read_table

#: Keys of hashes of code, in an identity and in the tables in it.
_CODE = ("code_sha256", "batch_sha256", "system_sha256", "law_sha256")


@dataclass(frozen=True, slots=True)
class Verified:
    """One run that was made again: its identity in words and as JSON, and the columns in which it differs (the study's
    value, the bench's value)."""

    run: str
    document: Mapping[str, Any]
    differences: Mapping[str, tuple[Any, Any]]


def repeated_plan(study: Study[P, C], folder: Path, **named: Any) -> tuple[P, bool]:
    """The plan of a study, made with the present installation, and whether the code has changed since, so that a
    difference need not be a defect.

    :param named: fields of the request that the command line names again.
    :raises InputError: scenario, parameters or laws have changed since, or a file of the folder.
    """
    begun = read_manifest(folder, study)
    check_hash_list(folder, study.manifest, None)
    plan = study.make_plan(replace(begun.request, **named))
    ours = json.loads(json.dumps(plan.identity))
    begun_same = {key: begun.identity.get(key) for key in ours}
    differing = list(differing_values(begun_same, ours, study.kind))
    for key, found, wanted in differing:
        if key.rpartition(".")[2] not in _CODE:
            allowed = f"{shown_value(wanted)}, what this installation would run"
            raise InputError(folder / study.manifest, key, found, allowed)
    return plan, bool(differing)


def finished_rows(study: Study[P, C], plan: P, folder: Path) -> pa.Table:
    """The rows of a finished study. Raises InputError."""
    try:
        rows = read_table(folder / RESULTS, study.columns(plan))
    except FileNotFoundError:
        raise _unfinished(study, folder, RESULTS) from None
    except (OSError, NotThePart) as why:
        allowed = f"what {study.command} has written"
        raise InputError(folder / RESULTS, "", Words(str(why)), allowed) from why
    if rows.num_rows != (wanted := sum(chunk.runs for chunk in study.grown(plan, rows).chunks())):
        allowed = f"{wanted}, as many as {study.manifest} names {study.unit}s"
        raise InputError(folder / RESULTS, "rows", rows.num_rows, allowed)
    return rows


def finished_summary(study: Study[P, C], folder: Path) -> dict[str, Any]:
    """``summary.json`` of a finished study. Raises InputError."""
    if not (folder / SUMMARY).exists():
        raise _unfinished(study, folder, SUMMARY)
    return given_json(folder / SUMMARY, f"what {study.command} has written")


def _unfinished(study: Study[P, C], folder: Path, name: str) -> InputError:
    return InputError(folder, "", Words(f"has no {name}"), f"a finished {study.kind} (--resume finishes it)")


def differences(ours: Mapping[str, Any], bench: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Columns in which a run differs: the study's value and the bench's value."""
    return {name: (ours[name], theirs) for name, theirs in bench.items() if ours[name] != theirs}
