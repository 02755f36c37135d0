"""Short runs with faults in one process, and what their records say."""

from __future__ import annotations

import csv
from collections.abc import Callable

import pytest

from hil_tests.support.short_runs import RUN_2M_TOML, RUN_72M_TOML
from railhil.bench import Result, local_run
from railhil.bus.frame import Frame
from railhil.record.framelog import read_log
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec
from railhil.wire.ato import NotchCmd, TrnSpeed

Runs = Callable[..., Result]


def runs_with_faults(tmp_path_factory: pytest.TempPathFactory) -> Runs:
    """Makes the run of 4 s (``moving``: of 24 s) with these faults, each once."""
    folder = tmp_path_factory.mktemp("scenario")
    made: dict[tuple[object, ...], Result] = {}

    def run(*faults: str, seed: int = 0, again: bool = False, moving: bool = False) -> Result:
        key = (*faults, seed, moving)
        if key not in made or again:
            path = folder / f"short_{moving}.toml"
            path.write_text(RUN_72M_TOML if moving else RUN_2M_TOML)
            scenario = load(path, (), faults)
            made[key] = local_run(scenario, tmp_path_factory.mktemp("run"), RunSpec(str(path), seed=seed))
        return made[key]

    return run


def frames(run: Result, can_id: int) -> list[tuple[float, Frame]]:
    """The frames of an identifier in the record, with their times in s."""
    assert run.log is not None
    return [(time_ns / 1e9, frame) for time_ns, frame in read_log(run.log) if frame.can_id == can_id]


def log(run: Result) -> list[tuple[float, str, str, str]]:
    """Rows of the fault log: time in s, what, before, after."""
    assert run.log is not None
    with (run.log.parent / "faults.csv").open(newline="") as stream:
        return [(int(row["time_ns"]) / 1e9, row["what"], row["before"], row["after"]) for row in csv.DictReader(stream)]


def hits(run: Result) -> list[tuple[float, str, str, str]]:
    return [row for row in log(run) if row[1] not in ("begun", "ended")]


SPEED, NOTCH = TrnSpeed.port().address, NotchCmd.port().address
