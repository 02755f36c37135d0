"""BP-NGPC: the residual of the model is estimated by a back-propagation network (002)."""

from __future__ import annotations

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.learned import LearnedLaw


class BpNgpc(LearnedLaw[T]):
    """20 hidden nodes, all weights by a gradient method with weight decay; trained offline, unlike in 002."""

    name = "bp_ngpc"
    kind = "bp"
    weights_of = "bp_ngpc"
