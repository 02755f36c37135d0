"""The table of ``railhil faults --out``, of entries of a catalogue or of random pairs, with its page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from railhil.common.errors import InputError, describe_os_error
from railhil.common.user_files import RecordFailed, whole_file
from railhil.judge.folder import code_sha256, made_by
from railhil.record.documents import FAULT_TABLE
from railhil.record.hash_list import HASH_LIST, HASH_LIST_KEY, write_hash_list
from railhil.record.run_folder import json_text, recorded_by
from railhil.record.signature import sign_list
from railhil.run.report import say_report
from railhil.scenarios.run_spec import RunSpec


def check_new(out: Path | None) -> None:
    """Refuse a folder that has files. Raises InputError."""
    if out is not None and (out.is_file() or (out.is_dir() and any(out.iterdir()))):
        raise InputError("command line", "--out", str(out), "an empty or new folder")


def says_by_id(base: RunSpec) -> dict[str, str]:
    """The sentences by which each run is judged, by id."""
    return {str(one["id"]): str(one["says"]) for one in base.requirements}


def keep_table(
    out: Path | None,
    base: RunSpec,
    key: Path | None,
    is_shown: bool,
    rows: Sequence[dict[str, Any]] = (),
    **further: Sequence[Any],
) -> str:
    """Write the table and its page beside the run folders, with the list of hashes over all of them, and sign it.

    :param out: None: nothing is kept. ``is_shown``: whether there is to be a page.
    :param rows: of the entries, ``further``: their ids as ``entries``, or the runs with random faults as ``pairs``.
    :returns: a line on the page. :raises RecordFailed: the table cannot be written.
    """
    if out is None:
        return ""
    system = base.load().installed_system.name
    document = {
        "scenario": base.scenario,
        "system": system,
        # The run folder of an entry with a law of its own names this law.
        "controller": base.law.controller,
        "seed": base.seed,
        "recorded": recorded_by(),
        "sentences": says_by_id(base),
        **further,
        **made_by(system, base.law.controller, code_sha256()),
        "rows": list(rows),
        HASH_LIST_KEY: HASH_LIST,
    }
    path = out / FAULT_TABLE
    try:
        # Possibly no entry has had a run.
        out.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as draft:
            draft.write_text(json_text(document), encoding="utf-8")
            write_hash_list(out, {FAULT_TABLE: draft})
    except OSError as error:
        raise RecordFailed(f"{path} cannot be written: {describe_os_error(error)}") from error

    def write(page: Path) -> None:
        from railhil.report.fault_matrix import report_of

        report_of([out], page)

    line = say_report(out, write) if is_shown else ""
    sign_list(out, key)
    return line
