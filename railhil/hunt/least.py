"""The least case of one that violates a requirement: its faults and its draws, and the nearest case that keeps it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from railhil.faults.language import parse
from railhil.faults.notation import place_text
from railhil.hunt.draws import Draws, shrink_draws, with_draws
from railhil.hunt.nearest import nearest_case
from railhil.hunt.oracle import Judged, run_case
from railhil.hunt.shrink import ROUNDS_MAX, Shrunk, shrink
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    from railhil.judge.requirements.requirement import Requirement

_CLASS_WORDS = " and "


@dataclass(frozen=True, slots=True)
class ShrinkTask:
    """A case that violates a requirement. ``requirements``: by which its runs are judged. ``horizon_s``: as in
    :func:`railhil.hunt.shrink.shrink`; ``shrinks``: whether it is made smaller at all."""

    base: RunSpec
    requirements: tuple[Requirement, ...]
    requirement: str
    number: int
    faults: tuple[str, ...]
    seed: int
    horizon_s: float
    shrinks: bool
    draws: Draws = ()


@dataclass(frozen=True, slots=True)
class Least:
    """The least case of a task, and its run; ``said``: how that one violates the requirement. ``passing``: faults of
    the nearest case of its shrinking that keeps it; None: there is none."""

    task: ShrinkTask
    shrunk: Shrunk
    draws: Draws
    said: str
    frames_sha256: str
    passing: tuple[str, ...] | None

    @property
    def kind(self) -> tuple[str, str]:
        """Its class: the requirement, the places and words of the faults."""
        faults = sorted(f"{place_text(one.place)} {one.what}" for one in map(parse, self.shrunk.faults))
        return self.task.requirement, _CLASS_WORDS.join([*faults, *["draws"] * bool(self.draws)])


def shrink_case(task: ShrinkTask) -> Least:
    """Shrink one case; its runs are made in this process."""
    runs: dict[tuple[tuple[str, ...], int, Draws], Judged] = {}

    def violates(faults: tuple[str, ...], seed: int, draws: Draws) -> bool:
        key = faults, seed, draws
        if key not in runs:
            runs[key] = run_case(with_draws(task.base, draws), task.requirements, faults, seed)
        return task.requirement in runs[key].violated and not runs[key].idle

    least, draws = Shrunk(task.faults, task.seed, 0, 0), task.draws
    if task.shrinks:
        least, draws = _shrink(task, violates)
        least = replace(least, runs=len(runs))
    violates(least.faults, least.seed, draws)
    found = runs[least.faults, least.seed, draws]
    others = (
        faults
        for (faults, seed, own), other in runs.items()
        if (seed, own) == (least.seed, draws) and _keeps(other, task.requirement)
    )
    passing = nearest_case(least.faults, others)
    return Least(task, least, draws, found.violated.get(task.requirement, ""), found.frames_sha256, passing)


def _keeps(found: Judged, requirement: str) -> bool:
    """Whether a valid run in which every fault acted keeps a requirement."""
    return found.is_valid and not found.idle and requirement not in found.violated


#: (faults, seed of the run, draws) -> whether the requirement is violated in a valid run.
_Violates = Callable[[tuple[str, ...], int, Draws], bool]


def _shrink(task: ShrinkTask, violates: _Violates) -> tuple[Shrunk, Draws]:
    """The least faults and draws: each is made smaller beside the other until neither changes."""
    faults, draws = task.faults, task.draws
    if faults and violates((), task.seed, draws):
        # No fault is needed: nothing is to be learned from those of the case.
        faults = ()
    least = Shrunk(faults, task.seed, 0, 0)
    for _ in range(ROUNDS_MAX):
        before = least.faults, least.seed, draws
        least, draws = _shrink_both(least, draws, violates, task.horizon_s)
        if before == (least.faults, least.seed, draws) or not (least.faults and draws):
            break
    return least, draws


def _shrink_both(least: Shrunk, draws: Draws, violates: _Violates, horizon_s: float) -> tuple[Shrunk, Draws]:
    """Smaller faults beside the draws, then smaller draws beside these faults."""

    def beside_draws(faults: tuple[str, ...], seed: int) -> bool:
        return violates(faults, seed, draws)

    found = shrink(least.faults, least.seed, beside_draws, horizon_s) if least.faults else least

    def beside_faults(draws: Draws) -> bool:
        return violates(found.faults, found.seed, draws)

    return found, shrink_draws(draws, beside_faults)
