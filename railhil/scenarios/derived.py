"""Published results and sentences that a scenario inherits from the one that it is based on.

Published results and sentences about chosen values belong to the file that gives them. If the run is another one, the
results are left out. If a file above it, or ``--set``, gives other values, the sentences name their file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from railhil.common.errors import InputError
from railhil.scenarios.layers import Layers

if TYPE_CHECKING:
    from railhil.scenarios.task import TaskScenario
    from railhil.systems.ato.scenario.model import Scenario

S = TypeVar("S", "Scenario", "TaskScenario")
_SHOWN_MAX = 6


def with_own_words(scenario: S, layers: Layers, read: Callable[[Layers], S], run: Callable[[S], object]) -> S:
    """The scenario without the published results of another run, and with sentences about what it changes.

    :param read: reads a scenario.
    :param run: the part that defines the run of published results; equal for the same run.
    """
    assumptions, published = list(scenario.assumptions), scenario.published
    of, other = layers.changes_since("assumptions")
    for section in ("train", "line"):
        # Their sentences come from the files that describe them, and are left out with these.
        _, inside = layers.changes_since(section, "assumptions")
        other += [keys for keys in inside if keys[0] == section and len(keys) > 1 and keys not in other]
    if assumptions and other:
        title = ", and the title," if layers.place("title") >= layers.place("assumptions") else ""
        assumptions.append(f"changed here: {_listed(other)}; sentences about them{title} are those of {of.stem}")
    if published and layers.place("published"):
        of, other = layers.changes_since("published")
        try:
            is_same = run(read(Layers(of))) == run(scenario)
        except InputError:
            # A file with the keys that several scenarios share; it is no scenario by itself.
            is_same = not other
        if not is_same:
            published = ()
            assumptions.append(f"the published results of {of.stem} are left out: this is another run")
    return replace(scenario, assumptions=tuple(assumptions), published=published)


def _listed(changed: list[tuple[str, ...]]) -> str:
    names = [".".join(keys) for keys in changed]
    more = f" and {len(names) - _SHOWN_MAX} more" if len(names) > _SHOWN_MAX else ""
    return ", ".join(names[:_SHOWN_MAX]) + more
