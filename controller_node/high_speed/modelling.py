"""The residual of the integrated model in a record, and how well a network explains it (004 section 6, modelling)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.controller_node.high_speed.model import Sampled
from railhil.controller_node.high_speed.network import Network
from railhil.controller_node.high_speed.training import Recipe, Rows, train

FloatArray: TypeAlias = NDArray[np.float64]

#: Sampling periods for which the modelling error is reported, and the number of samples (both papers: 300).
PERIODS_S = (0.5, 1.0, 2.0, 4.0)
HELD_OUT = 300
_KMH = 3.6


def rows_of(model: Sampled, speed_mps: FloatArray, command_mps2: FloatArray) -> Rows:
    """Inputs of a network and measured residuals ``A v(k) - B u(k-1)``, from samples of shape (n,); n - 3 rows."""
    v, u = speed_mps, command_mps2
    k = np.arange(3, len(v))
    inputs = np.column_stack([v[k - 1], v[k - 2], v[k - 3], u[k - 1], u[k - 2], u[k - 3]])
    weights = np.array([*model.a, *(-b for b in model.b)])
    return Rows(inputs, v[k] + inputs @ weights)


def held_out(count: int) -> NDArray[np.bool_]:
    """Which of ``count`` rows are kept from training: :data:`HELD_OUT` of them, evenly spread over the journey; (n,).

    :raises ValueError: too few rows.
    """
    if count < 2 * HELD_OUT:
        raise ValueError(f"{count} samples, of which {HELD_OUT} are not trained on")
    chosen = np.zeros(count, dtype=np.bool_)
    chosen[np.arange(HELD_OUT) * count // HELD_OUT + count // (2 * HELD_OUT)] = True
    return chosen


@dataclass(frozen=True, slots=True)
class ModelError:
    """RMSE of the speed predicted over one sampling period, km/h, on samples that were not trained on.

    ``linear``: by the linear model; ``integrated``: with the network's residual.
    """

    linear_kmh: float
    integrated_kmh: float


def trained(rows: Rows, recipe: Recipe, period_s: float, delay_s: float, lag_s: float) -> tuple[Network, ModelError]:
    """A network trained on the rows that are not :func:`held_out`, and its error on those that are.

    :param delay_s, lag_s: of the linear model whose residual the rows contain.
    :raises ValueError: as :func:`held_out` and :func:`railhil.controller_node.high_speed.training.train`.
    """
    away = held_out(len(rows))
    network = train(rows.at(~away), recipe, period_s, delay_s, lag_s)
    judged = rows.at(away)
    left = judged.residual_mps - network.values(judged.inputs)
    return network, ModelError(_rms_kmh(judged.residual_mps), _rms_kmh(left))


def _rms_kmh(speeds_mps: FloatArray) -> float:
    return float(np.sqrt(np.mean(speeds_mps**2))) * _KMH
