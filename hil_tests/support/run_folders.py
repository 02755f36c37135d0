"""Folders of runs: documents written without making the run, and two short runs that are made."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from hil_tests.support.cli import Railhil
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.judge.events.event import COLUMNS, EVENTS
from railhil.record.documents import CERTIFICATE, SCORE
from railhil.record.hash_list import HASH_LIST, HASH_LIST_KEY, write_hash_list

_EVENTS = ("0.1173,,plant,milestone,,departed,1,0.0,", "195.98,,plant,milestone,,stopped,1,2940.0,")


def write_run(
    folder: Path,
    law: str = "ipfc",
    verdict: str = "PASS",
    seed: int = 0,
    scores: Mapping[str, float] | None = None,
    requirements: Sequence[Mapping[str, Any]] = (),
    **certified: Any,
) -> Path:
    """Certificate, score, events and hashes of a run, as far as an index reads them.

    :param scores: without signs. :param certified: further keys of the certificate, or others than usual.
    """
    folder.mkdir(parents=True, exist_ok=True)
    run = {"scenario": "lvshun_tieshan", "controller": law, "seed": seed, "settings": [], "faults": []}
    certificate = {
        **run, "railhil": "0.2.0", "system": "ato", "arithmetic": "iq", "verdict": verdict,
        "line": "" if verdict == "PASS" else "stop error +0.4 m, allowed +-0.3 m", "orders": [], "injected": [],
        "command": f"railhil run lvshun_tieshan --controller {law} --seed {seed}", HASH_LIST_KEY: HASH_LIST,
        **certified,
    }  # fmt: skip
    found = {"stop_error_m": 0.1, "energy_kj": 74000.0} if scores is None else dict(scores)
    score = {
        "verdict": verdict, "scores": found, "signed": {"stop_error_m": -found.get("stop_error_m", 0.0)}, "why": "",
        "ended": "stopped", "telemetry": None, "requirements": list(requirements),
        "run": {**run, "sim_time_s": 195.98, "wall_time_s": 2.0, "speed_factor": 98.0},
    }  # fmt: skip
    (folder / EVENTS).write_text("\n".join([",".join(COLUMNS), *_EVENTS]) + "\n")
    (folder / SCORE).write_text(json.dumps(score))
    (folder / CERTIFICATE).write_text(json.dumps(certificate))
    write_hash_list(folder)
    return folder


def record_two_runs(here: Railhil, folder: Path) -> None:
    """Record a short journey with the seeds 0 and 1 in ``folder/runs/0`` and ``folder/runs/1``."""
    (folder / "short.toml").write_text(RUN_2M_TOML)
    for seed in "01":
        place = folder / "runs" / seed
        here("run", folder / "short.toml", "--bus", "local", "--no-report", "--seed", seed, "--out", place)
