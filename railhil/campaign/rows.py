"""The rows of a campaign: one per run, the same columns in every part and in ``results.parquet``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from railhil.campaign.plan import Chunk, Plan
from railhil.judge.criteria import Criterion, with_sign
from railhil.judge.judging import Judging
from railhil.judge.result import COUNTS
from railhil.study.table import NotThePart


def signed_columns(criteria: Sequence[Criterion]) -> dict[str, str]:
    """Column -> key of the value with its sign."""
    return {f"signed_{key}": key for key in with_sign(criteria)}


def schema(judging: Judging) -> pa.Schema:
    """Columns of the runs of a system."""
    # Numbers that may be missing: null in the file (no stop, no stop error).
    scores = (*(criterion.key for criterion in judging.criteria), *signed_columns(judging.criteria))
    numbers = (*scores, *(extra.key for extra in judging.extras))
    return pa.schema(
        [
            pa.field("law", pa.string(), nullable=False),
            pa.field("seed", pa.int64(), nullable=False),
            pa.field("verdict", pa.string(), nullable=False),
            pa.field("ended", pa.string(), nullable=False),
            *(pa.field(name, pa.float64()) for name in numbers),
            *(pa.field(one.key, pa.string()) for one in judging.noted),
            *(pa.field(one.value_key, pa.float64()) for one in judging.noted),
            *(pa.field(name, pa.int64(), nullable=False) for name in COUNTS),
            pa.field("failures", pa.list_(pa.string()), nullable=False),
            pa.field("notch_digest", pa.string(), nullable=False),
            # The parameters of the law were tuned or chosen on a run with this seed.
            pa.field("training", pa.bool_(), nullable=False),
        ]
    )


def table_of(label: str, result: Any, training: Sequence[int], judging: Judging) -> pa.Table:
    """Table of the runs of one chunk.

    :param result: a ``railhil.batch.Batch``.
    :param training: seeds on which the parameters were tuned or chosen.
    """
    seeds = np.asarray(result.seed, dtype=np.int64)
    columns: dict[str, Any] = {
        "law": [label] * len(seeds),
        "seed": seeds,
        "verdict": list(result.verdicts),
        "ended": [str(ended) for ended in result.ended],
        "failures": [list(texts) for texts in result.failures],
        "notch_digest": [str(digest) for digest in result.digest],
        "training": np.isin(seeds, list(training)),
    }
    columns |= {name: np.asarray(getattr(result, name), dtype=np.int64) for name in COUNTS}
    found = {criterion.key: result.values[criterion.key] for criterion in judging.criteria}
    found |= {name: result.signed[key] for name, key in signed_columns(judging.criteria).items()}
    # A missing value is null, not NaN, so that every tool leaves it out of averages.
    columns |= {
        name: pa.array(np.asarray(values, dtype=float), from_pandas=True)
        for name, values in (found | dict(result.extras)).items()
    }
    for one in judging.noted:
        noted = [one.of(score) or (None, None) for score in result.scores]
        columns |= {key: [row[place] for row in noted] for place, key in enumerate((one.key, one.value_key))}
    return pa.table(columns, schema=schema(judging))


def check_rows(table: pa.Table, plan: Plan, chunk: Chunk) -> None:
    """Refuse the rows of another chunk. Raises :class:`NotThePart`."""
    seeds = np.arange(chunk.seeds.start, chunk.seeds.stop)
    if table.num_rows != len(seeds) or not np.array_equal(table["seed"].to_numpy(), seeds):
        raise NotThePart("with other seeds")
    if set(table["law"].to_pylist()) != {chunk.entry.label}:
        raise NotThePart("of another law")


def column_of(criterion: Criterion) -> str:
    """Column of the value with its sign, or of the value itself where it has none."""
    return criterion.key if criterion.signed is None else f"signed_{criterion.signed}"


def rows_of(table: pa.Table, label: str) -> pa.Table:
    """The runs of one law, in the order of their seeds."""
    return table.filter(pc.equal(table["law"], label))
