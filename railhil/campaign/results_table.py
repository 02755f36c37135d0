"""The table of runs: one row per run, the same columns in every part and in ``results.parquet``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from railhil.judge.criteria import Criterion, with_sign
from railhil.judge.judging import Judging

_COUNTS = ("wraps", "saturations", "zero_divisions")


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
            *(pa.field(name, pa.int64(), nullable=False) for name in _COUNTS),
            pa.field("failures", pa.list_(pa.string()), nullable=False),
            pa.field("notch_digest", pa.string(), nullable=False),
            # The parameters of the law were tuned or chosen on a run with this seed.
            pa.field("training", pa.bool_(), nullable=False),
        ]
    )


#: Metadata key that identifies the part and campaign of a file.
_ORIGIN = b"railhil.campaign"


def table_of(label: str, result: Any, training: Sequence[int], judging: Judging) -> pa.Table:
    """Table of the runs of one chunk.

    :param result: a ``railhil.batch.BatchResult``.
    :param training: seeds on which the parameters were tuned or chosen.
    """
    seeds = np.asarray(result.seed, dtype=np.int64)
    columns: dict[str, Any] = {
        "law": [label] * len(seeds),
        "seed": seeds,
        "verdict": ["PASS" if passed else "FAIL" for passed in result.passed],
        "ended": [str(ended) for ended in result.ended],
        "failures": [list(texts) for texts in result.failures],
        "notch_digest": [str(digest) for digest in result.notch_digest],
        "training": np.isin(seeds, list(training)),
    }
    columns |= {name: np.asarray(getattr(result, name), dtype=np.int64) for name in _COUNTS}
    found = {criterion.key: result.values[criterion.key] for criterion in judging.criteria}
    found |= {name: result.signed[key] for name, key in signed_columns(judging.criteria).items()}
    # A missing value is null, not NaN, so that every tool leaves it out of averages.
    columns |= {
        name: pa.array(np.asarray(values, dtype=float), from_pandas=True)
        for name, values in (found | dict(result.extras)).items()
    }
    return pa.table(columns, schema=schema(judging))


def file_bytes(table: pa.Table, origin: str) -> bytes:
    """The table as a Parquet file with checksums; the same bytes for the same rows, however they were collected."""
    buffer = BytesIO()
    whole = table.combine_chunks().replace_schema_metadata({_ORIGIN: origin.encode()})
    pq.write_table(whole, buffer, compression="zstd", write_page_checksum=True)
    return buffer.getvalue()


class NotThePart(Exception):
    """The content of a file does not match its name; the text says why."""


def read_table(path: Path, columns: pa.Schema) -> pa.Table:
    """A table of runs with these columns. Raises :class:`NotThePart`, OSError."""
    content = path.read_bytes()
    try:
        table = pq.read_table(BytesIO(content), page_checksum_verification=True)
    except (pa.ArrowException, OSError) as error:
        raise NotThePart("torn or damaged") from error
    if not table.schema.remove_metadata().equals(columns):
        raise NotThePart("with other columns")
    return table


def origin_in(table: pa.Table) -> str:
    """The origin that the file of a table was written with."""
    return str((table.schema.metadata or {}).get(_ORIGIN, b"").decode(errors="replace"))


def read_part(path: Path, origin: str, label: str, seeds: range, judging: Judging) -> pa.Table:
    """A part written by a campaign.

    :raises NotThePart: incomplete, damaged, or with other runs.
    :raises OSError: it cannot be read at all.
    """
    table = read_table(path, schema(judging))
    if origin_in(table) != origin:
        raise NotThePart("of other runs")
    if table.num_rows != len(seeds) or not np.array_equal(table["seed"].to_numpy(), np.arange(seeds.start, seeds.stop)):
        raise NotThePart("with other seeds")
    if set(table["law"].to_pylist()) != {label}:
        raise NotThePart("of another law")
    return table


def read_results(path: Path, judging: Judging) -> pa.Table:
    """``results.parquet`` of a finished campaign. Raises OSError, :class:`NotThePart`."""
    return read_table(path, schema(judging))


def numbers(table: pa.Table, name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    """A column as float64, NaN where it is null."""
    column: np.ndarray[Any, np.dtype[np.float64]] = table[name].to_numpy(zero_copy_only=False).astype(np.float64)
    return column


def column_of(criterion: Criterion) -> str:
    """Column of the value with its sign, or of the value itself where it has none."""
    return criterion.key if criterion.signed is None else f"signed_{criterion.signed}"


def rows_of(table: pa.Table, label: str) -> pa.Table:
    """The runs of one law, in the order of their seeds."""
    return table.filter(pc.equal(table["law"], label))


def row(table: pa.Table, index: int) -> Mapping[str, Any]:
    """One run as a mapping of its columns."""
    found: Mapping[str, Any] = table.slice(index, 1).to_pylist()[0]
    return found
