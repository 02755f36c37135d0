"""Paths of the figures of a page, read as their script reads them."""

from __future__ import annotations

import re

import numpy as np

from railhil.charts.figure import FloatArray

_TOKENS = re.compile(r"[MLHVZ]|-?[\d.]+(?:e[-+]?\d+)?")


def path_points(d: str) -> tuple[FloatArray, FloatArray]:
    """Points of a path of M, L, H and V; NaN where the line is broken."""
    xs: list[float] = []
    ys: list[float] = []
    kind, x, y, given = "M", np.nan, np.nan, 0
    for token in _TOKENS.findall(d):
        if token in "MLHVZ":
            if token == "M" and xs:
                xs.append(xs[-1])
                ys.append(np.nan)
            kind, given = token, 0
            continue
        if kind == "V" or (kind in "ML" and given == 1):
            y = float(token)
        else:
            x = float(token)
        given = (given + 1) % 2
        if kind in "HV" or given == 0:
            xs.append(x)
            ys.append(y)
    return np.array(xs), np.array(ys)
