"""Standard normal numbers at a few places of a long sequence, as numpy's ``Generator`` draws it, without the others.

numpy draws by the ziggurat method of Marsaglia and Tsang (2000): a word of 64 bits gives a number in 99 of 100 draws,
and only the table of the acceptance is needed to know where the next draw begins. The raw words take a fifth of the
time of the numbers. The tables are those of numba, which draws the same numbers as numpy in compiled code.
"""

from __future__ import annotations

from math import exp, log1p
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.batch import compiled

try:
    from numba.np.random._constants import fi_double, ki_double, wi_double

    #: Magnitudes accepted at once in each cell, width of the cells, height of the curve at their ends.
    TABLES: Any = (ki_double, wi_double, fi_double)
except ImportError:
    # They are not part of numba's interface; without them every number is drawn.
    TABLES = None

#: A word from its lowest bit: cell of the table, sign, magnitude.
_CELL, _SIGN, _MAGNITUDE = np.uint64(0xFF), np.uint64(0x100), np.uint64(0xFFFFFFFFFFFFF)
_MAGNITUDE_AT, _UNIT_AT, _TAIL_SIGN = np.uint64(9), np.uint64(11), np.uint64(0x20000)
_UNIT = 2.0**-53
#: Where the tail of the curve begins, and its inverse.
_TAIL, _TAIL_INVERSE = 3.6541528853610087963519472518, 0.27366123732975827203338247596
#: Words for each number and beyond, with which a sequence practically never ends early: one number in 70 takes more.
_WORDS_PER_NUMBER, _MORE_WORDS = 1.03, 100


@compiled.aside
def _slowly(words: Any, place: int, word: Any, fi: Any, wi: Any) -> Any:
    """A word beyond the fast acceptance: the next place (-1: no words are left), whether it gives a number, which."""
    cell = word & _CELL
    x = ((word >> _MAGNITUDE_AT) & _MAGNITUDE) * wi[cell]
    if word & _SIGN:
        x = -x
    if cell > 0:
        if place >= words.size:
            return -1, False, 0.0
        unit = (words[place] >> _UNIT_AT) * _UNIT
        return place + 1, (fi[cell - np.uint64(1)] - fi[cell]) * unit + fi[cell] < exp(-0.5 * x * x), x
    while place + 1 < words.size:
        beyond = -_TAIL_INVERSE * log1p(-((words[place] >> _UNIT_AT) * _UNIT))
        height = -log1p(-((words[place + 1] >> _UNIT_AT) * _UNIT))
        place += 2
        if height + height > beyond * beyond:
            return place, True, -(_TAIL + beyond) if word & _TAIL_SIGN else _TAIL + beyond
    return -1, False, 0.0


@compiled.cached(__file__)
def _pick(words: Any, places: Any, ki: Any, wi: Any, fi: Any, numbers: Any) -> bool:
    """Fill ``numbers``; False if there are not enough words."""
    at, drawn = 0, 0
    for row in range(places.size):
        while drawn <= places[row]:
            if at >= words.size:
                return False
            word = words[at]
            at += 1
            magnitude = (word >> _MAGNITUDE_AT) & _MAGNITUDE
            if magnitude < ki[word & _CELL]:
                if drawn == places[row]:
                    x = magnitude * wi[word & _CELL]
                    numbers[row] = -x if word & _SIGN else x
                drawn += 1
            else:
                at, accepted, x = _slowly(words, at, word, fi, wi)
                if at < 0:
                    return False
                if accepted:
                    numbers[row] = x
                    drawn += 1
    return True


def numbers_at(generator: np.random.Generator, places: NDArray[np.int64]) -> NDArray[np.float64]:
    """``generator.standard_normal(places[-1] + 1)[places]``; the generator is used up.

    :param generator: on PCG64, new.
    :param places: rising, from 0 on.
    """
    before = generator.bit_generator.state
    count = int(places[-1]) + 1
    words = generator.bit_generator.random_raw(int(count * _WORDS_PER_NUMBER) + _MORE_WORDS)
    numbers = np.empty(places.size)
    if TABLES is not None and _pick(words, places, *TABLES, numbers):
        return numbers
    generator.bit_generator.state = before
    return generator.standard_normal(count)[places]
