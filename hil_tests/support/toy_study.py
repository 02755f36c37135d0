"""A study whose runs cost nothing: the squares of its seeds."""

from __future__ import annotations

import io
import json
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pyarrow as pa
from rich.console import Console

from railhil.record.hash_list import HASH_LIST
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.study.execute import Outcome, execute
from railhil.study.finished import Verified, differences
from railhil.study.plan import Shard, Study
from railhil.study.table import NotThePart, row

T = TypeVar("T")
R = TypeVar("R")
SCHEMA = pa.schema([pa.field("seed", pa.int64()), pa.field("square", pa.float64())])


@dataclass(frozen=True)
class Request:
    """``code``: stands for the hash of the code."""

    runs: int = 12
    chunk: int = 1
    code: str = "mine"


@dataclass(frozen=True)
class Chunk:
    index: int
    seeds: range

    @property
    def name(self) -> str:
        return f"toy-{self.index:05d}"

    @property
    def runs(self) -> int:
        return len(self.seeds)


@dataclass(frozen=True)
class Plan:
    request: Request
    scenario: AnyScenario = field(default_factory=lambda: load_any("lvshun_tieshan"))

    @property
    def identity(self) -> dict[str, Any]:
        return asdict(self.request)

    @property
    def results_origin(self) -> str:
        return self.request.code

    def chunks(self) -> list[Chunk]:
        seeds, step = range(self.request.runs), self.request.chunk
        return [Chunk(index, seeds[start : start + step]) for index, start in enumerate(seeds[::step])]

    def origin(self, chunk: Chunk) -> str:
        return f"{self.results_origin} {chunk.name}"


@dataclass(frozen=True)
class ChunkWork:
    seeds: range
    hash: str

    def code(self) -> tuple[str, ...]:
        return (self.hash,)

    def rows(self) -> pa.Table:
        seeds = np.array(self.seeds)
        return pa.table({"seed": seeds, "square": seeds.astype(float) ** 2}, schema=SCHEMA)


def _check_rows(table: pa.Table, plan: Plan, chunk: Chunk) -> None:
    if table["seed"].to_pylist() != list(chunk.seeds):
        raise NotThePart("with other seeds")


def _repeat(plan: Plan, rows: pa.Table, place: int) -> Iterator[Verified]:
    ours = row(rows, place)
    bench = {"square": float(ours["seed"]) ** 2}
    yield Verified(f"seed {ours['seed']}", {"seed": ours["seed"]}, differences(ours, bench))


TOY: Study[Plan, Chunk] = Study(
    name="toy",
    kind="toy",
    request=Request,
    make_plan=Plan,
    columns=lambda plan: SCHEMA,
    check_rows=_check_rows,
    work=lambda plan, chunk: ChunkWork(chunk.seeds, plan.request.code),
    summary=lambda plan, table: {"runs": table.num_rows, "sum": float(np.sum(table["square"].to_numpy()))},
    items=lambda plan: plan.request.runs,
    repeat=_repeat,
    lines=lambda plan, summary, folder: [f"sum {summary['sum']:g}"],
)


def make(
    request: Request,
    folder: Path,
    shard: str | None = None,
    before_part: Callable[[int], None] = lambda count: None,
    study: Study[Plan, Chunk] = TOY,
) -> tuple[Outcome, list[str]]:
    """Run the study in this process; what came of it, and what it said.

    :param before_part: is called before each part with the number of those that this call has made.
    """

    @contextmanager
    def engine(work: Callable[[T], R], items: Sequence[T], /) -> Iterator[Iterator[tuple[int, R]]]:
        def results() -> Iterator[tuple[int, R]]:
            for place, item in enumerate(items):
                before_part(place)
                yield place, work(item)

        yield results()

    said: list[str] = []
    console = Console(file=io.StringIO())
    made = execute(
        study, Plan(request), str(folder), console, engine, said.append, None if shard is None else Shard.parse(shard)
    )
    return made, said


def contents(folder: Path) -> dict[str, bytes]:
    """All files below a folder by their names, without the time at which the study was begun and without the hash of
    the manifest that says it: no two processes begin at the same time."""
    found = {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    if manifest := found.get(TOY.manifest):
        found[TOY.manifest] = json.dumps(json.loads(manifest) | {"recorded": None}).encode()
    listed = found.get(HASH_LIST, b"").splitlines()
    return found | {HASH_LIST: b"\n".join(line for line in listed if not line.endswith(TOY.manifest.encode()))}


if __name__ == "__main__":
    # python -m hil_tests.support.toy_study FOLDER RUNS K/N: a part each 10 ms, so that there is time to kill it.
    make(Request(runs=int(sys.argv[2])), Path(sys.argv[1]), sys.argv[3], lambda count: time.sleep(0.01))
