"""The batch of ``ato``: thousands of runs of one scenario under one law in one process, equal to the bench bit for bit.

The plant's own functions are compiled (:mod:`railhil.common.compilable`), the law steps on arrays; the notch codes and
the scores of each run equal :func:`railhil.bench.direct_run` with the same seed, and therefore the real bench on a
healthy bus. A run that ends in an emergency brake is repeated through the nodes of the bench (:mod:`.replay`), which
takes a second. Of the faults of a scenario it computes a mass, a gradient and a resistance that differ from the start
to the end (:func:`railhil.faults.capability.is_constant`). Needs numba (extra ``campaign``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from railhil.batch.case import Batch, Case
from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP
from railhil.judge.score import Score
from railhil.scenarios.streams import Chain
from railhil.systems.ato.batch.replay import left_the_healthy_path, notch_digest, replayed
from railhil.systems.ato.scenario.perturb import name_draws

if TYPE_CHECKING:
    from railhil.systems.ato.batch.engine import BatchRuns

#: Runs computed together: their state stays in the processor's cache, and the Python overhead is shared.
CHUNK = 2048
#: Seeds travel as 32 bit in the handshake.
_SEED_MAX = 2**32 - 1


def run_batch(case: Case, seeds: Sequence[int], *, keep_notches: bool = False, chunk: int = CHUNK) -> Batch:
    """Run a case with each seed, any number of them.

    :param keep_notches: keep the notch codes of each run.
    :param chunk: number of runs computed together; the results do not depend on it.
    :raises scenarios.errors.InputError: numba is missing, the law does not fit, or a fault needs the nodes.
    :raises ValueError: a seed outside 32 bit.
    :raises plant_sim.plant.PlantError: the simulation failed.
    """
    # Imported only here: numba is an extra, and a case or a digest does not need it.
    from railhil.systems.ato.batch.engine import Engine

    if any(not 0 <= seed <= _SEED_MAX for seed in seeds):
        raise ValueError(f"seeds must lie inside 0..{_SEED_MAX}")
    engine = Engine(case)
    chunks = [engine.run(seeds[i : i + chunk]) for i in range(0, len(seeds), chunk)]
    return _result(case, seeds, chunks, keep_notches)


class VectorRuns:
    """Runs of a case as functions of vectors: draws and noise, as a scenario can be given them (``draws``, ``noise``).

    The scores of each run are those of the bench with this scenario, to the last digit. Needs numba (extra
    ``campaign``).

    :param chunk: number of runs computed together; the results do not depend on it.
    :raises scenarios.errors.InputError: numba is missing, the law does not fit, or a fault needs the nodes.
    """

    def __init__(self, case: Case, chunk: int = CHUNK) -> None:
        from railhil.systems.ato.batch.engine import Engine

        self._engine, self._chunk = Engine(case), chunk
        #: Number of draws of a run.
        self.draws = len(name_draws(case.scenario))

    def run(self, draws: NDArray[np.float64], noise: Sequence[Chain]) -> list[Score]:
        """Scores of N runs.

        :param draws: standard normal numbers, shape (N, :attr:`draws`).
        :param noise: of each run, rows (seed, coefficient); the squares of its coefficients add up to 1.
        :raises ValueError: another shape.
        :raises plant_sim.plant.PlantError: the simulation failed.
        """
        from railhil.systems.ato.batch.setup import Vectors

        if draws.shape != (len(noise), self.draws):
            raise ValueError(f"draws have the shape {draws.shape}, not {(len(noise), self.draws)}")
        scores: list[Score] = []
        for first in range(0, len(noise), self._chunk):
            rows = slice(first, first + self._chunk)
            scores += self._engine.run([0] * len(noise[rows]), Vectors(draws[rows], noise[rows])).scores
        return scores

    def continue_run(self, seed: int, changes: Sequence[tuple[int, int]]) -> list[Score]:
        """Scores of one run of the case, again and again with other noise from a tick on.

        :param changes: for each time the tick, and the seed of the later noise.
        :raises plant_sim.plant.PlantError: the simulation failed.
        """
        parts = [changes[first : first + self._chunk] for first in range(0, len(changes), self._chunk)]
        return [score for part in parts for score in self._engine.run([seed] * len(part), None, part).scores]


def _result(case: Case, seeds: Sequence[int], chunks: list[BatchRuns], keep_notches: bool) -> Batch:
    scores = [score for chunk in chunks for score in chunk.scores]
    codes = [chunk.codes[:steps, i].copy() for chunk in chunks for i, steps in enumerate(chunk.steps)]
    counts = {
        kind: np.concatenate([np.zeros(0, dtype=np.int64), *(chunk.counts[kind] for chunk in chunks)])
        for kind in (WRAP, SATURATION, DIVISION_BY_ZERO)
    }
    for run, seed in enumerate(seeds):
        if left_the_healthy_path(scores[run]):
            scores[run], codes[run], counted = replayed(case, int(seed))
            for kind, count in counted.items():
                counts[kind][run] = count

    named = {"wraps": counts[WRAP], "saturations": counts[SATURATION], "zero_divisions": counts[DIVISION_BY_ZERO]}
    found = Batch.of(case.scenario, seeds, scores, named, [notch_digest(run) for run in codes])
    return replace(found, commands=tuple(codes) if keep_notches else None)
