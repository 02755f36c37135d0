"""``python -m railhil.campaign`` (the same as ``railhil campaign``)."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from railhil.batch.nodes import kernel_of, one_by_one
from railhil.campaign.command import arguments, check_combination, request_from
from railhil.campaign.extras import need
from railhil.campaign.plan import Request, make_plan
from railhil.common.command_line import parse
from railhil.common.exit_codes import FAIL, PASS, guarded
from railhil.common.output import Output
from railhil.common.streams import accept_any_text, flush_output, print_json
from railhil.record.signature import check_key, sign_list

_VERIFIED_RUNS = 3


def _verify(namespace: argparse.Namespace) -> int:
    need("numba", "campaign")
    from railhil.campaign.verify import code_changed, verify

    folder, runs = Path(namespace.verify), namespace.runs or _VERIFIED_RUNS
    console = Output()
    if code_changed(folder):
        console.say("the code has changed since the campaign: a difference may come from that", style="bold yellow")
    found = verify(folder, runs, namespace.draw)
    for one in found:
        if not one.differences:
            console.say(f"{one.law}, seed {one.seed}: the bench gives the same notches and scores")
        for name, (ours, theirs) in one.differences.items():
            console.say(
                f"{one.law}, seed {one.seed}: {name} {ours} in the campaign, {theirs} on the bench", style="red"
            )
    bad = sum(bool(one.differences) for one in found)
    console.say(f"{len(found) - bad} of {len(found)} runs are the same on the bench")
    return FAIL if bad else PASS


def _run(namespace: argparse.Namespace) -> int:
    from railhil.campaign.engines import running
    from railhil.campaign.manifest import read_manifest
    from railhil.campaign.run import execute
    from railhil.campaign.show import show

    check_key(namespace.sign)
    begun = Request() if namespace.resume is None else read_manifest(Path(namespace.resume)).request
    plan = make_plan(request_from(namespace, begun))
    console = Console(stderr=True)

    def say(sentence: str) -> None:
        console.print(sentence, markup=False, highlight=False, soft_wrap=True)

    if plan.batch is None:
        say(f"no batch of trains for system {plan.scenario.system}: every run goes through the nodes, one by one")
    elif why := one_by_one(plan.scenario):
        say(why)
    kernel = kernel_of(plan.scenario)
    with running(namespace.engine, namespace.jobs or -1, namespace.scheduler, say, kernel=kernel) as engine:
        folder, found = execute(plan, namespace.resume or namespace.out, console, engine, say)
    sign_list(folder, namespace.sign)
    if namespace.json:
        print_json(found)
    else:
        show(Output(), found, folder, plan.judging)
    return PASS


def main(words: Sequence[str] | None = None) -> int:
    """Run, resume or verify a campaign."""
    accept_any_text()
    namespace = parse(arguments(), words)
    check_combination(namespace)
    need("pyarrow", "campaign")
    try:
        return _verify(namespace) if namespace.verify is not None else _run(namespace)
    finally:
        flush_output()


if __name__ == "__main__":
    sys.exit(guarded("railhil campaign", main))
