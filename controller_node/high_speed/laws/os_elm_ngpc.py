"""OS-ELM-NGPC: as ELM-NGPC, and the output weights continue to learn on-line: least squares with a random walk.

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
from dataclasses import dataclass
from typing import Annotated, Any, Generic, Literal, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.high_speed.identification import Estimate, Estimator, Past
from railhil.controller_node.high_speed.learned import LearnedLaw, LearnedParameters
from railhil.controller_node.high_speed.network import Forward
from railhil.controller_node.vector.reals import Reals

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


@dataclass(frozen=True)
class OsElmParameters(LearnedParameters):
    """Parameters of the law."""

    #: The output weights learn on-line, and absorb the part that an identification would.
    ident: Literal["paper", "differenced", "off"] = "off"
    #: q: variance by which an output weight may walk between two samples, relative to that of a residual.
    walk: Annotated[float, Field(ge=0, le=1)] = 0.01
    #: D9: xi by the weights before the newest residual, or after it.
    xi_reading: Literal["predicted", "newest"] = "predicted"


class SequentialEstimator(Estimator[T, Sequential[T]]):
    """xi(k-1) by the output weights before the newest residual; the law can also use those after it (``newest``)."""

    def __init__(self, forward: Forward[T], step: SequentialStep[T], newest: bool) -> None:
        self._forward = forward
        self._step = step
        self._newest = newest

    def start(self) -> Sequential[T]:
        return self._step.start(self._forward.output)

    def step(self, memory: Sequential[T], past: Past[T], residual: T) -> tuple[Sequential[T], Estimate[T]]:
        forward = self._forward
        layer = forward.layer((*past.speeds, *past.commands))
        after = self._step.step(memory, layer, residual)
        predicted = forward.value(layer, memory.output)
        return after, Estimate(predicted, forward.value(layer, after.output) if self._newest else predicted)


class OsElmNgpc(LearnedLaw[T]):
    """The hidden layer and the first output weights are the same as in ELM-NGPC."""

    name = "os_elm_ngpc"
    kind = "elm"
    weights_of = "elm_ngpc"
    parameters_type = OsElmParameters

    def learned(self, re: Reals[T], forward: Forward[T], parameters: OsElmParameters) -> Estimator[T, Any]:
        step = SequentialStep(re.ar, parameters.walk)
        re.constants += step.constants
        return SequentialEstimator(forward, step, parameters.xi_reading == "newest")
