"""Decides whether a run counts as an evaluation of its controller: it does not if the parameters were chosen on that
same run."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cache

from railhil.common.errors import InputError, Words
from railhil.record.telemetry import LawOrigin
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.parameters import OTHER_SEEDS
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.scenario_documents import content_sha256


def chosen_on(design_seeds: Mapping[str, Collection[int]], scenario: AnyScenario, seeds: Collection[int]) -> list[int]:
    """The given seeds on which parameters were chosen in this scenario, in order.

    A scenario is the same if it has the name, with any settings, or if its runs are the same under another name: a file
    that only extends it, or a copy.

    :param design_seeds: the law's declaration: name of a scenario, seeds.
    """
    found: set[int] = set()
    for name, chosen in design_seeds.items():
        seen = [seed for seed in chosen if seed in seeds]
        if seen and (name == scenario.name or content_sha256(scenario) == _content_of(name)):
            found.update(seen)
    return sorted(found)


@cache
def _content_of(name: str) -> str | None:
    """Content of a scenario that a law names; None if it is not there."""
    try:
        return content_sha256(load_any(name))
    except InputError:
        return None


def seed_was_trained(scenario: AnyScenario, run: RunSpec, origin: LawOrigin | None) -> bool | None:
    """True when the parameters were tuned, or the law's own parameters were designed, on this run.

    Nominal runs count in a system whose plant makes the same draws in every run.

    :param origin: the law's declaration about its own parameters; None if unknown.
    :returns: None if unknown, because the controller has not declared the origin of its own parameters.
    """
    if not (run.perturbed or scenario.every_run_is_drawn):
        return False
    if run.law.parameters is not None and run.law.parameters.find_seen([run.seed]):
        return True
    if origin is None:
        return None
    # Also with a parameter file: parameters that it does not name keep the law's own values.
    return bool(chosen_on(origin.design_seeds, scenario, [run.seed]))


def check_unseen(scenario: AnyScenario, run: RunSpec, origin: LawOrigin | None = None) -> None:
    """Refuse to evaluate parameters on a run that was used to find them.

    :param origin: as above.
    :raises InputError: they were.
    """
    if not seed_was_trained(scenario, run, origin):
        return
    if run.law.parameters is not None:
        run.law.parameters.check_unseen([run.seed])
    chosen = "" if origin is None else f" ({origin.text})"
    found = Words(f"seed {run.seed}, on which {run.law.controller}'s own parameters were chosen{chosen}")
    raise InputError("command line", "--seed", found, OTHER_SEEDS)
