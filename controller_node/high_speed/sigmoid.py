"""The sigmoid of the networks: one table with linear interpolation, in training and on-line, in Python and in C.

1 / (1 + exp(-x)) is read from 257 samples on 0..12; for negative x it is 1 - sigmoid(-x), beyond +-12 the last sample.
The exponential function of a C library differs between machines in its last bits, so the samples come from decimal
arithmetic, which is rounded correctly everywhere. The largest distance to the true sigmoid is 2.7e-5 (cells of 12/256,
second derivative at most 0.0963). Networks are trained with this function: the distance is no error of theirs.
"""

from __future__ import annotations

from decimal import Decimal, localcontext
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, Curve, T

FloatArray: TypeAlias = NDArray[np.float64]

#: The table covers 0..REACH.
REACH = 12.0
#: Format of argument and result where an arithmetic has formats.
ARGUMENT_Q = 20
RESULT_Q = 24
_CELLS = 256


def _sample(index: int) -> float:
    """The true sigmoid at ``REACH`` * index / 256, rounded once."""
    with localcontext() as context:
        context.prec = 40
        return float(1 / (1 + (-Decimal(REACH) * index / _CELLS).exp()))


_SAMPLES = tuple(_sample(index) for index in range(_CELLS + 1))


def _interpolated(part: float) -> float:
    """The table at ``part`` (0..1) of its length, by the operations of the arithmetics."""
    scaled = part * _CELLS
    index = int(min(scaled, _CELLS - 1.0))
    return _SAMPLES[index] + (_SAMPLES[index + 1] - _SAMPLES[index]) * (scaled - index)


_CURVE = Curve(
    "sigmoid",
    _interpolated,
    ARGUMENT_Q,
    RESULT_Q,
    tuple(Constant(f"sigmoid[{i}]", value, RESULT_Q, "1 / (1 + exp(-x))") for i, value in enumerate(_SAMPLES)),
)
_SHORTEN = Constant("sigmoid_shorten", 1 / REACH, ARGUMENT_Q, "1 / length of the table")
_ZERO = Constant("sigmoid_zero", 0.0, ARGUMENT_Q, "sigmoid")
_ONE_IN = Constant("sigmoid_end", 1.0, ARGUMENT_Q, "end of the table")
_ONE_OUT = Constant("sigmoid_one", 1.0, RESULT_Q, "sigmoid")

CONSTANTS = (_SHORTEN, _ZERO, _ONE_IN, _ONE_OUT, *_CURVE.samples)


def sigmoid(ar: Arithmetic[T], x: T) -> T:
    """The sigmoid of ``x`` (Q ``ARGUMENT_Q``), result in Q ``RESULT_Q``."""
    zero, one = ar.const(_ZERO), ar.const(_ONE_OUT)
    part = ar.minimum(ar.mpy(ar.abs(x), ar.const(_SHORTEN), ARGUMENT_Q), ar.const(_ONE_IN))
    right = ar.curve(_CURVE, part)
    return ar.where(ar.gt(zero, x), ar.sub(one, right), right)


def sigmoid_of(x: Any) -> FloatArray:
    """The same for an array of any shape in double precision: the bits of :func:`sigmoid` in float64."""
    given = np.asarray(x, dtype=np.float64)
    samples = np.array(_SAMPLES)
    scaled = np.minimum(np.abs(given) * (1 / REACH), 1.0) * _CELLS
    index = np.minimum(scaled, _CELLS - 1.0).astype(np.int64)
    right = samples[index] + (samples[index + 1] - samples[index]) * (scaled - index)
    return np.asarray(np.where(given < 0.0, 1.0 - right, right))


def slope_of(x: Any) -> FloatArray:
    """Derivative of the true sigmoid, which training by gradients uses; shape as ``x``."""
    value = sigmoid_of(x)
    return np.asarray(value * (1.0 - value))
