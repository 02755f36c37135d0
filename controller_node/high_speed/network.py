"""A network that estimates the residual of the integrated model: six inputs, one hidden layer of sigmoids, one output.

``xi = output_bias + sum_j output[j] sigmoid(bias[j] + sum_i hidden[j][i] scaled_i)``, with
``scaled_i = (x_i - offset[i]) * scale[i]`` and x = [v(k-1), v(k-2), v(k-3), u(k-1), u(k-2), u(k-3)], speeds in m/s and
commands in m/s^2 (ELM: 004 eqs. 16 and 17; BP: the same layers, with a bias at the output).

The sigmoid is one table with linear interpolation, in training and on-line, in Python and in C: 1 / (1 + exp(-x)) is
read from 257 samples on 0..12; for negative x it is 1 - sigmoid(-x), beyond +-12 the last sample. The exponential
function of a C library differs between machines in its last bits, so the samples come from decimal arithmetic, which is
rounded correctly everywhere. The largest distance to the true sigmoid is 2.7e-5 (cells of 12/256, second derivative at
most 0.0963). Networks are trained with this function, so the distance is no error of theirs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, localcontext
from typing import Annotated, Any, Generic, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

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

SIGMOID_CONSTANTS = (_SHORTEN, _ZERO, _ONE_IN, _ONE_OUT, *_CURVE.samples)


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


#: Speeds and commands of the last three samples.
INPUTS = 6
#: Largest hidden layer: a step of a larger one would be long, and its export large.
HIDDEN_MAX = 100

Number = Annotated[float, Field(allow_inf_nan=False)]
Seconds = Annotated[float, Field(gt=0, le=60)]
Six = Annotated[tuple[Number, ...], Field(min_length=INPUTS, max_length=INPUTS)]
Row = Annotated[tuple[Number, ...], Field(min_length=1, max_length=HIDDEN_MAX)]


@dataclass(frozen=True)
class Network:
    """The numbers of a trained network; in a parameter file the table ``[parameters.network]``.

    ``sample_period_s``, ``model_delay_s``, ``model_lag_s``: of the linear model whose residual it has learned; a law
    with another model refuses it. ``offset`` and ``scale``: of the inputs. ``hidden``: a row of six for each hidden
    node; ``bias``, ``output``: a number for each.

    :raises ValueError: the rows have different lengths.
    """

    kind: Literal["elm", "bp"]
    sample_period_s: Seconds
    model_delay_s: Seconds
    model_lag_s: Seconds
    offset: Six
    scale: Six
    hidden: Annotated[tuple[Six, ...], Field(min_length=1, max_length=HIDDEN_MAX)]
    bias: Row
    output: Row
    output_bias: Number = 0.0
    #: Version of this format.
    format: Literal[1] = 1

    def __post_init__(self) -> None:
        for name, row in (("bias", self.bias), ("output", self.output)):
            if len(row) != len(self.hidden):
                raise ValueError(f"{name} has {len(row)} numbers for {len(self.hidden)} hidden nodes")

    @property
    def nodes(self) -> int:
        """Number L of hidden nodes."""
        return len(self.hidden)

    def layer(self, inputs: Any) -> FloatArray:
        """Outputs of the hidden layer (matrix H of 004 eq. 16) for inputs of shape (n, 6); shape (n, L)."""
        return hidden_layer(scaled_inputs(inputs, self.offset, self.scale), np.array(self.hidden), np.array(self.bias))

    def values(self, inputs: Any) -> FloatArray:
        """Estimated residuals in m/s for inputs of shape (n, 6); shape (n,)."""
        return np.asarray(self.layer(inputs) @ np.array(self.output) + self.output_bias)


def scaled_inputs(inputs: Any, offset: Sequence[float], scale: Sequence[float]) -> FloatArray:
    """Inputs of shape (n, 6), each with its offset taken away and multiplied by its scale."""
    return np.asarray((np.asarray(inputs, dtype=np.float64) - np.array(offset)) * np.array(scale))


def hidden_layer(scaled: FloatArray, hidden: FloatArray, bias: FloatArray) -> FloatArray:
    """Sigmoids of the hidden nodes, shape (n, L), from scaled inputs (n, 6), weights (L, 6) and biases (L,).

    Sums are taken in the order of the inputs, so the result has the same bits on every machine.
    """
    total = np.zeros((scaled.shape[0], hidden.shape[0]))
    for i in range(scaled.shape[1]):
        total = total + scaled[:, i : i + 1] * hidden[:, i]
    return sigmoid_of(total + bias)


class Forward(Generic[T]):
    """A network on an arithmetic: a pure step from six inputs to the residual. The float arithmetics have no formats,
    so a law with a network does not run in fixed point."""

    def __init__(self, ar: Arithmetic[T], network: Network) -> None:
        def numbers(name: str, values: Sequence[float]) -> tuple[Constant, ...]:
            return tuple(Constant(f"{name}[{i}]", value, 0, "weights file") for i, value in enumerate(values))

        self._ar = ar
        self._raws = (
            numbers("offset", network.offset),
            numbers("scale", network.scale),
            numbers("bias", network.bias),
            numbers("output", network.output),
            *(numbers(f"hidden[{j}]", row) for j, row in enumerate(network.hidden)),
        )
        self._output_bias_raw = Constant("output_bias", network.output_bias, 0, "weights file")
        self._offset, self._scale, self._bias, self.output, *self._hidden = map(ar.load, self._raws)
        self._output_bias = ar.const(self._output_bias_raw)

    @property
    def constants(self) -> tuple[Constant, ...]:
        """All of its constants, the sigmoid's last."""
        return (*(item for row in self._raws for item in row), self._output_bias_raw, *SIGMOID_CONSTANTS)

    def layer(self, inputs: Sequence[T]) -> tuple[T, ...]:
        """Outputs of the hidden nodes for the six inputs."""
        ar = self._ar
        scaled = tuple(
            ar.mpy(ar.sub(value, offset), scale, ARGUMENT_Q)
            for value, offset, scale in zip(inputs, self._offset, self._scale, strict=True)
        )
        return tuple(
            sigmoid(ar, ar.add(ar.dot(row, scaled, ARGUMENT_Q), bias))
            for row, bias in zip(self._hidden, self._bias, strict=True)
        )

    def value(self, layer: Sequence[T], output: Sequence[T]) -> T:
        """The output of the network for these outputs of the hidden nodes and these output weights, m/s."""
        return self._ar.add(self._ar.dot(output, layer, RESULT_Q), self._output_bias)
