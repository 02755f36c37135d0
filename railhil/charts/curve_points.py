"""Curves of a page in few bytes: the points that can be seen."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.charts.figure import FloatArray

Rows: TypeAlias = npt.NDArray[np.int64]
#: Deviation between the line and one of the extremes that is left out, as a share of the curve's range.
#: :func:`find_deviation` gives the distance of the rows between the extremes from the line, for each curve.
TOLERANCE = 2e-4
#: Smallest number of changes kept of a curve that is constant most of the time.
_CHANGES = 600


def pick_rows(values: FloatArray, stretches: int, tolerance: float = TOLERANCE) -> Rows:
    """Rows that are needed to draw a curve; first and last are among them.

    A curve that is constant most of the time keeps every change. Any other curve keeps the extremes of each stretch of
    rows, except extremes that lie on the line between their neighbours.

    :param values: shape (n,), NaN: no value.
    :param stretches: at most as many, with two points each.
    :returns: ascending, shape (k,).
    """
    count = len(values)
    if count < 3:
        return np.arange(count)
    known = np.nan_to_num(values, nan=np.inf)
    changes = np.flatnonzero(known[1:] != known[:-1])
    if len(changes) <= max(stretches, min(_CHANGES, count // 8)):
        # The last row with the old value and the first with the new one.
        return np.unique(np.concatenate(([0], changes, changes + 1, [count - 1])))
    rows = _extremes(known, stretches)
    finite = values[np.isfinite(values)]
    gaps = np.flatnonzero(np.isnan(values[1:]) != np.isnan(values[:-1]))
    # Both sides of every gap: a stretch may have several.
    bends = rows[pick_bends(rows, values[rows], tolerance * float(np.ptp(finite)))]
    return np.unique(np.concatenate((bends, gaps, gaps + 1)))


def _extremes(values: FloatArray, stretches: int) -> Rows:
    """The rows of the least and the largest value of each stretch, the first and the last row."""
    count = len(values)
    size = -(-count // stretches)
    if size < 3:
        return np.arange(count)
    whole = count // size * size
    table = values[:whole].reshape(-1, size)
    starts = np.arange(0, whole, size)
    found = [[0], starts + table.argmin(axis=1), starts + table.argmax(axis=1), np.arange(whole, count), [count - 1]]
    return np.unique(np.concatenate(found))


def pick_bends(at: npt.NDArray[Any], values: FloatArray, allowed: float) -> Rows:
    """The rows that are needed to keep the line within ``allowed`` of all rows; first and last are among them.

    The line from each kept row is extended while one slope fits all rows between (the swinging door of process
    recorders).

    :param at: strictly ascending, shape (n,), n at least 1. :param values: shape (n,), NaN: no value.
    """
    x, y = at.tolist(), values.tolist()
    kept, low, high = [0], -np.inf, np.inf
    for place in range(1, len(x)):
        if np.isnan(y[place]) and not np.isnan(y[place - 1]):
            # True where a gap begins, even a gap of a single row.
            kept += [place - 1, place]
            low, high = -np.inf, np.inf
            continue
        start = kept[-1]
        span = x[place] - x[start]
        slope = (y[place] - y[start]) / span
        # False where a value is missing, so that both sides of a gap are kept.
        if not low <= slope <= high and place - 1 > start:
            kept.append(place - 1)
            start, span, low, high = place - 1, x[place] - x[place - 1], -np.inf, np.inf
        low = max(low, (y[place] - allowed - y[start]) / span)
        high = min(high, (y[place] + allowed - y[start]) / span)
    kept.append(len(x) - 1)
    return np.unique(kept)


def find_deviation(rows: Rows, values: FloatArray, time_s: npt.NDArray[Any]) -> float:
    """The largest distance of a value from the line between the kept rows, rounded up to two digits; 0: there is none.

    :param values: shape (n,), NaN: no value, which is at no distance.
    """
    line = np.interp(time_s, time_s[rows], values[rows])
    off = np.abs(line - values)
    most = float(np.max(off, where=np.isfinite(off), initial=0.0))
    digit = 10.0 ** (np.floor(np.log10(most)) - 1) if most else 1.0
    return float(f"{np.ceil(most / digit * (1 - 1e-12)) * digit:.6g}")
