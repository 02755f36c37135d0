"""ELM-NGPC: the residual of the model is estimated by an extreme learning machine (004)."""

from __future__ import annotations

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.learned import LearnedLaw


class ElmNgpc(LearnedLaw[T]):
    """20 hidden nodes, output weights with ridge 10 on a dithered record (D14, D15); all of it trained offline."""

    name = "elm_ngpc"
    kind = "elm"
    weights_of = "elm_ngpc"
