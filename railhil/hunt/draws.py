"""Draws in a hunt: at random, by the descent of a margin, and the least ones that violate.

They are those of ``[perturbations]`` and the values that the scenario's faults draw. Draws are standard normal numbers,
which a scenario can be given (``draws``): 0 is the middle of each range.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.study.descent import Descent

#: Vectors of a generation of a descent, and runs of one descent: eight generations. Chosen.
GENERATION, DESCENT_RUNS = 16, 128
#: Shares of the length of a vector that are tried.
_SHORTER = (0.5, 0.8, 0.95)
_DIGITS = 6
_ROUNDS_MAX = 5

Draws = tuple[float, ...]


def drawn_numbers(scenario: AnyScenario) -> tuple[bool, ...]:
    """For each of the draws of a scenario's runs whether it has an effect; the others are 0.

    :raises InputError: its runs take none, or it has its own.
    """
    names = scenario.installed_system.optional_part("draws")
    if names is None or not any(names(scenario)):
        allowed = "a scenario with ranges in [perturbations] whose runs can be given draws, such as lvshun_tieshan"
        raise InputError("command line", "--what", Words(f"draws of {scenario.name}"), allowed)
    if getattr(scenario, "draws", ()):
        # Those of a --set would also replace those of a found file.
        found = Words(f"draws of {scenario.name}, which has its own")
        raise InputError("command line", "--what", found, "a scenario without them: this command draws them")
    return tuple(name is not None for name in names(scenario))


def with_draws(base: RunSpec, draws: Sequence[float]) -> RunSpec:
    """A run with these draws; with none as it is."""
    return replace(base, settings=(*base.settings, f"draws={[*draws]}")) if draws else base


def random_draws(seed: int, number: int, drawn: Sequence[bool]) -> Draws:
    """The draws of a case, which depend on the seed of the hunt and its number alone.

    :param drawn: of :func:`drawn_numbers`.
    """
    chance = random.Random(f"railhil hunt draws {seed} {number}")
    return tuple(round(chance.gauss(0.0, 1.0), _DIGITS) if has_effect else 0.0 for has_effect in drawn)


def descend_rows(
    make_row: Callable[[int, Draws], dict[str, Any]],
    numbers: Sequence[int],
    requirement: str,
    seed: int,
    drawn: Sequence[bool],
) -> Iterator[dict[str, Any]]:
    """The rows of one descent of the margin of a requirement.

    :param make_row: makes the run with this number and these draws. :param numbers: of the runs; the first one and
        ``seed``, that of the hunt, determine the descent. :param drawn: of :func:`drawn_numbers`.
    """
    own = random.Random(f"railhil hunt descent {seed} {numbers[0]}").getrandbits(32)
    descent, left = Descent(sum(drawn), own, size=GENERATION), list(numbers)
    while left:
        vectors = descent.propose()[: len(left)]
        rows = [make_row(left.pop(0), _whole(vector.tolist(), drawn)) for vector in vectors]
        yield from rows
        if len(rows) == GENERATION:
            descent.learn(np.array([margin_of(row, requirement) for row in rows]))


def _whole(numbers: Sequence[float], drawn: Sequence[bool]) -> Draws:
    """All draws of a run, from those that have an effect."""
    following = iter(numbers)
    return tuple(next(following) if has_effect else 0.0 for has_effect in drawn)


def margin_of(row: Mapping[str, Any], requirement: str) -> float:
    """The margin of a requirement in a row; below 0 if it is violated, NaN if it says nothing."""
    margin = next((one["margin"] for one in row["outcomes"] if one["id"] == requirement), None)
    if margin is None:
        return math.nan
    return min(float(margin), -np.finfo(np.float64).tiny) if requirement in row["violated"] else float(margin)


def shrink_draws(draws: Draws, violates: Callable[[Draws], bool]) -> Draws:
    """Draws nearer to 0 that violate the same: none at all, else each alone 0, then all shorter by the same share.

    :param draws: they violate it. :param violates: whether others do.
    """
    if not draws or violates(()):
        return ()
    for _ in range(_ROUNDS_MAX):
        before = draws
        for place in sorted(range(len(draws)), key=lambda place: abs(before[place])):
            candidate = (*draws[:place], 0.0, *draws[place + 1 :])
            if draws[place] and violates(candidate):
                draws = candidate
        for share in _SHORTER:
            while violates(shorter := tuple(round(share * one, _DIGITS) for one in draws)) and shorter != draws:
                draws = shorter
        if draws == before:
            break
    return draws


def draws_sentence(draws: Sequence[float]) -> str:
    """Draws in words."""
    return f"draws of length {math.hypot(*draws):.3g} (standard deviations), {_not_0(draws)} of {len(draws)} not 0"


def size_words(faults: Sequence[str], draws: Sequence[float]) -> str:
    """The size of a case: its faults, and its draws that are not 0, which is nominal."""
    count = _not_0(draws)
    drawn = f"{count_of(count, 'draw')} not nominal (length {math.hypot(*draws):.3g})"
    return " and ".join([count_of(len(faults), "fault")] * bool(faults) + [drawn] * bool(count)) or "nothing"


def _not_0(draws: Sequence[float]) -> int:
    return sum(bool(one) for one in draws)
