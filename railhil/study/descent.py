"""Descent: minimise a margin over vectors of standard normal numbers by CMA-ES with restarts.

Hansen, "The CMA Evolution Strategy: A Tutorial" (2016), by the library ``cmaes`` (extra ``campaign``). Vectors are
proposed in generations of a fixed size, and a generation is proposed only when the margins of the one before are known:
how many runs are made side by side changes no vector.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from railhil.common.extras import need

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Vectors = NDArray[np.float64]

#: The margins (n,) of a block of vectors (n, d). Below 0: violated. NaN: the run has no margin.
Margins = Callable[["Vectors"], "Vectors"]

#: Decimals of a proposal. Sums of another order (another BLAS) differ by about 1e-15, and are rounded away.
_DECIMALS = 9
#: What a run without a margin counts as, and infinity: finite, because CMA-ES computes with it. Chosen.
_WORST = 1e300
#: A start is given up for another one after so many generations, per square root of the dimensions, without a margin
#: that is better by this share of the spread of its first generation. Chosen, so that a start is followed to its
#: least margin: 13 generations at 2 dimensions, 33 at 15.
_PATIENCE, _GAIN = 8.5, 1e-3


def generation_size(dimensions: int) -> int:
    """Vectors of a generation: equation 48 of Hansen's tutorial."""
    return 4 + math.floor(3 * math.log(dimensions))


@dataclass(frozen=True)
class Found:
    """The least margin of a descent.

    ``vector``: where it is. ``run``: number of its run, from 1. ``runs``: made in all. ``first``: number of the first
    run with a margin below 0, None without one. ``starts``: of the descent, the first one included.
    """

    vector: Vectors
    margin: float
    run: int
    runs: int
    first: int | None
    starts: int


class Descent:
    """One descent: :meth:`propose` a generation, :meth:`learn` its margins, and so on.

    :param dimensions: of a vector, at least 1. :param seed: of all proposals. :param start: vector about which the
        first generation lies, instead of 0; a restart begins at a standard normal vector. :param step: standard
        deviation of the first generation of each start. :param bounds: (d, 2) least and largest value of each number.
    :param size: of a generation, instead of :func:`generation_size`. :param patience: generations without a better
        margin after which a start is given up; few where margins have many valleys that do not reach below 0.
    :raises InputError: the library ``cmaes`` is missing. :raises ValueError: dimensions, step, size or the shape of
        ``start`` or ``bounds`` do not fit.
    """

    def __init__(
        self,
        dimensions: int,
        seed: int,
        *,
        start: Sequence[float] | Vectors | None = None,
        step: float = 1.0,
        bounds: Vectors | None = None,
        size: int | None = None,
        patience: int | None = None,
        command: str = "railhil hunt",
    ) -> None:
        if dimensions < 1 or not step > 0:
            raise ValueError(f"found {dimensions} dimensions and step {step}, allowed at least 1 and above 0")
        self.size = generation_size(dimensions) if size is None else size
        if self.size < 4:
            raise ValueError(f"found a generation of {self.size}, allowed at least 4")
        self._make = need("cmaes", "campaign", command=command).CMA
        self._dimensions = dimensions
        self._step = step
        self._bounds = None if bounds is None else np.asarray(bounds, dtype=np.float64)
        if self._bounds is not None and self._bounds.shape != (dimensions, 2):
            raise ValueError(f"found bounds of shape {self._bounds.shape}, allowed ({dimensions}, 2)")
        self._generator = np.random.default_rng(seed)
        self._patience = math.ceil(_PATIENCE * math.sqrt(dimensions)) if patience is None else patience
        self._proposed: Vectors | None = None
        self._best, self._gain, self._stale = _WORST, 0.0, 0
        self.found = Found(np.zeros(dimensions), math.inf, 0, 0, None, 0)
        self._begin(np.zeros(dimensions) if start is None else np.asarray(start, dtype=np.float64))

    def propose(self) -> Vectors:
        """The vectors of the next generation, (``size``, d).

        :raises ValueError: the margins of the last ones were not told.
        """
        if self._proposed is not None:
            raise ValueError("the margins of the last generation are not known yet")
        if self._stale >= self._patience or self._strategy.should_stop():
            self._begin(self._generator.standard_normal(self._dimensions))
        self._proposed = np.round([self._strategy.ask() for _ in range(self.size)], _DECIMALS)
        return self._proposed

    def learn(self, margins: Vectors) -> None:
        """Take the margins of the proposed vectors, in their order.

        :raises ValueError: no generation was proposed, or the number of margins is another one.
        """
        if self._proposed is None or len(margins) != self.size:
            raise ValueError(f"found {len(margins)} margins, allowed {self.size} after a proposal")
        vectors, self._proposed = self._proposed, None
        numbers = np.nan_to_num(np.asarray(margins, dtype=np.float64), nan=_WORST, posinf=_WORST, neginf=-_WORST)
        self._note(vectors, numbers)
        least = float(numbers.min())
        if self._best == _WORST:
            known = numbers[np.abs(numbers) < _WORST]
            self._gain = _GAIN * float(np.ptp(known)) if len(known) else 0.0
        if least < self._best - self._gain:
            self._best, self._stale = least, 0
        else:
            self._stale += 1
        self._strategy.tell(list(zip(vectors, numbers.tolist(), strict=True)))

    def _note(self, vectors: Vectors, margins: Vectors) -> None:
        found, least = self.found, int(margins.argmin())
        first = found.first
        if first is None and (margins < 0).any():
            first = found.runs + int((margins < 0).argmax()) + 1
        better = margins[least] < min(found.margin, _WORST)
        self.found = Found(
            vectors[least] if better else found.vector,
            float(margins[least]) if better else found.margin,
            found.runs + least + 1 if better else found.run,
            found.runs + self.size,
            first,
            found.starts,
        )

    def _begin(self, mean: Vectors) -> None:
        if mean.shape != (self._dimensions,):
            raise ValueError(f"found a start of shape {mean.shape}, allowed ({self._dimensions},)")
        if self._bounds is not None:
            mean = np.clip(mean, self._bounds[:, 0], self._bounds[:, 1])
        self._strategy = self._make(
            mean=mean,
            sigma=self._step,
            bounds=self._bounds,
            seed=int(self._generator.integers(2**32)),
            population_size=self.size,
        )
        self._best, self._gain, self._stale = _WORST, 0.0, 0
        found = self.found
        self.found = Found(found.vector, found.margin, found.run, found.runs, found.first, found.starts + 1)


def descend(
    margins: Margins,
    dimensions: int,
    runs: int,
    seed: int,
    *,
    until_violated: bool = False,
    start: Sequence[float] | Vectors | None = None,
    step: float = 1.0,
    bounds: Vectors | None = None,
    size: int | None = None,
    patience: int | None = None,
    command: str = "railhil hunt",
) -> Found:
    """Make whole generations until another one would exceed ``runs``, at least one.

    :param until_violated: end with the generation in which a margin is below 0. The other parameters are those of
        :class:`Descent`. :raises InputError: the library ``cmaes`` is missing.
    """
    descent = Descent(
        dimensions, seed, start=start, step=step, bounds=bounds, size=size, patience=patience, command=command
    )
    while True:
        descent.learn(margins(descent.propose()))
        found = descent.found
        if found.runs + descent.size > runs or (until_violated and found.first is not None):
            return found
