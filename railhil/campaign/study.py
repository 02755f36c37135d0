"""A campaign as a study: bounds of its requests, the work of a chunk, its runs made again on the real bench, and the
record for the engine."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pyarrow as pa

from railhil.batch.nodes import DIGITS
from railhil.campaign.plan import Chunk, Plan, Request, make_plan
from railhil.campaign.rows import check_rows, schema, signed_columns, table_of
from railhil.campaign.show import lines
from railhil.campaign.summary import summary
from railhil.common.exit_codes import FAIL, INVALID, PASS
from railhil.common.extras import need
from railhil.judge.judging import judging_of
from railhil.run.make import run_into
from railhil.scenarios.given import is_law_name
from railhil.scenarios.run_spec import RunSpec
from railhil.study.finished import Verified, differences
from railhil.study.perturbed_runs import run_seeds
from railhil.study.plan import Study, code_of
from railhil.study.table import row

_LIBRARIES = ("numpy", "numba", "pyarrow", "scipy")


@dataclass(frozen=True, slots=True)
class ChunkWork:
    """The runs of a chunk; ``training``: seeds on which the parameters were tuned or chosen."""

    chunk: Chunk
    scenario: Any
    training: tuple[int, ...]

    def code(self) -> tuple[str, ...]:
        return code_of(self.chunk.entry.law, self.scenario.system)

    def rows(self) -> pa.Table:
        entry = self.chunk.entry
        result = run_seeds(self.scenario, entry.law, list(self.chunk.seeds))
        return table_of(entry.label, result, self.training, judging_of(self.scenario))


def _work(plan: Plan, chunk: Chunk) -> ChunkWork:
    training = set(plan.training(chunk.entry))
    return ChunkWork(chunk, plan.scenario, tuple(seed for seed in chunk.seeds if seed in training))


def _explained(plan: Plan) -> Mapping[str, Any]:
    sets = {entry.label: entry.parameters for entry in plan.entries}
    given = {entry.label: entry.law.given.as_json() for entry in plan.entries if entry.law.given is not None}
    return {
        "parameters": {label: dict(one.values) for label, one in sets.items() if one is not None},
        **({"given_controllers": given} if given else {}),
        "libraries": {name: version(name) for name in _LIBRARIES},
    }


class BenchInvalid(Exception):
    """The bench gave no valid run."""

    exit_code = INVALID


def bench_run(plan: Plan, run: RunSpec) -> dict[str, Any]:
    """One run with the processes of the bench, as the columns of a campaign.

    :raises BenchInvalid: the bench gave no valid run.
    """
    with tempfile.TemporaryDirectory(prefix="railhil-") as private:
        result = run_into(Path(private) / "run", run, keep=False)
    if result.exit_code not in (PASS, FAIL):
        words = " ".join(run.words)
        raise BenchInvalid(f"the bench gave exit code {result.exit_code} for railhil run {words}: {result.line}")
    score = result.score
    if plan.batch is None or run.law.given is not None:
        digest = result.frames_sha256[:DIGITS]
    else:
        digest = plan.scenario.installed_system.part("digest")(plan.scenario, result.trace)
    return {
        **score.values,
        **score.extras,
        **{name: score.signed[key] for name, key in signed_columns(plan.criteria).items()},
        "verdict": score.verdict,
        "ended": score.ended,
        "failures": list(score.failures),
        "notch_digest": digest,
    }


def _repeat(plan: Plan, rows: pa.Table, place: int) -> Iterator[Verified]:
    """One run on the bench, compared to the last digit of every figure."""
    need("numba", "campaign")
    ours = row(rows, place)
    law, seed = ours["law"], ours["seed"]
    entry = next(entry for entry in plan.entries if entry.label == law)
    bench = bench_run(plan, plan.run(entry, seed))
    yield Verified(f"{law}, seed {seed}", {"law": law, "seed": seed}, differences(ours, bench))


def _controllers(request: Request, identity: Mapping[str, Any]) -> Mapping[str, Mapping[str, Any]]:
    texts = [text for text in request.laws if not is_law_name(text)]
    return dict(zip(texts, (law for law in identity["laws"] if "form" in law), strict=True))


CAMPAIGN: Study[Plan, Chunk] = Study(
    name="campaign",
    kind="campaign",
    request=Request,
    make_plan=make_plan,
    columns=lambda plan: schema(plan.judging),
    check_rows=check_rows,
    work=_work,
    summary=summary,
    explained=_explained,
    items=lambda plan: plan.request.runs * len(plan.entries),
    repeat=_repeat,
    lines=lines,
    page="railhil.campaign.report:page",
    ends_with_page=False,
    controllers=_controllers,
)
