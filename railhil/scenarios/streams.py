"""Independent random streams of a run: every random source has its own, so adding one does not change the others.

A stream is ``SeedSequence([seed, stream])`` feeding PCG64 (numpy's default bit generator, whose stream is
fixed by numpy's compatibility policy for seeded bit generators). Where only a few of its numbers are needed, it feeds
counted normal numbers instead: the speed sensor of a train on its line.

A counted normal number is drawn by its place in a sequence, without its predecessors. A place gives a word of 64 bits:
the output of SplitMix64 at that place (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA
2014), whose state is a sum and needs no predecessors. The word gives the number by the inverse of the normal
distribution, Wichura's algorithm AS 241 (PPND16, Applied Statistics 37, 1988). The node draws blocks of neighbouring
places by numpy, the batch single places (:mod:`railhil.common.compilable`): same bits.
"""

from __future__ import annotations

from functools import lru_cache
from math import erfc, log, sqrt
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.common.compilable import compilable

if TYPE_CHECKING:
    from railhil.faults.model import Random

#: Draws of :func:`railhil.systems.ato.scenario.perturb.perturb`.
PERTURBATION = 0
#: Noise of the axle speed sensors of a high-speed train.
SPEED_NOISE = 1
#: Search of tuning parameters.
TUNING = 5
#: Values of a fault that are drawn once for a run.
FAULT_VALUES = 6
#: All draws of a fault while it is active.
FAULT_SAMPLES = 7
#: Wind on a high-speed train.
WIND = 8
#: Grades of a high-speed line.
GRADES = 9
#: Draws for the train of a sequence of runs, and for its line.
SEQUENCE = 10
#: Draws that differ from run to run of a sequence: values drawn once, noise of the speed, wander of the speed, balises.
RUN_VALUES, RUN_SPEED_NOISE, RUN_WANDER, RUN_BALISES = 11, 12, 13, 14

#: Noise of the axle speed sensor of a train on its line. With this number seed 0, the default, is a typical run of the
#: default scenario: it stops 0.269 m short, the median over 2000 seeds is 0.267 m.
AXLE_NOISE = 24

#: Disturbances of the dwell at the stops of a line, mass of the train in each section, noise of the train protection's
#: own axle sensor, and of the docking loop.
DWELL, SECTION_LOAD, PROTECTION_NOISE, DOCKING = 25, 26, 27, 28

#: Of fault n while it is active, in a run with a chain: this number and n.
_CHAINED_SAMPLES = 1000

#: Counted normal numbers as a sum: for each of its sequences the seed and the coefficient, in the order of summation.
#: With coefficients whose squares add up to 1 the sums are standard normal numbers, too.
Chain: TypeAlias = tuple[tuple[int, float], ...]

#: Largest word of a ``SeedSequence``.
_WORD_MAX = 2**32 - 1


def seed_sequence(seed: int, stream: int) -> np.random.SeedSequence:
    """The ``SeedSequence`` of the list ``[seed, stream]``.

    Where each number is one word, it is given as such: numpy takes several times as long to find it in a list.
    """
    small = 0 <= seed <= _WORD_MAX and 0 <= stream <= _WORD_MAX
    return np.random.SeedSequence(np.array([seed, stream], dtype=np.uint32) if small else [seed, stream])


def generator(seed: int, stream: int) -> np.random.Generator:
    """Random generator of one stream of one run; ``seed`` and ``stream`` are integers >= 0.

    Raises ``ValueError`` for negative numbers.
    """
    if seed < 0 or stream < 0:
        raise ValueError(f"seed {seed} and stream {stream} must be >= 0")
    return np.random.Generator(np.random.PCG64(seed_sequence(seed, stream)))


def run_generator(seed: int, stream: int, run_number: int) -> np.random.Generator:
    """Random generator of one stream of one run of a sequence.

    :param seed: of the sequence.
    :param run_number: of the run in it, from 1.
    :raises ValueError: a negative number.
    """
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, stream, run_number])))


def fault_generator(stream: int, run_seed: int, number: int, own_seed: int | None) -> np.random.Generator:
    """Random generator of one fault of a run.

    :param stream: :data:`FAULT_VALUES` or :data:`FAULT_SAMPLES`.
    :param number: the fault's place in the run's list, from 1; unused if it has a seed of its own.
    :param own_seed: the fault's seed; None: from the run's seed and the fault's number.
    :raises ValueError: a negative number.
    """
    entropy = [run_seed, stream, number] if own_seed is None else [own_seed, stream]
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(entropy)))


