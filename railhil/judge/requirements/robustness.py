"""Min/max semantics of signal temporal logic over the ticks of a record.

A margin above 0 says that a condition holds, by how much; below 0 that it does not. No margin is 0: a comparison whose
sides are equal has :data:`LEAST` with the sign of its truth, so that ``not`` is a change of sign, ``and`` a minimum and
``or`` a maximum, and the truth follows from the margin. NaN: a tick at which nothing is known; windows leave it out.

Maler, Nickovic: Monitoring temporal properties of continuous signals (2004); Donze, Maler: Robust satisfaction of
temporal logic over real-valued signals (2010).
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import numpy.typing as npt
from scipy.ndimage import maximum_filter1d

from railhil.record.trace import FloatArray

#: The margin of a comparison at its limit: without a size in any unit, but with a sign.
LEAST: Final = 2.0**-900


def compared(sign: str, left: FloatArray, right: FloatArray, equal_below: float) -> FloatArray:
    """Margins of a comparison, shape (n,).

    :param sign: ``<``, ``<=``, ``>``, ``>=``, ``=`` or ``!=``.
    :param equal_below: sides that differ by less are equal.
    """
    difference = left - right if sign in (">", ">=") else right - left
    equal = np.abs(difference) <= equal_below
    if sign in ("=", "!="):
        away = np.abs(difference)
        return np.where(equal, LEAST if sign == "=" else -LEAST, -away if sign == "=" else away)
    return np.where(equal, LEAST if sign in ("<=", ">=") else -LEAST, difference)


def all_of(left: FloatArray, right: FloatArray) -> FloatArray:
    """``and``, shape (n,): where one side is not known, the other one decides only if it does not hold."""
    least = np.minimum(left, right)
    known = np.fmin(left, right)
    return np.where(np.isnan(least) & (known < 0), known, least)


def any_of(left: FloatArray, right: FloatArray) -> FloatArray:
    """``or``, shape (n,): where one side is not known, the other one decides only if it holds."""
    return -all_of(-left, -right)


def window_max(values: FloatArray, first: int, last: int, beyond: float) -> FloatArray:
    """The largest of the values at ``first`` to ``last`` ticks later, for each tick; shape (n,).

    :param beyond: value of the ticks behind the end. Ticks of which nothing is known count as ``-inf``.
    """
    # Windows that begin or end even later have the same ticks.
    count = len(values)
    first, last = min(first, count), min(last, count)
    size = last - first + 1
    padded = np.full(count + last, beyond)
    np.copyto(padded[:count], np.where(np.isnan(values), -np.inf, values))
    if size == 1:
        return padded[first:]
    # The filter's window is centred; this origin moves it to the ticks from each one on.
    return np.asarray(maximum_filter1d(padded[first:], size, mode="nearest", origin=-(size // 2))[:count])


def window_min(values: FloatArray, first: int, last: int, beyond: float) -> FloatArray:
    """The smallest, as :func:`window_max`; ticks of which nothing is known count as ``+inf``."""
    return -window_max(-values, first, last, -beyond)


def unless(holds: FloatArray, released: npt.NDArray[np.bool_]) -> FloatArray:
    """The smallest margin from each tick to the last one before the release, or to the end; shape (n,).

    This is the weak until: ``max(release, min(holds, the same one tick later))``. A tick of the release itself has
    ``+inf``; NaN: nothing is known up to the release. The minimum runs backwards through blocks of ticks, through all
    blocks at once; then the minimum of each block's rest runs through the blocks. It takes the same time however often
    the conditions change.

    :param holds: margins, shape (n,); ticks of which nothing is known count as ``+inf``.
    :param released: whether the releasing condition holds, shape (n,).
    """
    count = len(holds)
    if not count:
        return np.empty(0)
    length = max(1, math.isqrt(count))
    rows = -(-count // length)
    # The last block is filled up with ticks that change nothing.
    least = np.full(rows * length, np.inf)
    least[:count] = np.where(np.isnan(holds), np.inf, holds)
    ends = np.zeros(rows * length, dtype=bool)
    ends[:count] = released
    least[ends] = np.inf
    blocks, closed = least.reshape(rows, length), ends.reshape(rows, length)
    for column in range(length - 2, -1, -1):
        later = np.where(closed[:, column], np.inf, blocks[:, column + 1])
        np.minimum(blocks[:, column], later, out=blocks[:, column])
    # Whether a release follows within the block.
    is_closed = np.logical_or.accumulate(closed[:, ::-1], axis=1)[:, ::-1]
    carried, value = np.empty(rows), math.inf
    for row in range(rows - 1, -1, -1):
        carried[row] = value
        value = blocks[row, 0] if is_closed[row, 0] else min(blocks[row, 0], value)
    found: FloatArray = np.where(is_closed, blocks, np.minimum(blocks, carried[:, None])).reshape(-1)
    found = found[:count]
    return np.where(np.isposinf(found) & ~released, np.nan, found)


def begins(margins: FloatArray) -> npt.NDArray[np.bool_]:
    """The ticks at which a condition begins to hold, shape (n,); the first tick, if it holds there."""
    holds = margins > 0
    return np.asarray(holds & ~np.concatenate([[False], holds[:-1]]), dtype=np.bool_)


def ceases(margins: FloatArray) -> npt.NDArray[np.bool_]:
    """The first ticks at which a condition is known to hold no longer, shape (n,)."""
    held = np.concatenate([[False], margins[:-1] > 0])
    return np.asarray((margins < 0) & held, dtype=np.bool_)
