"""OS-ELM-NGPC: as ELM-NGPC, and the output weights go on learning on-line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.estimators import Estimate, Estimator, Past
from railhil.controller_node.high_speed.learned import LearnedLaw, LearnedParameters
from railhil.controller_node.high_speed.network import Forward
from railhil.controller_node.high_speed.os_elm import Sequential, SequentialStep
from railhil.controller_node.high_speed.reals import Reals


@dataclass(frozen=True)
class OsElmParameters(LearnedParameters):
    """Parameters of the law."""

    #: The output weights learn on-line, and take up what an identification would.
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
    """The hidden layer and the first output weights are those of ELM-NGPC."""

    name = "os_elm_ngpc"
    kind = "elm"
    weights_of = "elm_ngpc"
    parameters_type = OsElmParameters

    def learned(self, re: Reals[T], forward: Forward[T], parameters: OsElmParameters) -> Estimator[T, Any]:
        step = SequentialStep(re.ar, parameters.walk)
        re.constants += step.constants
        return SequentialEstimator(forward, step, parameters.xi_reading == "newest")