def fault_samples(run_seed: int, number: int, own_seed: int | None, chain: Chain) -> Random:
    """Random numbers of one fault while it is active.

    :param number, own_seed: as in :func:`fault_generator`.
    :param chain: of the run; empty: its seed.
    :raises ValueError: a negative number.
    """
    if chain and own_seed is None:
        return ChainSamples(keys_of(chain, _CHAINED_SAMPLES + number))
    return fault_generator(FAULT_SAMPLES, run_seed, number, own_seed)


#: :class:`NormalSequence` draws its numbers in blocks, which gives the same numbers faster.
_BLOCK = 4096
#: Numbers that :class:`ChainSamples` makes together, and the largest number below 1.
_SAMPLES, _BELOW_ONE = 64, 1.0 - 2.0**-53


class NormalSequence:
    """Numbers of the standard normal distribution from one source, one after the other."""

    def __init__(self, source: np.random.Generator) -> None:
        self._source = source
        self._block: list[float] = []
        self._next = 0

    def __call__(self) -> float:
        if self._next == len(self._block):
            self._block, self._next = self._source.standard_normal(_BLOCK).tolist(), 0
        self._next += 1
        return self._block[self._next - 1]


#: Keys that are remembered: searches and comparisons repeat the same seeds.
_KEPT = 65_536

_GAMMA = np.uint64(0x9E3779B97F4A7C15)
_FIRST_FACTOR, _SECOND_FACTOR = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_FIRST_SHIFT, _SECOND_SHIFT, _LAST_SHIFT = np.uint64(30), np.uint64(27), np.uint64(31)
_ONE = np.uint64(1)
#: The highest 52 bits of a word, and a half, are a probability between 0 and 1, neither of which it reaches.
_UNIT_SHIFT, _UNIT = np.uint64(12), 2.0**-52
#: Distance from the median within which AS 241 needs no logarithm.
_MIDDLE = 0.425


@lru_cache(maxsize=_KEPT)
def key_of(seed: int, stream: int) -> int:
    """Start of a run's sequence: 64 bits that numpy's ``SeedSequence`` makes of seed and stream.

    :raises ValueError: a negative number.
    """
    if seed < 0 or stream < 0:
        raise ValueError(f"seed {seed} and stream {stream} must be >= 0")
    return int(seed_sequence(seed, stream).generate_state(1, np.uint64)[0])


@compilable
def words(key: Any, places: Any) -> Any:
    """The words at these places (from 0).

    :param key: as ``uint64``.
    :param places: ``uint64``, an array; one of them when compiled.
    """
    mixed = key + (places + _ONE) * _GAMMA
    mixed = (mixed ^ (mixed >> _FIRST_SHIFT)) * _FIRST_FACTOR
    mixed = (mixed ^ (mixed >> _SECOND_SHIFT)) * _SECOND_FACTOR
    return mixed ^ (mixed >> _LAST_SHIFT)


@compilable
def beyond_median(word: Any) -> Any:
    """Probability of a word less a half, exactly."""
    return ((word >> _UNIT_SHIFT) + 0.5) * _UNIT - 0.5


@compilable
def near(q: Any) -> Any:
    """Normal number whose probability is ``0.5 + q``, for ``q`` (arrays, too) of at most 0.425."""
    r = 0.180625 - q * q
    above = 2.5090809287301226727e3 * r + 3.3430575583588128105e4
    above = (above * r + 6.7265770927008700853e4) * r + 4.5921953931549871457e4
    above = (above * r + 1.3731693765509461125e4) * r + 1.9715909503065514427e3
    above = (above * r + 1.3314166789178437745e2) * r + 3.3871328727963666080e0
    below = 5.2264952788528545610e3 * r + 2.8729085735721942674e4
    below = (below * r + 3.9307895800092710610e4) * r + 2.1213794301586595867e4
    below = (below * r + 5.3941960214247511077e3) * r + 6.8718700749205790830e2
    below = (below * r + 4.2313330701600911252e1) * r + 1.0
    return q * above / below


