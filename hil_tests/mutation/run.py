"""All mutants of one module, or some, against its tests."""

from __future__ import annotations

import importlib
import os
import random
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hil_tests.mutation.install import import_changed
from hil_tests.mutation.operators import Mutant, mutants
from hil_tests.mutation.session import ColdSession, WarmSession, collected, forked, limit_process, side_by_side

#: What the sessions need and what is not ours: imported once, before the first fork.
_PRELOADED = ("pytest", "hypothesis", "numpy", "pydantic", "rich.console", "can", "cantools")
#: What needs a machine or the wall clock says nothing about a mutant.
MARKS = "not wall_clock and not needs_socketcan and not needs_docker and not needs_compiler and not needs_browser"


@dataclass
class Result:
    """Result of one module: how many mutants were tried, and those that no test noticed."""

    module: str
    count: int = 0
    alive: list[Mutant] = field(default_factory=list)
    #: Tests that fail on the unchanged module.
    failed: list[str] = field(default_factory=list)


def prepare() -> None:
    """Make this process the parent of all sessions."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    for name in _PRELOADED:
        importlib.import_module(name)


def _pytest(tests: Sequence[str], plugin: object) -> int:
    """One session, deterministic: hypothesis draws the same examples each time, and does not shrink."""
    import hypothesis
    import pytest

    phases = (hypothesis.Phase.explicit, hypothesis.Phase.generate)
    hypothesis.settings.register_profile(
        "mutation", derandomize=True, database=None, phases=phases, deadline=None,
        suppress_health_check=list(hypothesis.HealthCheck),
    )  # fmt: skip
    hypothesis.settings.load_profile("mutation")
    # The modules of the bench belong to a plugin of pytest, whose assertions pytest rewrites: it would import them from
    # their files instead of a changed tree.
    arguments = ["-qq", "-p", "no:cacheprovider", "--assert=plain", "-m", MARKS, *tests]
    return int(pytest.main(arguments, plugins=[plugin]))


def try_module(
    module: str,
    path: Path,
    tests: Sequence[str],
    *,
    jobs: int,
    chosen: Callable[[Sequence[Mutant]], Sequence[Mutant]] = lambda all_mutants: all_mutants,
) -> Result:
    """Try the mutants of a module.

    :param chosen: which of them.
    """
    tried = chosen(list(mutants(path.read_text("utf-8"))))

    def warm() -> Any:
        session = WarmSession(module, tried, jobs)
        _quietly(lambda: _pytest(tests, session))
        return session.baseline, session.cold

    found = collected(*forked(warm))
    if found is None or not found[0].seconds:
        return Result(module, len(tried), failed=[f"{' '.join(tests)}: no session (pytest {' '.join(tests)})"])
    baseline, cold = found
    if baseline.failed:
        return Result(module, len(tried), failed=baseline.failed)

    def own(mutant: Mutant) -> Callable[[], Any]:
        def work() -> bool:
            limit_process(sum(baseline.seconds.values()))
            import_changed(module, str(path), mutant.tree())
            session = ColdSession(baseline.seconds)
            return _pytest(tests, session) == 0 and session.alive

        return work

    timeout_s = 120 + 20 * sum(baseline.seconds.values())
    results = side_by_side((own(tried[place]) for place in cold), jobs, timeout_s)
    alive = sorted(place for place, survives in zip(cold, results, strict=True) if survives)
    return Result(module, len(tried), [tried[place] for place in alive])


def sample(count: int, seed: int) -> Callable[[Sequence[Mutant]], Sequence[Mutant]]:
    """Some mutants, drawn with a seed."""
    return lambda items: random.Random(seed).sample(items, min(count, len(items)))


def containing(text: str) -> Callable[[Sequence[Mutant]], Sequence[Mutant]]:
    """Mutants with a text in function or statement, before or after the change."""
    return lambda items: [item for item in items if text in item.key or text in item.before]


def _quietly(work: Callable[[], Any]) -> None:
    """pytest's own lines are not the result; what it says when it cannot start is."""
    sys.stdout.flush()
    kept = os.dup(1)
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    try:
        work()
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
