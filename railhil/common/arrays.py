"""Of arrays."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
import numpy.typing as npt

_Kind = TypeVar("_Kind", bound=np.generic)


def distinct(values: npt.NDArray[_Kind]) -> npt.NDArray[_Kind]:
    """Every value once, ascending: like :func:`numpy.unique` for arrays without NaN, but without its import of masked
    arrays (15 ms).

    :param values: shape (n,).
    """
    ordered: npt.NDArray[_Kind] = np.sort(values)
    first: npt.NDArray[_Kind] = ordered[np.append(True, ordered[1:] != ordered[:-1])[: len(ordered)]]
    return first
