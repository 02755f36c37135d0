"""``railhil learn`` as a study: bounds of its requests, the work of a chunk, the record for the engine, and
sequences made again through the nodes of the bench."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import pyarrow as pa

from railhil.judge.judging import judging_of
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.sequences.one import sequence, sequences, through_nodes
from railhil.sequences.plan import OWN_CODE, Chunk, Plan, Request, make_plan, run_specs
from railhil.sequences.show import lines
from railhil.sequences.summary import summary
from railhil.sequences.table import check_rows, row, schema
from railhil.study.finished import Verified, differences
from railhil.study.plan import Study, code_of
from railhil.study.table import row as row_of


@dataclass(frozen=True, slots=True)
class ChunkWork:
    """The sequences of a chunk; ``base``: any of their runs."""

    chunk: Chunk
    scenario: AnyScenario
    base: RunSpec

    def code(self) -> tuple[str, ...]:
        return code_of(self.base.law, self.scenario.system, OWN_CODE)

    def rows(self) -> pa.Table:
        scenario, chunk = self.scenario, self.chunk
        judging = judging_of(scenario)
        wanted = [run_specs(self.base, scenario, seed, chunk.runs_each) for seed in chunk.sequences]
        rows = {
            (place, number): row(chunk.sequences[place], number, run, judging)
            for place, number, run in sequences(scenario, wanted)
        }
        return pa.concat_tables([rows[key] for key in sorted(rows)])


def _repeat(plan: Plan, rows: pa.Table, place: int) -> Iterator[Verified]:
    """The runs of one sequence through the nodes, each compared to the last digit of every figure."""
    runs, seed = plan.request.runs, plan.seeds[place]
    for number, run in enumerate(sequence(plan.scenario, plan.specs(seed), through_nodes), 1):
        ours = row_of(rows, place * runs + number - 1)
        bench = row_of(row(seed, number, run, plan.judging), 0)
        which = {"sequence": seed, "run": number}
        yield Verified(f"sequence {seed}, run {number}", which, differences(ours, bench))


LEARN: Study[Plan, Chunk] = Study(
    name="learn",
    kind="study",
    request=Request,
    make_plan=make_plan,
    columns=lambda plan: schema(plan.judging),
    check_rows=check_rows,
    work=lambda plan, chunk: ChunkWork(chunk, plan.scenario, plan.base),
    summary=summary,
    items=lambda plan: len(plan.seeds),
    repeat=_repeat,
    page="railhil.sequences.report:page",
    lines=lines,
)
