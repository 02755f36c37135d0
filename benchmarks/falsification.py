"""``python -m benchmarks.falsification``: simulations until the first violation of each requirement of "chasing cars".

The benchmark is that of ARCH-COMP's falsification category (:mod:`benchmarks.chasing_cars`), with the inputs of its
instance 2: piecewise constant, control points each 5 s. Rules: repetitions of at most 1500 simulations each.
"""

from __future__ import annotations

import statistics
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.special import ndtr

from benchmarks.chasing_cars import END_S, SENTENCES, margins
from railhil.common.command_line import OneLineParser, parse
from railhil.common.exit_codes import run_guarded
from railhil.study.descent import descend, generation_size

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

_POINTS = END_S // 5
_DIMENSIONS = 2 * _POINTS
#: Most simulations of a repetition, and repetitions, since 2022.
RUNS_MAX, REPETITIONS = 1500, 10
#: Seeds of the repetitions. Seeds 0 to 3 were used to choose :data:`_WIDTH` and :data:`_PATIENCE`.
FIRST_SEED = 100
#: Inputs of a descent are Phi(width * z) of standard normal z. Chosen of 1 (inputs equally likely) and 2 (inputs near 0
#: and 1 more likely).
_WIDTH = 2.0
#: Generations without a better margin until a descent starts elsewhere. Chosen of 6, 19 and 54.
_PATIENCE = 6


@dataclass(frozen=True, slots=True)
class Result:
    """Simulations of each repetition until the first violation, None where there was none."""

    requirement: str
    strategy: str
    firsts: tuple[int | None, ...]

    @property
    def found(self) -> list[int]:
        """Those of the repetitions that found a violation."""
        return [first for first in self.firsts if first is not None]

    @property
    def cell(self) -> str:
        """Repetitions that found one, mean and median of their simulations."""
        found = self.found
        if not found:
            return f"0 of {len(self.firsts)}"
        middle = f"mean {statistics.mean(found):.1f}, median {statistics.median(found):g}"
        return f"{len(found)} of {len(self.firsts)}: {middle}"


def _random(name: str, seed: int, runs: int) -> int | None:
    judged, generator = margins(name, _POINTS), np.random.default_rng(seed)
    for done in range(0, runs, size := generation_size(_DIMENSIONS)):
        below = judged(generator.random((min(size, runs - done), _DIMENSIONS))) < 0
        if below.any():
            return done + int(below.argmax()) + 1
    return None


def _descent(name: str, seed: int, runs: int) -> int | None:
    judged = margins(name, _POINTS)

    def of_draws(block: Floats) -> Floats:
        return judged(np.asarray(ndtr(_WIDTH * block)))

    return descend(
        of_draws, _DIMENSIONS, runs, seed, until_violated=True, patience=_PATIENCE, command="benchmarks.falsification"
    ).first


STRATEGIES = {"random": _random, "descent": _descent}


def result(name: str, strategy: str, repetitions: int = REPETITIONS, runs: int = RUNS_MAX) -> Result:
    """The repetitions of one strategy on one requirement."""
    seeds = range(FIRST_SEED, FIRST_SEED + repetitions)
    return Result(name, strategy, tuple(STRATEGIES[strategy](name, seed, runs) for seed in seeds))


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a table; exit codes as of ``railhil``."""
    parser = OneLineParser(prog="python -m benchmarks.falsification", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", action="append", choices=SENTENCES, metavar="NAME", help=f"of {', '.join(SENTENCES)}")
    parser.add_argument("--repetitions", type=int, choices=range(1, 101), default=REPETITIONS, metavar="N")

    def work() -> int:
        given = parse(parser, arguments)
        table = Table("requirement", *STRATEGIES, title="simulations until the first violation", title_justify="left")
        for name in given.only or SENTENCES:
            table.add_row(name, *(result(name, strategy, given.repetitions).cell for strategy in STRATEGIES))
        Console().print(table)
        return 0

    return run_guarded("benchmarks.falsification", work)


if __name__ == "__main__":
    sys.exit(main())
