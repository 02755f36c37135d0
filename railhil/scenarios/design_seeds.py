"""On which runs the own parameters of a law were chosen, so that it is not evaluated on them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cache

from railhil.common.errors import InputError
from railhil.scenarios.load import load_any
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.stored import content_sha256


def chosen_on(design_seeds: Mapping[str, Collection[int]], scenario: AnyScenario, seeds: Collection[int]) -> list[int]:
    """Those of the seeds, in order, on which parameters were chosen in this scenario.

    A scenario is the same if it has the name, whatever was set in it, or if its runs are the same under another name: a
    file that only extends it, or a copy.

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
