"""RES-NGPC: the papers' control law with the low-passed residual of the model in place of a network."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.identification import Estimator, LowPass
from railhil.controller_node.high_speed.law import Unit
from railhil.controller_node.high_speed.ngpc import GpcParameters, NgpcLaw
from railhil.controller_node.vector.reals import Reals


@dataclass(frozen=True)
class ResNgpcParameters(GpcParameters):
    """Parameters of the law."""

    #: Weight of the newest residual in the low-pass.
    smoothing: Annotated[float, Field(gt=0, le=1)] = 0.2
    #: D9: xi before the newest residual, or after it.
    xi_reading: Literal["predicted", "newest"] = "predicted"


class ResNgpc(NgpcLaw[T]):
    """The honest baseline beside every network."""

    name = "res_ngpc"
    parameters_type = ResNgpcParameters

    def estimator(self, re: Reals[T], unit: Unit, parameters: ResNgpcParameters) -> Estimator[T, Any]:
        return LowPass(re, parameters.smoothing, parameters.xi_reading)
