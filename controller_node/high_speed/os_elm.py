"""Sequential training of an ELM's output weights on-line (OS-ELM), a pure step: least squares with a random walk.

The hidden layer stays as it was trained; the output weights are the state of a Kalman filter whose measurement is the
residual. With the symmetric matrix P, the outputs h of the hidden layer and the new residual xi::

    P <- P + q I
    g  = P h / (1 + h' P h)
    w <- w + g (xi - h' w)
    P <- P - g (P h)'

q is the variance by which each weight may walk between two samples, relative to that of a residual.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T

#: Format stated where the arithmetics ask for one; the laws with networks need an arithmetic without formats.
_Q = 16


class Sequential(NamedTuple, Generic[T]):
    """State: ``output`` (L,), and the lower triangle of P, row i with i + 1 numbers."""

    output: tuple[T, ...]
    covariance: tuple[tuple[T, ...], ...]


class SequentialStep(Generic[T]):
    """The step on an arithmetic.

    :param walk: q.
    """

    def __init__(self, ar: Arithmetic[T], walk: float) -> None:
        self._ar = ar
        self.constants = (
            Constant("os_zero", 0.0, _Q, "OS-ELM"),
            Constant("os_one", 1.0, _Q, "OS-ELM"),
            Constant("os_walk", walk, _Q, "parameters"),
        )
        self._zero, self._one, self._walk = ar.load(self.constants)

    def start(self, output: Sequence[T]) -> Sequential[T]:
        """The state before the first sample: the trained weights, P = 0."""
        rows = tuple((self._zero,) * (i + 1) for i in range(len(output)))
        return Sequential(tuple(output), rows)

    def step(self, state: Sequential[T], layer: Sequence[T], residual: T) -> Sequential[T]:
        """The state after a sample: ``layer`` h (L,), ``residual`` xi in m/s."""
        ar, count = self._ar, len(layer)
        grown = [(*row[:-1], ar.add(row[-1], self._walk)) for row in state.covariance]
        spread = [ar.dot([grown[max(i, j)][min(i, j)] for j in range(count)], layer, _Q) for i in range(count)]
        size = ar.add(self._one, ar.dot(spread, layer, _Q))
        gain = [ar.div(value, size, _Q) for value in spread]
        error = ar.sub(residual, ar.dot(state.output, layer, _Q))
        output = tuple(
            ar.add(weight, ar.mpy(share, error, _Q)) for weight, share in zip(state.output, gain, strict=True)
        )
        covariance = tuple(
            tuple(ar.sub(value, ar.mpy(gain[i], spread[j], _Q)) for j, value in enumerate(row))
            for i, row in enumerate(grown)
        )
        return Sequential(output, covariance)
