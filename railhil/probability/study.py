"""A probability as a study: the rows of its repetitions, its summary, rare runs made again on the bench."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pyarrow as pa
from rich.console import Console

from railhil.batch.statistics import CONFIDENCE, share_of
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import FAIL, INVALID, PASS
from railhil.probability.causes import Sums, noise_share
from railhil.probability.interval import Probability, from_count, from_repetitions, repetitions_for, runs_for
from railhil.probability.least import with_least
from railhil.probability.limit_state import LimitState
from railhil.probability.plan import BRUTE, OWN_CODE, SUBSET, Chunk, Design, Plan, Request, make_plan
from railhil.probability.sampling import Estimate, Floats, Points, draw_points, estimate_side
from railhil.probability.show import lines
from railhil.record.documents import SUMMARY
from railhil.scenarios.scenario_documents import any_judged_sha256
from railhil.study.engines import Engine, Say
from railhil.study.execute import Outcome, execute
from railhil.study.finished import Verified, differences
from railhil.study.plan import Study, bench_sha256, code_of
from railhil.study.table import NotThePart, row

_NUMBERS = pa.list_(pa.float64())
SCHEMA = pa.schema(
    [
        pa.field("repetition", pa.int64(), nullable=False),
        pa.field("side", pa.string(), nullable=False),
        pa.field("p", pa.float64(), nullable=False),
        # Of the points below each bound of the pilot.
        pa.field("shares", _NUMBERS, nullable=False),
        pa.field("runs", pa.int64(), nullable=False),
        pa.field("proposed", pa.int64(), nullable=False),
        pa.field("accepted", pa.int64(), nullable=False),
        # Runs that say nothing about the requirement.
        pa.field("silent", pa.int64(), nullable=False),
        # Failing runs: their number, the sum of the squares of each draw, and the one with the least draws.
        pa.field("failing", pa.int64(), nullable=False),
        pa.field("squares", _NUMBERS, nullable=False),
        pa.field("least_margin", pa.float64()),
        pa.field("least_draws", _NUMBERS, nullable=False),
        pa.field("least_seeds", pa.list_(pa.int64()), nullable=False),
        pa.field("least_weights", _NUMBERS, nullable=False),
        # Of the plain runs of the first side: sums for the causes; with new noise in the first repetition.
        pa.field("sums", _NUMBERS, nullable=False),
        pa.field("bins", _NUMBERS, nullable=False),
        pa.field("noise_share", pa.float64()),
    ]
)


@dataclass(frozen=True, slots=True)
class ChunkWork:
    """One repetition, and what the pilot has fixed."""

    plan: Plan
    design: Design
    index: int

    def code(self) -> tuple[str, ...]:
        return code_of(self.plan.bench.base.law, self.plan.scenario.system, OWN_CODE)

    def rows(self) -> pa.Table:
        plan, state = self.plan, LimitState(self.plan.bench, self.plan.scenario)
        random = plan.repetition_random(self.index)
        count = plan.request.points if self.design.levels else self.design.repetition_runs
        plain = draw_points(count, len(state.names), True, random)
        known = state(plain)
        rows = []
        if not self.design.levels:
            hits = np.asarray((known < 0).any(axis=1))
            found = Estimate((float(hits.mean()),), 0, 0, 0, plain.take(hits), known[hits].min(axis=1))
            rows.append(_row(self.index, "", found, count, state))
        for side, levels in enumerate(self.design.levels):
            found = estimate_side(state, side, levels, plain, known, count, random)
            made = found.runs + (0 if side else count)
            rows.append(_row(self.index, plan.bench.sides[side].says, found, made, state))
        sums = Sums.of(plain.draws, known[:, 0])
        rows[0] |= {"sums": sums.all.tolist(), "bins": sums.bins.ravel().tolist()}
        if self.index == 0:
            again = draw_points(count, len(state.names), True, random)
            frozen = state(Points(plain.draws, again.seeds, again.weights))
            rows[0]["noise_share"] = noise_share(known[:, 0], frozen[:, 0])
            rows[0]["runs"] += count
        rows[-1]["silent"] = state.silent
        return pa.Table.from_pylist(rows, schema=SCHEMA)


def _row(index: int, side: str, found: Estimate, runs: int, state: LimitState) -> dict[str, Any]:
    failing = found.failing
    least = int(np.argmin((failing.draws**2).sum(axis=1))) if len(failing) else None
    (chain,) = failing.take(np.array([least])).chains() if least is not None else ([],)
    return {
        "repetition": index,
        "side": side,
        "p": found.p,
        "shares": list(found.shares),
        "runs": runs,
        "proposed": found.proposed,
        "accepted": found.accepted,
        "silent": 0,
        "failing": len(failing),
        "squares": (failing.draws**2).sum(axis=0).tolist(),
        "least_margin": None if least is None else float(found.margins[least]),
        "least_draws": [] if least is None else state.whole_draws(failing)[least].tolist(),
        "least_seeds": [seed for seed, _ in chain],
        "least_weights": [weight for _, weight in chain],
        "sums": [],
        "bins": [],
        "noise_share": None,
    }


def _check_rows(table: pa.Table, plan: Plan, chunk: Chunk) -> None:
    if table["repetition"].to_pylist() != [chunk.index] * chunk.runs:
        raise NotThePart("with another repetition")


def estimates_of(plan: Plan, rows: Sequence[Mapping[str, Any]]) -> list[float]:
    """The estimate of each repetition, its sides added."""
    found = dict.fromkeys((one["repetition"] for one in rows), 0.0)
    for one in rows:
        found[one["repetition"]] += one["p"]
    return list(found.values())


def probability_of(plan: Plan, rows: Sequence[Mapping[str, Any]]) -> Probability:
    """The probability with its interval."""
    if plan.design.levels:
        return from_repetitions(estimates_of(plan, rows))
    return from_count(share_of(sum(one["failing"] for one in rows), plan.design.repetition_runs * len(rows)))


def summary(plan: Plan, table: pa.Table) -> dict[str, Any]:
    """``summary.json``, without the least disturbance."""
    rows = table.to_pylist()
    design, found = plan.design, probability_of(plan, rows)
    is_found = found.p > 0 and found.accuracy < np.inf
    return {
        "scenario": plan.scenario.name,
        "scenario_sha256": any_judged_sha256(plan.scenario),
        "law": plan.bench.base.law.label,
        **plan.bench.base.law.how,
        "requirement": plan.requirement.as_json(),
        "p": found.p,
        "low": found.low if is_found else None,
        "high": found.high if is_found else None,
        "level": CONFIDENCE,
        "accuracy": found.accuracy if is_found else None,
        "is_resolved": is_found and found.accuracy <= plan.request.accuracy,
        "unresolved_below": _unresolved_below(design, rows),
        "method": SUBSET if design.levels else BRUTE,
        "repetitions": estimates_of(plan, rows) if design.levels else [],
        "sides": [side.says for side in plan.bench.sides],
        "levels": _levels(plan, rows),
        "runs": design.runs + sum(one["runs"] for one in rows),
        "runs_brute_equivalent": runs_for(found.p, found.accuracy) if is_found else None,
        "silent": sum(one["silent"] for one in rows),
        "accepted": _ratio(rows, "accepted", "proposed"),
        "causes": _causes(plan, rows),
        "draws_over": list(plan.state.names),
        "seed": plan.request.seed,
        "at_most": plan.request.at_most,
        "code_sha256": bench_sha256(),
    }


def _unresolved_below(design: Design, rows: Sequence[Mapping[str, Any]]) -> float:
    """About the least probability that these runs could have shown: one point of the last level that was reached."""
    if not design.levels:
        return 1 / (design.repetition_runs * len(rows))
    reached = [float(np.prod([share for share in one["shares"] if share])) for one in rows]
    points: int = max(1, round(sum(one["runs"] for one in rows) / sum(len(one["shares"]) for one in rows)))
    return min(reached) / points


def _ratio(rows: Sequence[Mapping[str, Any]], part: str, whole: str) -> float | None:
    total: float = sum(one[whole] for one in rows)
    return float(sum(one[part] for one in rows) / total) if total else None


def _levels(plan: Plan, rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The bounds of each side, with the mean share of the repetitions below each of them."""
    found = []
    for side, levels in zip(plan.bench.sides, plan.design.levels, strict=False):
        shares = [one["shares"] for one in rows if one["side"] == side.says]
        for place, level in enumerate(levels):
            own = [one[place] for one in shares if len(one) > place]
            mean = float(np.mean(own)) if own else 0.0
            # The last share is that of the event, also where the pilot has not come to it.
            bound = level.bound if level is not levels[-1] else 0.0
            found.append({"side": side.says, "bound": bound, "share": mean})
    return found


