"""Linear generalized predictive control: the model alone, without an estimate of its residual."""

from __future__ import annotations

from typing import Any

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.identification import Estimator, NoEstimate
from railhil.controller_node.high_speed.law import Unit
from railhil.controller_node.high_speed.ngpc import NgpcLaw
from railhil.controller_node.vector.reals import Reals


class Gpc(NgpcLaw[T]):
    """xi = 0, as in 004 section 3; the running resistance leaves a constant lag (D6)."""

    name = "gpc"

    def estimator(self, re: Reals[T], unit: Unit, parameters: Any) -> Estimator[T, Any]:
        return NoEstimate(re)
