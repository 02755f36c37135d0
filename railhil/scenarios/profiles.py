"""Step profiles of a line, and how they act on a train of finite length: limit over its length, mean grade."""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from railhil.common.arrays import distinct

Floats: TypeAlias = NDArray[np.float64]


#: A step profile: rows ``(from_m, value)``, each valid until the next row; the first value also applies before the
#: first row.
Profile = tuple[tuple[float, float], ...]


def profile_value(profile: Profile, position_m: float) -> float:
    """Value of a step profile at ``position_m`` (a row that starts exactly there already applies)."""
    index = bisect_right(profile, position_m, key=lambda row: row[0]) - 1
    return profile[max(index, 0)][1]


def clip_profile(profile: Profile, low_m: float, high_m: float) -> Profile:
    """The rows between two positions, with a row at each of them."""
    kept = [(low_m, profile_value(profile, low_m)), *(row for row in profile if low_m < row[0] < high_m)]
    return (*kept, (high_m, kept[-1][1]))


def find_lowest(profile: Profile, length_m: float, most: float) -> Profile:
    """Lowest value under a train, by position of its **front**, as a step profile without repeated values.

    A lower value applies when the front reaches it; a higher one only when the rear has left the lower one (one train
    length later). The first value also applies before the first row.

    :param most: largest value, for example the train's own speed limit.
    """
    ends = [row[0] + length_m for row in profile[1:]]
    starts = [row[0] for row in profile]
    edges = sorted({*starts, *ends})
    found: list[tuple[float, float]] = []
    for edge in edges:
        felt = [
            profile[i][1]
            for i in range(len(profile))
            if (starts[i] <= edge or i == 0) and (i == len(profile) - 1 or ends[i] > edge)
        ]
        value = min([*felt, most])
        if not found or found[-1][1] != value:
            found.append((edge, value))
    return tuple(found)


class MeanGrade:
    """Grade in permil averaged over the train, by position of its front (m, scalar or array of any shape).

    The grades of a profile may be arrays of shape (N,), one for each of N runs: then positions have the shape (n,) and
    results (N, n).
    """

    def __init__(self, grade_permil: Profile, length_m: float) -> None:
        self._length_m = length_m
        self._from = np.array([row[0] for row in grade_permil])
        self._grade = np.array([row[1] for row in grade_permil]).T
        # Height in mm over the first row: the integral of permil over metres, exact at every row.
        climbs = self._grade[..., :-1] * np.diff(self._from)
        self._height = np.concatenate((np.zeros((*self._grade.shape[:-1], 1)), np.cumsum(climbs, axis=-1)), axis=-1)
        self.breakpoints_m: Floats = distinct(np.concatenate((self._from, self._from + length_m)))

    def _height_at(self, position_m: Floats) -> Floats:
        row = np.clip(np.searchsorted(self._from, position_m, side="right") - 1, 0, None)
        return np.asarray(self._height[..., row] + self._grade[..., row] * (position_m - self._from[row]))

    def __call__(self, front_m: ArrayLike) -> Floats:
        front = np.asarray(front_m, dtype=np.float64)
        return np.asarray((self._height_at(front) - self._height_at(front - self._length_m)) / self._length_m)

    def extremes(self, from_m: float, to_m: float) -> tuple[float, float]:
        """Smallest and largest mean grade with the front between two positions (linear between breakpoints)."""
        inside = self.breakpoints_m[(self.breakpoints_m > from_m) & (self.breakpoints_m < to_m)]
        values = self(np.concatenate(([from_m], inside, [to_m])))
        return float(values.min()), float(values.max())


def grade_rows(grade_permil: Profile, length_m: float) -> tuple[Floats, Floats, Floats]:
    """Breakpoints of ``(height(x) - height(x - length)) / length``, where height is the integral of the grade.

    :returns: position of each row, value there and slope, as arrays of shape (rows,); the last two of shape (N, rows)
        when the grades of the profile are arrays over N runs.
    """
    mean = MeanGrade(grade_permil, length_m)
    from_m = mean.breakpoints_m
    permil = mean(from_m)
    slope = np.diff(permil) / np.diff(from_m)
    return from_m, permil, np.concatenate((slope, np.zeros((*slope.shape[:-1], 1))), axis=-1)


def cut(profile: Profile, from_m: float, to_m: float) -> Profile:
    """The rows that apply somewhere between two positions; the first may start before or behind them."""
    ends = [row[0] for row in profile[1:]] + [float("inf")]
    kept = tuple(row for row, end in zip(profile, ends, strict=True) if end > from_m and row[0] < to_m)
    return kept or profile[:1]


def shift(profile: Profile, offset_m: float) -> Profile:
    """The profile with ``offset_m`` subtracted from every position."""
    return tuple((position_m - offset_m, value) for position_m, value in profile)


def merge_profiles(profile: Profile) -> Profile:
    """The profile without rows that repeat the value before them."""
    return profile[:1] + tuple(row for before, row in pairwise(profile) if row[1] != before[1])
