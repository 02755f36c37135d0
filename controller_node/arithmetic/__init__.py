"""Number systems for control laws: one interface, float64 and C28x fixed point, for one train or for N."""

from __future__ import annotations

from typing import Any

from controller_node.arithmetic.base import Arithmetic
from controller_node.arithmetic.float64 import Float64, Float64Batch
from controller_node.arithmetic.iq import Iq, IqBatch
from scenarios.errors import InputError

_ONE_TRAIN: dict[str, type[Arithmetic[Any]]] = {"iq": Iq, "float64": Float64}
_MANY_TRAINS: dict[str, type[Arithmetic[Any]]] = {"iq": IqBatch, "float64": Float64Batch}


def names() -> list[str]:
    """Names of the arithmetics, sorted."""
    return sorted(_ONE_TRAIN)


def make(name: str, *, batch: bool = False) -> Arithmetic[Any]:
    """A fresh arithmetic (its counters at zero), for one train or, with ``batch``, for arrays over N trains.

    Raises :class:`~scenarios.errors.InputError` (one line) for an unknown name.
    """
    classes = _MANY_TRAINS if batch else _ONE_TRAIN
    if name not in classes:
        raise InputError("arithmetic", "name", name, f"one of {', '.join(names())}")
    return classes[name]()
