"""Number systems for control laws: one interface, float64 and C28x fixed point, for one train or for N."""

from __future__ import annotations

from typing import Any

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic.base import Arithmetic
from railhil.controller_node.arithmetic.float32 import Float32, Float32Truncated
from railhil.controller_node.arithmetic.float32_batch import Float32Batch, Float32TruncatedBatch
from railhil.controller_node.arithmetic.float64 import Float64, Float64Batch
from railhil.controller_node.arithmetic.iq import C28, C28Batch, Portable, PortableBatch

_ONE_TRAIN: dict[str, type[Arithmetic[Any]]] = {
    "iq": C28,
    "iq-portable": Portable,
    "float64": Float64,
    "float32": Float32,
    "float32-truncated": Float32Truncated,
}
_MANY_TRAINS: dict[str, type[Arithmetic[Any]]] = {
    "iq": C28Batch,
    "iq-portable": PortableBatch,
    "float64": Float64Batch,
    "float32": Float32Batch,
    "float32-truncated": Float32TruncatedBatch,
}


def names() -> list[str]:
    """Names of the arithmetics, sorted."""
    return sorted(_ONE_TRAIN)


def make(name: str, *, batch: bool = False) -> Arithmetic[Any]:
    """A fresh arithmetic (its counters at zero), for one train or, with ``batch``, for arrays over N trains.

    Raises :class:`~railhil.common.errors.InputError` (one line) for an unknown name.
    """
    classes = _MANY_TRAINS if batch else _ONE_TRAIN
    if name not in classes:
        raise InputError("arithmetic", "name", name, f"one of {', '.join(names())}")
    return classes[name]()
