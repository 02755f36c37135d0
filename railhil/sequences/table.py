"""The table of runs: one row per run, the same columns in every part and in ``results.parquet``."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from railhil.batch.case import Batch, SequenceRun
from railhil.campaign.rows import schema as campaign_schema
from railhil.campaign.rows import table_of
from railhil.judge.judging import Judging
from railhil.sequences.plan import Chunk, Plan
from railhil.study.table import NotThePart, numbers

#: Columns that a campaign does not have: seed of the sequence, number of the run in it, the slot that it began with,
#: slots that could not be used, hashes of the memory before and of the record after it, the record's values as JSON.
_OWN = (
    pa.field("sequence", pa.int64(), nullable=False),
    pa.field("run", pa.int64(), nullable=False),
    pa.field("memory_used", pa.string()),
    pa.field("memory_refused", pa.list_(pa.string()), nullable=False),
    pa.field("memory_before_sha256", pa.string(), nullable=False),
    pa.field("memory_after_sha256", pa.string()),
    pa.field("memory", pa.string()),
)


def schema(judging: Judging) -> pa.Schema:
    """Columns of the runs of a system."""
    return pa.schema([*_OWN, *campaign_schema(judging)])


def row(seed: int, number: int, run: SequenceRun, judging: Judging) -> pa.Table:
    """One run as a table of one row.

    :param seed: of the sequence; ``number``: of the run in it, from 1.
    """
    record, kept = run.record, run.kept
    result = Batch.of_results(run.scenario, [run.spec.seed], [run], [run.digest])
    shared = table_of(run.spec.law.controller, result, [], judging)
    own = {
        "sequence": [seed],
        "run": [number],
        "memory_used": [None if kept is None else kept.used],
        "memory_refused": [[] if kept is None else [f"{slot}: {why[0]}" for slot, why in kept.refused.items()]],
        "memory_before_sha256": [run.began.sha256],
        "memory_after_sha256": [None if record is None else record.sha256],
        "memory": [None if record is None else json.dumps(dict(record.values), sort_keys=True)],
    }
    columns = {name: pa.array(own[name], type=field.type) for name, field in ((one.name, one) for one in _OWN)}
    columns |= {name: shared[name].combine_chunks() for name in shared.column_names}
    return pa.table(columns, schema=schema(judging))


def check_rows(table: pa.Table, plan: Plan, chunk: Chunk) -> None:
    """Refuse the rows of another chunk. Raises :class:`NotThePart`."""
    wanted = [(seed, number) for seed in chunk.sequences for number in range(1, chunk.runs_each + 1)]
    if list(zip(table["sequence"].to_pylist(), table["run"].to_pylist(), strict=True)) != wanted:
        raise NotThePart("with other sequences")


def by_run(table: pa.Table, column: str, runs: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """A column as an array of shape (sequences, runs), NaN where a run has no value.

    :param runs: of each sequence.
    """
    return numbers(table, column).reshape(-1, runs)


def memories(table: pa.Table, runs: int) -> list[list[Mapping[str, Any] | None]]:
    """Values that the law has left after each run, by sequence."""
    texts: Sequence[str | None] = table["memory"].to_pylist()
    found = [None if text is None else json.loads(text) for text in texts]
    return [found[index : index + runs] for index in range(0, len(found), runs)]
