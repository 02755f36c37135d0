"""Memories that are damaged after eight runs, and their effect on the ninth run and the next ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from railhil.common.extras import need
from railhil.reproduce.experiments import SequenceRuns
from railhil.scenarios.memory import Memory, MemoryPlace, MemoryRecord, sort_memory
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    # Needs the extra [campaign].
    from railhil.batch.case import SequenceRun

#: Number of runs before the fault, and from it on.
BEFORE, AFTER = 8, 10
#: Recovered: the first of so many runs in a row within this, m; without a fault a run is seldom outside.
RECOVERED_M, _IN_A_ROW = 0.5, 3
#: Largest offset that a law accepts, m.
_OFFSET_MAX_M = 12.0
#: Figures of each fault on the page: mean error with sign and largest error of the ninth run, largest error from it on,
#: runs until recovered, share of the runs in which the law has seen the fault.
ERROR, WORST_AT_ONCE, WORST, RECOVERED, RECOVERED_P90, SEEN = (
    "error_m", "worst_at_once_m", "worst_m", "recovered", "recovered_p90", "seen",
)  # fmt: skip

#: (memory, random numbers) -> the memory with its fault.
_Fault = Callable[[Memory, np.random.Generator], Memory]


def _newest(memory: Memory, change: Callable[[MemoryPlace], MemoryPlace]) -> Memory:
    """The memory with its best place changed."""
    first, *others = memory.stored
    return sort_memory(memory.law, [change(first), *others], memory.source)


def _damaged(one: MemoryPlace) -> MemoryPlace:
    return one.refuse("crc", "damaged")


def _with_offset(one: MemoryPlace, offset: Callable[[float], float]) -> MemoryPlace:
    """The place with other offsets and a CRC that fits them."""
    assert one.record is not None
    values = dict(one.record.values)
    values["records"] = [{**kept, "offset_m": offset(kept["offset_m"])} for kept in values["records"]]
    return replace(one, record=replace(one.record, values=values))


def _elsewhere(one: MemoryPlace) -> MemoryPlace:
    record: MemoryRecord | None = one.record
    assert record is not None
    return replace(one, record=replace(record, key=f"{record.key} elsewhere"))


#: Names of the faults as the page has them.
FAULTS: Mapping[str, _Fault] = {
    "none": lambda memory, random: memory,
    "newest record damaged": lambda memory, random: _newest(memory, _damaged),
    "newest record of another platform": lambda memory, random: _newest(memory, _elsewhere),
    "newest record with 12.5 m": lambda memory, random: _newest(memory, lambda one: _with_offset(one, lambda b: 12.5)),
    "both records damaged": lambda memory, random: sort_memory(
        memory.law, [_damaged(one) for one in memory.stored], memory.source
    ),
    "undetected: another offset within 12 m": lambda memory, random: _newest(
        memory,
        lambda one: _with_offset(one, lambda b: float(random.uniform(-_OFFSET_MAX_M, _OFFSET_MAX_M))),
    ),
    "undetected: sign of the offset": lambda memory, random: _newest(
        memory, lambda one: _with_offset(one, lambda b: -b)
    ),
}
#: Faults that no law can detect: the CRC is correct.
UNDETECTED = tuple(name for name in FAULTS if name.startswith("undetected"))
DETECTED = tuple(name for name in FAULTS if name != "none" and name not in UNDETECTED)


def name_fault_figure(fault: str, figure: str) -> str:
    """Name of a figure of a fault."""
    return f"{fault}: {figure}"


@dataclass(frozen=True, slots=True)
class MemoryFaults:
    """``count`` sequences for each fault. ``first``: seed of the first one; ``before``, ``after``: runs of each."""

    first: int
    count: int
    before: int = BEFORE
    after: int = AFTER

    def words(self, spec: RunSpec) -> list[str]:
        return []

    def make(self, spec: RunSpec, folder: Path) -> SequenceRuns:
        need("pyarrow", "campaign")
        from railhil.sequences.one import sequences
        from railhil.sequences.plan import run_specs

        scenario = spec.load()
        specs = [run_specs(spec, scenario, self.first + place, self.before + self.after) for place in range(self.count)]
        last: dict[int, SequenceRun] = {
            place: run for place, _, run in sequences(scenario, [one[: self.before] for one in specs])
        }
        memories = [last[place].left for place in range(self.count)]
        found: dict[str, float | None] = {}
        every: list[list[SequenceRun]] = []
        for fault, change in FAULTS.items():
            # The same random numbers for each fault.
            random = np.random.default_rng(self.first)
            begun = [change(memory, random) for memory in memories]
            rows: list[list[Any]] = [[] for _ in memories]
            for place, _, run in sequences(scenario, [one[self.before :] for one in specs], begun):
                rows[place].append(run)
            every += rows
            found |= {name_fault_figure(fault, name): value for name, value in _figures(rows).items()}
        return SequenceRuns(scenario, spec, every, found)


def _figures(rows: list[list[SequenceRun]]) -> dict[str, float | None]:
    """Figures of the runs after a fault."""
    from railhil.batch.statistics import at_most
    from railhil.sequences.summary import runs_to_converge

    errors = np.array([[run.score.signed["stop_error_m"] for run in row] for row in rows], dtype=np.float64)
    sizes = np.abs(errors)
    needed = runs_to_converge(sizes, RECOVERED_M, _IN_A_ROW) - 1.0
    return {
        ERROR: _known(np.mean(errors[:, 0])),
        WORST_AT_ONCE: _known(np.max(sizes[:, 0])),
        WORST: _known(np.max(sizes)),
        RECOVERED: _known(at_most(needed, 0.5)),
        RECOVERED_P90: _known(at_most(needed, 0.9)),
        SEEN: float(np.mean([row[0].kept is not None and bool(row[0].kept.refused) for row in rows])),
    }


def _known(value: Any) -> float | None:
    """A finite number, or None."""
    return float(value) if np.isfinite(value) else None
