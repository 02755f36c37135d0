"""The least disturbance: of the draws that violate the requirement those nearest to nominal, as a scenario file."""

from __future__ import annotations

import json
import os
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from railhil.batch.decision import find_decision, scores_that_violate
from railhil.common.user_files import write_synced
from railhil.judge.requirements.requirement import as_toml
from railhil.judge.result import Result
from railhil.probability.plan import LEAST, LEAST_RUNS, Plan
from railhil.probability.sampling import Floats, Points
from railhil.record.documents import SUMMARY
from railhil.record.hash_list import write_hash_list
from railhil.run.local import unrecorded_run
from railhil.scenarios.run_spec import LawSpec, RunSpec
from railhil.scenarios.settings import set_words
from railhil.study.descent import descend
from railhil.study.execute import Outcome

#: Deviation of its first generation, in standard deviations of a draw.
_STEP = 0.3
#: A run that keeps the requirement counts as further away than any that violates it.
_KEPT = 1e6
#: Points on the way back to nominal.
_BACK = 200


@dataclass(frozen=True, slots=True)
class Least:
    """``draws``: in the scenario's order. ``noise``: that of the failing run from which the descent began.
    ``size``: length of the vector of draws, in standard deviations. ``runs``: that it took."""

    draws: tuple[float, ...]
    noise: tuple[tuple[int, float], ...]
    size: float
    runs: int


def find_least(plan: Plan, rows: Sequence[Mapping[str, Any]]) -> Least | None:
    """The least draws of all failing runs, made smaller by descent; the noise is not changed. None: no run has failed.

    Where each run goes through the nodes there is no descent.
    """
    failing = [one for one in rows if one["least_draws"]]
    if not failing:
        return None
    first = min(failing, key=lambda one: float(np.linalg.norm(one["least_draws"])))
    state, noise = plan.state, tuple(zip(first["least_seeds"], first["least_weights"], strict=True))
    found: Floats = np.array(first["least_draws"])[state.drawn]
    runs = 0
    if state.is_fast:
        seeds, weights = (np.array([list(values)]) for values in zip(*noise, strict=True))

        def violates(draws: Floats) -> tuple[Floats, Floats]:
            margins = state(Points(draws, seeds.repeat(len(draws), 0), weights.repeat(len(draws), 0))).min(axis=1)
            return margins < 0, margins

        def sizes(draws: Floats) -> Floats:
            is_violated, margins = violates(draws)
            return np.where(is_violated, np.linalg.norm(draws, axis=1), _KEPT + margins)

        best = descend(
            sizes,
            len(found),
            LEAST_RUNS - _BACK,
            plan.request.seed,
            start=found,
            step=_STEP,
            command="railhil probability",
        )
        if best.margin < np.linalg.norm(found):
            found = best.vector
        back = np.linspace(0.0, 1.0, _BACK + 1)[:, None] * found
        found = back[int(np.argmax(violates(back)[0]))]
        runs = best.runs + len(back)
    draws = np.zeros(len(state.all_names))
    draws[state.drawn] = found
    return Least(tuple(draws.tolist()), noise, float(np.linalg.norm(found)), runs)


def run_file(path: Path, settings: tuple[str, ...], law: LawSpec) -> Result:
    """The run of a scenario file through the nodes. Raises InputError."""
    spec = RunSpec(str(path), settings, law, bus="local")
    return unrecorded_run(spec.load(), spec)


def with_least(plan: Plan, made: Outcome, rows: Sequence[Mapping[str, Any]]) -> Outcome:
    """Write the least disturbance into the folder, run it from its file through the nodes, and enter it into the
    summary."""
    found = find_least(plan, rows)
    document: dict[str, Any] | None = None
    if found is not None:
        path = made.folder / LEAST
        write_synced(path, _file(plan, path.parent, found).encode())
        law = plan.bench.base.law
        result = run_file(path, plan.request.settings, law)
        document = {
            "size": found.size,
            "draws": list(found.draws),
            "noise": [list(one) for one in found.noise],
            "runs": found.runs,
            "sha256": result.frames_sha256,
            "margins": plan.bench.margins_of(result),
            # Without the folder: the same bytes in any.
            "options": shlex.join([*set_words(plan.request.settings), *law.words]),
            "decided": _decided(plan, path, result),
        }
    summary = {**made.summary, "least": document}
    summary["runs"] += 0 if found is None else found.runs
    write_synced(made.folder / SUMMARY, (json.dumps(summary, indent=2, allow_nan=False) + "\n").encode())
    write_hash_list(made.folder)
    return replace(made, summary=summary)


def _decided(plan: Plan, path: Path, result: Result) -> dict[str, Any]:
    """When its noise has decided that the run of a file violates the requirement."""
    spec = RunSpec(str(path), plan.request.settings, plan.bench.base.law, bus="local")

    def violates(result: Result) -> bool:
        return min(plan.bench.margins_of(result)) < 0

    scores = scores_that_violate([plan.requirement], plan.scenario)
    return asdict(find_decision(spec, result.trace.end_s, violates, scores))


def _file(plan: Plan, folder: Path, found: Least) -> str:
    """The scenario that extends the one of the study."""
    scenario = plan.request.scenario
    base = os.path.relpath(scenario, folder.resolve()) if scenario.endswith(".toml") else scenario
    named = [
        f"    {draw!r},  # {name or 'not drawn by the scenario'}"
        for draw, name in zip(found.draws, plan.state.all_names, strict=True)
    ]
    lines = [
        f"# railhil probability, seed {plan.request.seed}: least draws found ({found.size:.2f} standard deviations),",
        # A sentence may have several lines, and what ends one.
        f"# with which {plan.requirement.id} is violated: {' '.join(plan.requirement.says.split())}",
        "schema_version = 1",
        f"extends = {json.dumps(base)}",
        *("draws = [", *named, "]"),
        f"noise = {[list(one) for one in found.noise]}",
    ]
    return "\n".join(line.replace("\r", " ") for line in lines) + "\n" + as_toml([plan.requirement])
