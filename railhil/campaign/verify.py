"""Repeats some runs of a campaign on the real bench: notch sequence and scores must be the same."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from railhil.batch.nodes import DIGITS
from railhil.campaign.folder import RESULTS
from railhil.campaign.manifest import MANIFEST, read_manifest
from railhil.campaign.plan import Plan, make_plan
from railhil.campaign.results_table import NotThePart, read_results, row, signed_columns
from railhil.common.errors import InputError, Words
from railhil.common.exit_codes import FAIL, INVALID, PASS
from railhil.record.framelog import log_sha256
from railhil.record.hash_list import check_hash_list
from railhil.record.log_trace import trace_of_log
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import system_named


class BenchInvalid(Exception):
    """The bench gave no valid run."""

    exit_code = INVALID


@dataclass(frozen=True, slots=True)
class Verified:
    """One run: the differences between campaign and bench (column: campaign's value, bench's value)."""

    law: str
    seed: int
    differences: Mapping[str, tuple[Any, Any]]


def _plan(folder: Path) -> Plan:
    """The campaign's plan, made with the present installation.

    :raises InputError: scenario, parameters or laws have changed since the campaign, or a file of the folder.
    """
    begun = read_manifest(folder)
    check_hash_list(folder, MANIFEST, None)
    plan = make_plan(begun.request)
    ours = json.loads(json.dumps(plan.identity))
    for key in ("scenario_sha256", "laws", "runs", "first_seed"):
        found, wanted = (_without_code(campaign.get(key)) for campaign in (begun.campaign, ours))
        if found != wanted:
            allowed = f"{json.dumps(wanted)}, what this installation would run"
            raise InputError(folder / MANIFEST, f"campaign.{key}", Words(json.dumps(found)), allowed)
    return plan


def code_changed(folder: Path) -> bool:
    """Whether the code has changed since the campaign, so that a difference need not be a defect. Raises InputError."""
    recorded = read_manifest(folder).campaign
    ours = _plan(folder).identity
    then, now = (json.loads(json.dumps(identity)) for identity in (recorded, ours))
    return any(then.get(key) != now[key] for key in ("code_sha256", "batch_sha256", "system_sha256", "laws"))


def _without_code(value: Any) -> Any:
    """Laws without the hashes of their code."""
    if not isinstance(value, list):
        return value
    return [{key: one[key] for key in one if key != "law_sha256"} if isinstance(one, dict) else one for one in value]


def bench_run(plan: Plan, run: RunSpec) -> dict[str, Any]:
    """One run with ``railhil`` in a separate folder, as the columns of a campaign.

    :raises BenchInvalid: the bench gave no valid run.
    """
    with tempfile.TemporaryDirectory(prefix="railhil-") as private:
        folder = Path(private) / "run"
        words = ["run", *run.words]
        command = [sys.executable, "-P", "-m", "railhil.cli", *words, "--out", str(folder), "--json"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode not in (PASS, FAIL):
            complaint = " ".join(done.stderr.split()) or "no word"
            raise BenchInvalid(f"the bench gave exit code {done.returncode} for railhil {' '.join(words)}: {complaint}")
        found = json.loads((folder / "score.json").read_text(encoding="utf-8"))
        log = folder / "frames.log"
        if plan.batch is None:
            digest = log_sha256(log)[:DIGITS]
        else:
            system = system_named(plan.scenario.system)
            digest = system.part("digest")(plan.scenario, trace_of_log(log, system.contract))
    return {
        **found["scores"],
        **{extra.key: found[extra.key] for extra in plan.judging.extras},
        **{name: found["signed"][key] for name, key in signed_columns(plan.criteria).items()},
        **{name: found[name] for name in ("verdict", "ended", "failures")},
        "notch_digest": digest,
    }


def verify(folder: Path, runs: int, draw: int) -> list[Verified]:
    """Run some of a campaign's runs on the bench and compare every figure to the last digit.

    :param runs: their number, over all laws.
    :param draw: seed of the choice.
    :raises InputError: the folder has no finished campaign that can be repeated.
    """
    plan = _plan(folder)
    try:
        results = read_results(folder / RESULTS, plan.judging)
    except FileNotFoundError:
        raise InputError(folder, "", Words(f"no {RESULTS}"), "a finished campaign (--resume finishes it)") from None
    except (OSError, NotThePart) as why:
        raise InputError(folder / RESULTS, "", Words(str(why)), "what the campaign has written") from why
    entries = {entry.label: entry for entry in plan.entries}
    chosen = np.random.default_rng(draw).permutation(results.num_rows)[:runs]
    found = []
    for index in chosen:
        ours = row(results, int(index))
        bench = bench_run(plan, plan.run(entries[ours["law"]], ours["seed"]))
        apart = {name: (ours[name], theirs) for name, theirs in bench.items() if ours[name] != theirs}
        found.append(Verified(ours["law"], ours["seed"], apart))
    return found
