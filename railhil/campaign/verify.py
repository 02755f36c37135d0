"""Repeats some runs of a campaign on the real bench: notch sequence and scores must be the same."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from railhil.batch.nodes import DIGITS
from railhil.campaign.plan import Plan
from railhil.campaign.rows import signed_columns
from railhil.campaign.study import CAMPAIGN
from railhil.common.exit_codes import FAIL, INVALID, PASS
from railhil.record.framelog import log_sha256
from railhil.record.log_trace import trace_of_log
from railhil.scenarios.run_spec import RunSpec
from railhil.study.finished import Verified, differences, finished_rows
from railhil.study.table import row


class BenchInvalid(Exception):
    """The bench gave no valid run."""

    exit_code = INVALID


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
            system = plan.scenario.installed_system
            digest = system.part("digest")(plan.scenario, trace_of_log(log, system.contract))
    return {
        **found["scores"],
        **{extra.key: found[extra.key] for extra in plan.judging.extras},
        **{name: found["signed"][key] for name, key in signed_columns(plan.criteria).items()},
        **{name: found[name] for name in ("verdict", "ended", "failures")},
        "notch_digest": digest,
    }


def verify(plan: Plan, folder: Path, runs: int, draw: int) -> Iterator[Verified]:
    """Run some of a campaign's runs on the bench and compare every figure to the last digit.

    :param plan: of the campaign in the folder.
    :param runs: their number, over all laws.
    :param draw: seed of the choice.
    :raises InputError: the folder has no finished campaign.
    """
    results = finished_rows(CAMPAIGN, plan, folder)
    entries = {entry.label: entry for entry in plan.entries}
    for index in np.random.default_rng(draw).permutation(results.num_rows)[:runs]:
        ours = row(results, int(index))
        bench = bench_run(plan, plan.run(entries[ours["law"]], ours["seed"]))
        which = {"law": ours["law"], "seed": ours["seed"]}
        yield Verified(f"{ours['law']}, seed {ours['seed']}", which, differences(ours, bench))
