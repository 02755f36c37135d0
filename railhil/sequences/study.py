"""``railhil learn`` as a study: bounds of its requests, the work of a chunk, the record for the engine, and
sequences made again through the nodes of the bench."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa

from railhil.judge.judging import judging_of
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.sequences.one import sequence, sequences, through_nodes
from railhil.sequences.plan import OWN_CODE, Chunk, Plan, Request, make_plan, run_specs
from railhil.sequences.show import lines
from railhil.sequences.summary import summary
from railhil.sequences.table import check_rows, row, schema
from railhil.study.execute import Outcome
from railhil.study.finished import Verified, differences, finished_rows, finished_summary, repeated_plan
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


def _page(plan: Plan, made: Outcome, path: Path) -> None:
    from railhil.report.templates import write_html
    from railhil.sequences.report import page

    write_html(page(plan, made.summary, made.table), path)


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
    page=_page,
    lines=lines,
)


def report_of(folder: Path, out: Path) -> None:
    """Write the report of a finished study from its folder.

    :raises InputError: the study is not finished, damaged, changed, or of a scenario that has changed since.
    :raises OSError: it cannot be written.
    """
    plan, _ = repeated_plan(LEARN, folder)
    _page(plan, Outcome(folder, finished_rows(LEARN, plan, folder), finished_summary(LEARN, folder)), out)
