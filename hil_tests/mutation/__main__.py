"""Command of the mutation tests."""

from __future__ import annotations

import argparse
import os
import signal
import sys
from pathlib import Path

from hil_tests.mutation.install import path_of
from hil_tests.mutation.run import Result, containing, prepare, sample, try_module
from hil_tests.mutation.targets import explained, modules, tests_of


def main(arguments: list[str] | None = None) -> int:
    """Exit code 0: every mutant is noticed or explained; 1: not so, or ``--only`` names no mutant at all."""
    parser = argparse.ArgumentParser(prog="python -m hil_tests.mutation", description=__doc__)
    parser.add_argument("module", nargs="*", help="dotted names; default: all of targets.toml")
    parser.add_argument("--tests", nargs="+", metavar="FILE", help="default: those of targets.toml")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--sample", type=int, metavar="N", help="only N mutants of each module, drawn with --seed")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", metavar="TEXT", help="only mutants with this text in function or statement")
    given = parser.parse_args(arguments)
    prepare()
    good, count = True, 0
    for module in given.module or modules():
        path, tests = Path(path_of(module)), given.tests or tests_of(module)
        chosen = containing(given.only) if given.only else sample(given.sample, given.seed) if given.sample else list
        result = try_module(module, path, tests, jobs=given.jobs, chosen=chosen)
        count += result.count
        for name in result.failed:
            print(f"  fails without any change: {name}", flush=True)
        good &= not result.failed and _print(result, whole=not (given.sample or given.only))
    if good and given.only and not count:
        print(f"no mutant contains {given.only!r}")
        good = False
    return 0 if good else 1


def _print(result: Result, whole: bool) -> bool:
    """Print the mutants that survived in one module; True if all are explained."""
    known = explained(result.module)
    new = [mutant for mutant in result.alive if mutant.key not in known]
    keys = {mutant.key for mutant in result.alive}
    stale = [key for key in known if key not in keys] if whole else []
    print(
        f"{result.module}: {result.count} mutants, {result.count - len(result.alive)} noticed, "
        f"{len(result.alive) - len(new)} explained, {len(new)} not",
        flush=True,
    )
    for mutant in new:
        print(f"  line {mutant.line}: {mutant.before}\n      {mutant.key}", flush=True)
    for key in stale:
        print(f"  explained in survivors.toml, but noticed or gone: {key}", flush=True)
    return not new and not stale


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        # What it has started ends with it.
        sys.exit(128 + signal.SIGINT)
