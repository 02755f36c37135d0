"""``python -m railhil.sequences`` (the same as ``railhil learn``)."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from railhil.batch.nodes import kernel_of, one_by_one
from railhil.campaign.extras import need
from railhil.common.command_line import parse
from railhil.common.exit_codes import FAIL, PASS, guarded
from railhil.common.extras import install_command
from railhil.common.output import Output
from railhil.common.streams import accept_any_text, flush_output, print_json
from railhil.record.signature import check_key, sign_list
from railhil.sequences.command import arguments, check_combination, request_from
from railhil.sequences.one import runner_of, sequence_batch_of, through_nodes
from railhil.sequences.plan import Plan, Request, make_plan


def _verify(namespace: argparse.Namespace) -> int:
    from railhil.sequences.verify import code_changed, verify

    console, made, bad = Output(stderr=namespace.json), [], 0
    if code_changed(Path(namespace.verify)):
        console.say("the code has changed since then: a difference may come from that", style="bold yellow")
    for one in verify(Path(namespace.verify), namespace.sequences or 1, namespace.draw):
        made.append({"sequence": one.seed, "run": one.run, "differences": dict(one.differences)})
        bad += bool(one.differences)
        for name, (ours, theirs) in one.differences.items():
            said = f"sequence {one.seed}, run {one.run}: {name} {ours} here, {theirs} on the bench"
            console.say(said, style="red")
    if namespace.json:
        print_json(made)
    console.say(f"{len(made) - bad} of {len(made)} runs are the same on the bench")
    return FAIL if bad else PASS


def _run(namespace: argparse.Namespace) -> int:
    from railhil.campaign.engines import running
    from railhil.sequences.execute import execute, read_manifest
    from railhil.sequences.show import show
    from railhil.sequences.work import run_task

    check_key(namespace.sign)
    begun = Request() if namespace.resume is None else read_manifest(Path(namespace.resume))[1]
    plan = make_plan(request_from(namespace, begun))
    console = Console(stderr=True)

    def say(sentence: str) -> None:
        console.print(sentence, markup=False, highlight=False, soft_wrap=True)

    together = sequence_batch_of(plan.scenario) is not None
    if not together and runner_of(plan.scenario) is through_nodes:
        say(f"system {plan.scenario.system} has no runs without a bus, or not with its faults: the nodes make them all")
    elif together and (why := one_by_one(plan.scenario)):
        say(why)
    jobs = namespace.jobs or os.cpu_count() or 1
    name = "dask" if namespace.scheduler is not None else "batch" if jobs == 1 else "joblib"
    with running(
        name, jobs, namespace.scheduler, say, work=run_task, kernel=kernel_of(plan.scenario) if together else None
    ) as engine:
        folder, found, table = execute(plan, namespace.resume or namespace.out, console, engine, say)
    report = "" if namespace.no_report else _report(plan, found, table, folder)
    sign_list(folder, namespace.sign)
    if namespace.json:
        print_json(found)
    else:
        show(Output(), found, folder, report)
    return PASS


def _report(plan: Plan, found: dict[str, Any], table: Any, folder: Path) -> str:
    """The line about the report."""
    try:
        from railhil.sequences.report import report_line
    except ImportError as error:
        return f"no report: {error.name} is not installed ({install_command('report')})"
    return report_line(plan, found, table, folder)


def main(words: Sequence[str] | None = None) -> int:
    """Run, resume or verify."""
    accept_any_text()
    namespace = parse(arguments(), words)
    check_combination(namespace)
    need("pyarrow", "campaign")
    try:
        return _verify(namespace) if namespace.verify is not None else _run(namespace)
    finally:
        flush_output()


if __name__ == "__main__":
    sys.exit(guarded("railhil learn", main))
