"""Runs ``railhil learn`` from its plan to its summary, using the parts that already exist."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pyarrow as pa
from pydantic import BaseModel, ConfigDict, Field
from rich.console import Console

from railhil.campaign.engines import Engine
from railhil.campaign.parts import RESULTS, PartsFolder, check_same, locked
from railhil.campaign.results_table import file_bytes
from railhil.campaign.run import completed
from railhil.common.build import machine
from railhil.common.command_line import SEED_MAX
from railhil.common.errors import InputError, Words
from railhil.record.hash_list import HASH_LIST, HASH_LIST_KEY, check_document
from railhil.scenarios.stored import any_document
from railhil.scenarios.validation import validated
from railhil.sequences.plan import CHUNK_MAX, RUNS_MAX, SEQUENCES_MAX, Chunk, Plan, Request
from railhil.sequences.summary import summary
from railhil.sequences.table import read_part
from railhil.sequences.work import origin_of, task_of

MANIFEST = "learn.json"
_FORMAT = 1


class _Request(BaseModel):
    """:class:`~railhil.sequences.plan.Request` as JSON, with the bounds of the command line."""

    model_config = ConfigDict(extra="forbid", strict=True)
    scenario: str = Field(min_length=1)
    settings: list[str]
    faults: list[str]
    controller: str
    arithmetic: str
    indexing: str
    parameters: str | None
    nominal: bool
    runs: int = Field(ge=1, le=RUNS_MAX)
    sequences: int = Field(ge=1, le=SEQUENCES_MAX)
    seed: int = Field(ge=0, le=SEED_MAX)
    chunk: int = Field(ge=1, le=CHUNK_MAX)


class _File(BaseModel):
    """The part that is read back; the rest is information for people."""

    model_config = ConfigDict(extra="ignore", strict=True)
    study: dict[str, Any]
    request: _Request


def read_manifest(folder: Path) -> tuple[dict[str, Any], Request]:
    """Identity and request of ``learn.json``.

    :raises InputError: there is none, or it was not written by ``railhil learn``.
    """
    path = folder / MANIFEST
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(path, "", Words((error.strerror or str(error)).lower()), "folder of railhil learn") from None
    except (ValueError, RecursionError):
        raise InputError(path, "", Words("no JSON"), "what `railhil learn` has written") from None
    if not isinstance(document, dict) or document.get("format") != _FORMAT:
        raise InputError(path, "format", Words("something else"), f"{_FORMAT}, of this railhil")
    file = validated(_File, document, lambda keys: path)
    check_document(folder, MANIFEST, document)
    values: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in file.request}
    return file.study, Request(**values)


def _manifest(plan: Plan) -> dict[str, Any]:
    """Content of ``learn.json``: ``study`` must be the same when resuming, the rest is explanation."""
    return {
        "format": _FORMAT,
        "railhil": version("railhil"),
        "study": plan.identity,
        "request": asdict(plan.request),
        "scenario": any_document(plan.scenario),
        "machine": machine(),
        HASH_LIST_KEY: HASH_LIST,
    }


def execute(
    plan: Plan, out: str | None, console: Console, engine: Engine, say: Callable[[str], None]
) -> tuple[Path, dict[str, Any], pa.Table]:
    """Make the missing parts, then join and summarise them.

    :param out: the folder; None creates a new one.
    :param console: for progress (standard error).
    :param say: for remarks.
    :returns: the folder, the content of ``summary.json``, and the rows of ``results.parquet``.
    :raises InputError: the folder cannot be used, or the law has failed.
    :raises Stopped: workers or parts were lost, or the record can no longer be written.
    """

    def check(path: Path) -> None:
        check_same(path / MANIFEST, "study", read_manifest(path)[0], plan.identity)

    def read(file: Path, chunk: Chunk) -> pa.Table:
        return read_part(file, origin_of(plan, chunk), chunk, plan.judging)

    with locked(out, (plan.scenario.name, "learn"), "study", MANIFEST, _manifest(plan), check) as path:
        folder = PartsFolder(path, list(plan.chunks()), read)

        def finish() -> tuple[dict[str, Any], pa.Table]:
            table = pa.concat_tables([folder.read(chunk).replace_schema_metadata() for chunk in plan.chunks()])
            folder.write(Path(RESULTS), file_bytes(table, plan.sha256))
            found = summary(plan, table)
            folder.write_summary(found)
            return found, table

        found, table = completed(folder, partial(task_of, plan), engine, console, say, "railhil learn", finish)
    return path, found, table
