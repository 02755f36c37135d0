"""Campaigns: scaling of the engines, and the overhead around the runs."""

from __future__ import annotations

import os
import subprocess
import time
from pathlib import Path
from time import process_time

from benchmarks.figures import Figure, MeasurementError, Setting
from hil_tests.support.cli import command
from hil_tests.support.dask_cluster import loopback_cluster
from railhil.batch import Case
from railhil.campaign.plan import Chunk, Plan, Request, make_plan
from railhil.campaign.rows import table_of
from railhil.campaign.study import CAMPAIGN
from railhil.study.engines import running
from railhil.study.parts import opened
from railhil.study.table import file_bytes
from railhil.study.work import run_task, task_of
from railhil.systems.ato.batch import run_batch

TITLE = "campaign"
METHOD = (
    "Law ipfc in float64, perturbed runs in chunks of 500. Rate of an engine: runs per wall second of all chunks, "
    "after the same chunks once before, which load the plant and dask's workers; parts are made, handed to the parent "
    "and not written. Frame: CPU time besides the runs themselves. Memory: peak resident set of a whole command. "
    "MB = 10^6 bytes."
)
_WORKERS = 2


def _rate(plan: Plan, engine: str, workers: int, scheduler: str | None = None) -> float:
    """Runs per wall second.

    :raises MeasurementError: a part is missing.
    """
    tasks = [task_of(CAMPAIGN, plan, one) for one in plan.chunks()]
    runs = {chunk.name: chunk.runs for chunk in plan.chunks()}
    with running(engine, lambda sentence: None, workers, scheduler) as start:
        # Workers of dask start here, and the plant is compiled.
        with start(run_task, tasks) as made:
            for _ in made:
                pass
        start_s = time.perf_counter()
        with start(run_task, tasks) as made:
            left_out = set(runs) - {name for _, (name, _) in made}
        taken_s = time.perf_counter() - start_s
    if left_out:
        raise MeasurementError(f"campaign: {engine} has left {len(left_out)} chunks out")
    return sum(runs.values()) / taken_s


def _frame(plan: Plan, chunk: Chunk, folder: Path) -> list[Figure]:
    """CPU time of a part excluding its runs, and of the end of a campaign, per run."""
    case = Case(plan.scenario, chunk.entry.law)
    start_s = process_time()
    result = run_batch(case, list(chunk.seeds))
    runs_s, start_s = process_time() - start_s, process_time()
    content = file_bytes(table_of(chunk.entry.label, result, (), plan.judging), plan.origin(chunk))
    part_s = process_time() - start_s
    with opened(CAMPAIGN, plan, str(folder)) as campaign:
        start_s = time.perf_counter()
        campaign.write_part(chunk.name, content)
        write_s = time.perf_counter() - start_s
        start_s = process_time()
        table, _ = campaign.write_results()
        end_s = process_time() - start_s
    share = part_s / (runs_s + part_s)
    return [
        Figure("frame: rows and file of a part, per run", part_s / chunk.runs * 1e6, "us", share, "of its CPU time"),
        Figure("frame: part on the disk, wall, per run", write_s / chunk.runs * 1e6, "us"),
        Figure("frame: results and statistics, per run", end_s / chunk.runs * 1e6, "us"),
        Figure("results in memory, 1000 runs", table.nbytes / chunk.runs * 1e-3, "MB"),
        Figure("results on the disk, 1000 runs", len(content) / chunk.runs * 1e-3, "MB"),
    ]


def _peak_mb(setting: Setting, runs: int) -> float:
    """Peak resident set of a campaign in one process.

    :raises MeasurementError: it failed.
    """
    words = ["campaign", setting.scenario_name, "--runs", str(runs), "--out", str(setting.folder / "memory")]
    process = subprocess.Popen(command(*words), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise MeasurementError(f"campaign: exit code {process.returncode}")
    return usage.ru_maxrss * 1024 / 1e6


def measure(setting: Setting) -> list[Figure]:
    """Rates of the engines, overhead, memory."""
    chunks = setting.count(8, 4)
    chunk = setting.count(500, 5)
    plan = make_plan(Request(scenario=setting.scenario_name, runs=chunks * chunk, chunk=chunk))
    alone = _rate(plan, "batch", 1)
    figures = [Figure("batch: one process", alone, "runs/s")]
    cores = _rate(plan, "processes", _WORKERS)
    figures.append(Figure(f"processes: {_WORKERS}", cores, "runs/s", cores / alone, "to one process"))
    with loopback_cluster(_WORKERS) as cluster:
        machines = _rate(plan, "dask", _WORKERS, cluster.scheduler_address)
    figures.append(Figure(f"dask: {_WORKERS} workers", machines, "runs/s", machines / alone, "to one process"))
    part = make_plan(Request(scenario=setting.scenario_name, runs=chunk, chunk=chunk))
    (only,) = part.chunks()
    figures += _frame(part, only, setting.folder / "frame")
    peak_mb = _peak_mb(setting, chunks * chunk)
    return [*figures, Figure(f"one process, {chunks * chunk} runs: peak resident set", peak_mb, "MB")]