@compilable
def far(q: float) -> float:
    """Normal number whose probability is ``0.5 + q``, for ``q`` beyond 0.425."""
    r = sqrt(-log(0.5 - abs(q)))
    if r <= 5.0:
        r -= 1.6
        above = 7.74545014278341407640e-4 * r + 2.27238449892691845833e-2
        above = (above * r + 2.41780725177450611770e-1) * r + 1.27045825245236838258e0
        above = (above * r + 3.64784832476320460504e0) * r + 5.76949722146069140550e0
        above = (above * r + 4.63033784615654529590e0) * r + 1.42343711074968357734e0
        below = 1.05075007164441684324e-9 * r + 5.47593808499534494600e-4
        below = (below * r + 1.51986665636164571966e-2) * r + 1.48103976427480074590e-1
        below = (below * r + 6.89767334985100004550e-1) * r + 1.67638483018380384940e0
        below = (below * r + 2.05319162663775882187e0) * r + 1.0
    else:
        r -= 5.0
        above = 2.01033439929228813265e-7 * r + 2.71155556874348757815e-5
        above = (above * r + 1.24266094738807843860e-3) * r + 2.65321895265761230930e-2
        above = (above * r + 2.96560571828504891230e-1) * r + 1.78482653991729133580e0
        above = (above * r + 5.46378491116411436990e0) * r + 6.65790464350110377720e0
        below = 2.04426310338993978564e-15 * r + 1.42151175831644588870e-7
        below = (below * r + 1.84631831751005468180e-5) * r + 7.86869131145613259100e-4
        below = (below * r + 1.48753612908506148525e-2) * r + 1.36929880922735805310e-1
        below = (below * r + 5.99832206555887937690e-1) * r + 1.0
    return -above / below if q < 0.0 else above / below


@compilable
def normal_at(key: Any, place: Any) -> float:
    """The number at one place; key and place as ``uint64``. For compiled loops."""
    q = beyond_median(words(key, place))
    return near(q) if abs(q) <= _MIDDLE else far(q)


def normals(key: int, first: int, count: int) -> NDArray[np.float64]:
    """The numbers at neighbouring places, shape (count,).

    :param key: of :func:`key_of`.
    :param first: place of the first number, from 0.
    """
    q = beyond_median(words(np.uint64(key), np.arange(first, first + count, dtype=np.uint64)))
    numbers: NDArray[np.float64] = near(q)
    for place in np.flatnonzero(abs(q) > _MIDDLE).tolist():
        numbers[place] = far(float(q[place]))
    return numbers


def chain_of(seed: int, given: Chain = ()) -> Chain:
    """The chain of a run: the given one, else the sequence of its seed."""
    return given or ((seed, 1.0),)


def keys_of(chain: Chain, stream: int) -> Chain:
    """The chain with the keys of its sequences instead of their seeds (:func:`key_of`).

    :raises ValueError: a negative seed.
    """
    return tuple((key_of(seed, stream), coefficient) for seed, coefficient in chain)


def chain_normals(keyed: Chain, first: int, count: int) -> NDArray[np.float64]:
    """The sums of a chain at neighbouring places, shape (count,). They are added in the chain's order, so the batch,
    which adds them place by place, has the same bits.

    :param keyed: of :func:`keys_of`.
    :param first: place of the first number, from 0.
    """
    numbers = np.zeros(count)
    for key, coefficient in keyed:
        numbers += coefficient * normals(key, first, count)
    return numbers


class ChainSamples:
    """Random numbers from the sums of a chain, one after the other; each kind of number uses one sum.

    :param keyed: of :func:`keys_of`.
    """

    def __init__(self, keyed: Chain) -> None:
        self._keyed = keyed
        self._block: list[float] = []
        self._first = 0

    def standard_normal(self) -> float:
        """A standard normal number."""
        if not self._block:
            self._block = chain_normals(self._keyed, self._first, _SAMPLES).tolist()[::-1]
            self._first += _SAMPLES
        return self._block.pop()

    def random(self) -> float:
        """A number from 0 to below 1."""
        return min(probability_of(self.standard_normal()), _BELOW_ONE)

    def integers(self, low: int, high: int, /, *, endpoint: bool = False) -> int:
        """A whole number from ``low`` to below ``high``, with ``endpoint`` up to ``high``."""
        return low + int(self.random() * (high - low + endpoint))


def probability_of(number: float) -> float:
    """Probability of a standard normal number below this one, 0..1."""
    return 0.5 * erfc(-number * sqrt(0.5))