def _causes(plan: Plan, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """For each draw its share of the variance of the signed margin and the mean of its square in failing runs (1 in all
    runs); the share that noise has."""
    names = plan.state.names
    parts = [one for one in rows if one["sums"]]
    sums = Sums(np.sum([one["sums"] for one in parts], axis=0), np.sum([one["bins"] for one in parts], axis=0))
    shares = Sums(sums.all, sums.bins.reshape(2, len(names), -1)).shares()
    failing = sum(one["failing"] for one in rows)
    squares: Floats = np.sum([one["squares"] for one in rows], axis=0)
    return {
        "of": plan.bench.sides[0].says,
        "draws": {
            name: {"share": share, "squares_in_failures": float(squares[place] / failing) if failing else None}
            for place, (name, share) in enumerate(zip(names, shares, strict=True))
        },
        "noise": rows[0]["noise_share"],
    }


def _repeat(plan: Plan, rows: pa.Table, place: int) -> Iterator[Verified]:
    """The least failing run of a row, run through the nodes."""
    ours = row(rows, place)
    if ours["least_margin"] is None:
        return
    noise = list(zip(ours["least_seeds"], ours["least_weights"], strict=True))
    result = plan.bench.run(ours["least_draws"], noise)
    says = [side.says for side in plan.bench.sides]
    margins = plan.bench.margins_of(result)
    margin = margins[says.index(ours["side"])] if ours["side"] else min(margins)
    name = f"repetition {ours['repetition']} {ours['side']}".strip()
    document = {"repetition": ours["repetition"], "side": ours["side"], "frames_sha256": result.frames_sha256}
    yield Verified(name, document, differences({"margin": ours["least_margin"]}, {"margin": margin}))


def _complete(plan: Plan, made: Outcome, engine: Engine, say: Say) -> Outcome:
    """More repetitions until the accuracy is met or the greatest number of runs is reached; then the least
    disturbance."""
    while True:
        assert made.table is not None
        rows = made.table.to_pylist()
        found, most, have = probability_of(plan, rows), plan.most_repetitions, plan.repetitions
        if found.accuracy <= plan.request.accuracy or have >= most or not found.p:
            return with_least(plan, made, rows)
        plan = plan.grown(min(most, repetitions_for(have, found.accuracy, plan.request.accuracy)))
        say(f"the interval is +-{found.accuracy:.0%} of P, wanted {plan.request.accuracy:.0%}")
        made = execute(PROBABILITY, plan, str(made.folder), Console(quiet=True), engine, say)


def exit_code(plan: Plan, made: Outcome) -> int:
    """0: the accuracy is met; 1: the bound of ``--at-most`` lies below the interval; 3: not resolved."""
    low, high = made.summary["low"], made.summary["high"]
    if low is not None and low > plan.request.at_most:
        return FAIL
    # A bound inside the interval is neither kept nor broken.
    is_decided = high is not None and high <= plan.request.at_most
    return PASS if made.summary["is_resolved"] and is_decided else INVALID


def _completed(made: Outcome) -> Outcome:
    if "least" not in made.summary:
        allowed = "the summary of a finished probability (--resume finishes it)"
        raise InputError(made.folder / SUMMARY, "least", Words("missing"), allowed)
    return made


PROBABILITY: Study[Plan, Chunk] = Study(
    name="probability",
    kind="probability",
    request=Request,
    make_plan=make_plan,
    columns=lambda plan: SCHEMA,
    check_rows=_check_rows,
    work=lambda plan, chunk: ChunkWork(replace(plan), plan.design, chunk.index),
    summary=summary,
    items=lambda plan: sum(chunk.runs for chunk in plan.chunks()),
    repeat=_repeat,
    page="railhil.probability.report:page",
    lines=lines,
    finish=_complete,
    completed=_completed,
    exit_code=exit_code,
    grown=lambda plan, rows: plan.grown(len(set(rows["repetition"].to_pylist()))),
    unit="repetition",
)
