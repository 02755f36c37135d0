"""Offline training of the networks in double precision, and their error on a record (004 section 6, modelling).

ELM is trained by least squares, BP by a gradient method.

Both learn the residual of the integrated model, ``xi(k) = v(k) - v_model(k)``, from rows of six inputs. A given seed
gives the same network each time. With ridge, an ELM has the same bits on every machine: its sums are exact
(``math.fsum``) and its linear system is solved by a Cholesky decomposition written out here. ``pinv`` (singular value
decomposition) and BP use the linear algebra of numpy and scipy, which differs between machines in the last bits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.controller_node.high_speed.model import Sampled
from railhil.controller_node.high_speed.network import INPUTS, Network, hidden_layer, scaled_inputs, slope_of
from railhil.scenarios.streams import generator

FloatArray: TypeAlias = NDArray[np.float64]

#: Stream of the random numbers of a training, beside those of a run (:mod:`railhil.scenarios.streams`).
TRAINING = 20
#: Iterations of BP at most, and its weight decay: without one its weights grow until it fits the noise.
BP_ITERATIONS = 500
BP_DECAY = 3e-3


@dataclass(frozen=True)
class Rows:
    """Training data: ``inputs`` (n, 6) as in :class:`Network`, ``residual_mps`` (n,)."""

    inputs: FloatArray
    residual_mps: FloatArray

    def __len__(self) -> int:
        return len(self.residual_mps)

    def at(self, where: NDArray[np.bool_]) -> Rows:
        """The rows for which ``where`` (n,) is true."""
        return Rows(self.inputs[where], self.residual_mps[where])


@dataclass(frozen=True)
class Recipe:
    """Options of training a network.

    ``kind``: ``elm`` or ``bp``. ``hidden``: number L of hidden nodes. ``ridge``: weight of the squared output weights
    in the least squares of an ELM; None: pseudo-inverse (004 eq. 16). ``seed``: of the random hidden layer,
    which an ELM keeps and BP starts from.
    """

    kind: Literal["elm", "bp"] = "elm"
    hidden: int = 20
    ridge: float | None = 10.0
    seed: int = 1


def train(rows: Rows, recipe: Recipe, sample_period_s: float, model_delay_s: float, model_lag_s: float) -> Network:
    """The trained network.

    :param sample_period_s, model_delay_s, model_lag_s: of the linear model whose residual the rows contain.
    :raises ValueError: fewer rows than hidden nodes, or a ridge that leaves the linear system singular.
    """
    if len(rows) < recipe.hidden:
        raise ValueError(f"{len(rows)} rows for {recipe.hidden} hidden nodes")
    middle, scale = input_scaling(rows.inputs)
    random = generator(recipe.seed, TRAINING)
    hidden = random.uniform(-1.0, 1.0, (recipe.hidden, INPUTS))
    bias = random.uniform(-1.0, 1.0, recipe.hidden)
    output_bias = 0.0
    if recipe.kind == "elm":
        layer = hidden_layer(scaled_inputs(rows.inputs, middle, scale), hidden, bias)
        output = output_weights(layer, rows.residual_mps, recipe.ridge)
    else:
        hidden, bias, output, output_bias = _back_propagated(rows, middle, scale, hidden, bias)
    return Network(
        recipe.kind,
        sample_period_s,
        model_delay_s,
        model_lag_s,
        middle,
        scale,
        tuple(tuple(row) for row in hidden.tolist()),
        tuple(bias.tolist()),
        tuple(output.tolist()),
        output_bias,
    )


def input_scaling(inputs: FloatArray) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Offset and scale that take each input of the rows to -1..1; speeds share one pair, commands another."""
    offsets, scales = [], []
    for group in (inputs[:, : INPUTS // 2], inputs[:, INPUTS // 2 :]):
        low, high = float(group.min()), float(group.max())
        offsets += [(low + high) / 2] * (INPUTS // 2)
        scales += [2 / (high - low) if high > low else 1.0] * (INPUTS // 2)
    return tuple(offsets), tuple(scales)


def output_weights(layer: FloatArray, target: FloatArray, ridge: float | None) -> FloatArray:
    """Output weights of an ELM for the hidden layer's outputs (n, L) and the targets (n,); shape (L,).

    With ``ridge`` the solution of (H'H + ridge I) beta = H't, without it pinv(H) t.

    :raises ValueError: the matrix is not positive definite.
    """
    if ridge is None:
        return np.asarray(np.linalg.pinv(layer) @ target)
    columns = [column.tolist() for column in layer.T]
    goal = target.tolist()
    count = len(columns)
    normal = [[_product(columns[i], columns[j]) for j in range(i + 1)] for i in range(count)]
    for i in range(count):
        normal[i][i] += ridge
    return np.array(_cholesky_solution(normal, [_product(column, goal) for column in columns]))


def _product(first: list[float], second: list[float]) -> float:
    return math.fsum(map(float.__mul__, first, second))


def _cholesky_solution(lower: list[list[float]], right: list[float]) -> list[float]:
    """Solution of a symmetric positive definite system given by its lower triangle.

    :raises ValueError: it is not positive definite.
    """
    count = len(right)
    factor: list[list[float]] = []
    for i in range(count):
        row: list[float] = []
        for j in range(i):
            row.append((lower[i][j] - _product(row, factor[j][:j])) / factor[j][j])
        left = lower[i][i] - _product(row, row)
        if not left > 0.0:
            raise ValueError("the least squares have no unique solution: a larger ridge, or pinv")
        factor.append([*row, math.sqrt(left)])
    forward: list[float] = []
    for i in range(count):
        forward.append((right[i] - _product(factor[i][:i], forward)) / factor[i][i])
    found = [0.0] * count
    for i in reversed(range(count)):
        above = [factor[j][i] for j in range(i + 1, count)]
        found[i] = (forward[i] - _product(above, found[i + 1 :])) / factor[i][i]
    return found


def _back_propagated(
    rows: Rows, offset: tuple[float, ...], scale: tuple[float, ...], hidden: FloatArray, bias: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Weights of a BP network: all of them by L-BFGS on the mean square error plus weight decay, from ``hidden``,
    ``bias`` and zero output. The gradient is back-propagation's."""
    # scipy takes a third of a second to import.
    from scipy.optimize import minimize

    inputs = scaled_inputs(rows.inputs, offset, scale)
    spread = float(rows.residual_mps.std()) or 1.0
    target = rows.residual_mps / spread
    nodes, count = hidden.shape[0], len(rows)

    def parts(flat: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, float]:
        edge = nodes * INPUTS
        return flat[:edge].reshape(nodes, INPUTS), flat[edge : edge + nodes], flat[edge + nodes : -1], float(flat[-1])

    def cost(flat: FloatArray) -> tuple[float, FloatArray]:
        weights, biases, output, output_bias = parts(flat)
        sums = inputs @ weights.T + biases
        layer = hidden_layer(inputs, weights, biases)
        error = layer @ output + output_bias - target
        back = (error[:, None] * output) * slope_of(sums)
        gradient = np.concatenate(
            [(back.T @ inputs).ravel(), back.sum(axis=0), layer.T @ error, np.array([error.sum()])]
        )
        decay = BP_DECAY * flat
        return float(error @ error / count + BP_DECAY / 2 * flat @ flat), 2 * gradient / count + decay

    start = np.concatenate([hidden.ravel(), bias, np.zeros(nodes + 1)])
    found = minimize(cost, start, jac=True, method="L-BFGS-B", options={"maxiter": BP_ITERATIONS})
    weights, biases, output, output_bias = parts(np.asarray(found.x))
    return weights, biases, output * spread, output_bias * spread


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


def select_held_out(count: int) -> NDArray[np.bool_]:
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
    """RMSE of the speed predicted over one sampling period, km/h, on samples outside the training.

    ``linear``: by the linear model; ``integrated``: with the network's residual.
    """

    linear_kmh: float
    integrated_kmh: float


def train_and_judge(
    rows: Rows, recipe: Recipe, period_s: float, delay_s: float, lag_s: float
) -> tuple[Network, ModelError]:
    """A network trained on the rows that are not :func:`select_held_out`, and its error on the others.

    :param delay_s, lag_s: of the linear model whose residual the rows contain.
    :raises ValueError: as :func:`select_held_out` and :func:`railhil.controller_node.high_speed.training.train`.
    """
    away = select_held_out(len(rows))
    network = train(rows.at(~away), recipe, period_s, delay_s, lag_s)
    judged = rows.at(away)
    left = judged.residual_mps - network.values(judged.inputs)
    return network, ModelError(_rms_kmh(judged.residual_mps), _rms_kmh(left))


def _rms_kmh(speeds_mps: FloatArray) -> float:
    return float(np.sqrt(np.mean(speeds_mps**2))) * _KMH
