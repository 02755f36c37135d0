"""Networks of the high-speed laws: sigmoid, forward pass, training, sequential step, each against plain numpy."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace

import numpy as np
import pytest

from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import Constant
from railhil.controller_node.high_speed.laws.os_elm_ngpc import SequentialStep
from railhil.controller_node.high_speed.network import REACH, SIGMOID_CONSTANTS, Forward, Network, sigmoid, sigmoid_of
from railhil.controller_node.high_speed.training import Recipe, Rows, input_scaling, output_weights, train

#: Sampling period, delay and lag of the linear model.
MODEL = (1.0, 0.5, 0.4)
#: Arithmetics without formats.
WIDE = ("float64", "float32", "float32-truncated")


def samples(count: int = 400, seed: int = 3) -> Rows:
    """Rows of a train between 0 and 300 km/h whose residual is the running resistance, with noise."""
    random = np.random.default_rng(seed)
    v = np.linspace(0.0, 83.0, count)[:, None] + 0.02 * random.standard_normal((count, 3))
    u = 0.1 * random.standard_normal((count, 3))
    residual = -0.05 - 0.07 * (v[:, 0] / 83.0) ** 2 + 0.1 * u[:, 2] + 0.02 * random.standard_normal(count)
    return Rows(np.column_stack([v, u]), residual)


@pytest.fixture(scope="module")
def network() -> Network:
    return train(samples(), Recipe(), *MODEL)


def test_the_sigmoid_is_within_its_stated_error_everywhere() -> None:
    x = np.linspace(-30.0, 30.0, 600_001)
    assert np.abs(sigmoid_of(x) - 1 / (1 + np.exp(-x))).max() < 2.7e-5


def test_the_samples_of_the_sigmoid_are_the_same_bits_on_every_machine() -> None:
    text = ",".join(constant.value.hex() for constant in SIGMOID_CONSTANTS)
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == "c35fa7f9f8469312"


def test_training_and_law_have_one_sigmoid_to_the_bit() -> None:
    x = np.concatenate([np.linspace(-14.0, 14.0, 4001), [0.0, -0.0, REACH, -REACH, 1e9, -1e9]])
    one, many = make("float64"), make("float64", batch=True)
    wanted = sigmoid_of(x)
    assert [sigmoid(one, value) for value in x.tolist()] == wanted.tolist()
    assert np.array_equal(sigmoid(many, x), wanted)


@pytest.mark.parametrize("name", WIDE[1:])
def test_the_sigmoid_in_single_precision_is_the_same_for_one_and_for_many(name: str) -> None:
    x = np.linspace(-14.0, 14.0, 2001)
    one, many = make(name), make(name, batch=True)
    singles = [one.operand(value) for value in x.tolist()]
    found = [sigmoid(one, value) for value in singles]
    assert sigmoid(many, many.operand(x)).tolist() == found
    assert np.abs(np.array(found) - sigmoid_of(x)).max() < 3e-7


def test_the_forward_pass_is_that_of_the_training(network: Network) -> None:
    rows = samples(50, 4)
    ar = make("float64")
    forward = Forward(ar, network)
    layers = [forward.layer(row) for row in rows.inputs.tolist()]
    assert np.array_equal(np.array(layers), network.layer(rows.inputs))
    values = [forward.value(layer, forward.output) for layer in layers]
    assert np.abs(np.array(values) - network.values(rows.inputs)).max() < 1e-14


def test_the_forward_pass_in_single_precision_is_close(network: Network) -> None:
    rows = samples(50, 4)
    for name in WIDE[1:]:
        ar = make(name)
        forward = Forward(ar, network)
        found = [
            forward.value(forward.layer([ar.operand(x) for x in row]), forward.output) for row in rows.inputs.tolist()
        ]
        assert np.abs(np.array(found) - network.values(rows.inputs)).max() < 2e-6


def test_the_network_learns_the_residual() -> None:
    rows, fresh = samples(), samples(seed=8)
    for recipe in (Recipe(ridge=None), Recipe("bp", hidden=8)):
        found = train(rows, recipe, *MODEL).values(fresh.inputs) - fresh.residual_mps
        # The noise of the residual is 0.02.
        assert 0.018 < float(found.std()) < 0.0225, recipe


def test_ridge_solves_the_normal_equations() -> None:
    random = np.random.default_rng(5)
    layer, target = random.random((60, 7)), random.random(60)
    wanted = np.linalg.solve(layer.T @ layer + 0.5 * np.eye(7), layer.T @ target)
    assert np.allclose(output_weights(layer, target, 0.5), wanted, rtol=1e-10)
    assert np.allclose(output_weights(layer, target, None), np.linalg.lstsq(layer, target)[0], rtol=1e-9)


def test_ridge_gives_the_same_bits_on_every_machine(network: Network) -> None:
    # No sum depends on the order in which a library adds, and no function is the C library's.
    text = ",".join(weight.hex() for weight in network.output)
    assert hashlib.sha256(text.encode()).hexdigest()[:16] == "1da5965f14f2547e"


@pytest.mark.slow
def test_a_seed_gives_one_network(network: Network) -> None:
    rows = samples()
    assert train(rows, Recipe(), *MODEL) == network
    assert train(rows, Recipe(seed=2), *MODEL).hidden != network.hidden
    bp = Recipe("bp", hidden=4)
    assert train(rows, bp, *MODEL) == train(rows, bp, *MODEL)


def test_too_few_rows_and_a_singular_system_are_refused() -> None:
    with pytest.raises(ValueError, match="5 rows for 20 hidden nodes"):
        train(Rows(np.zeros((5, 6)), np.zeros(5)), Recipe(), *MODEL)
    with pytest.raises(ValueError, match="no unique solution"):
        output_weights(np.ones((9, 2)), np.ones(9), 0.0)


def test_rows_of_one_value_have_a_scale() -> None:
    assert input_scaling(np.zeros((3, 6))) == ((0.0,) * 6, (1.0,) * 6)


def test_rows_of_different_lengths_are_refused(network: Network) -> None:
    with pytest.raises(ValueError, match="bias has 2 numbers for 20 hidden nodes"):
        replace(network, bias=(0.0, 1.0))


def test_sequential_training_against_matrices(network: Network) -> None:
    ar = make("float64")
    step = SequentialStep(ar, 0.01)
    state = step.start([ar.const(Constant("w", value, 0)) for value in network.output])
    covariance, weights = np.zeros((network.nodes, network.nodes)), np.array(network.output)
    rows = samples(60, 6)
    for layer, residual in zip(network.layer(rows.inputs), rows.residual_mps, strict=True):
        covariance = covariance + 0.01 * np.eye(network.nodes)
        spread = covariance @ layer
        gain = spread / (1 + layer @ spread)
        weights = weights + gain * (residual - layer @ weights)
        covariance = covariance - np.outer(gain, spread)
        state = step.step(state, layer.tolist(), float(residual))
    assert np.allclose(state.output, weights, atol=1e-12)
    assert all(math.isclose(row[i], covariance[i, i], rel_tol=1e-9) for i, row in enumerate(state.covariance))


@pytest.mark.long
@pytest.mark.slow
def test_sequential_training_in_single_precision_stays_close(network: Network) -> None:
    rows = samples(300, 6)
    layers = network.layer(rows.inputs)
    ends = {}
    for name in WIDE:
        ar = make(name)
        step = SequentialStep(ar, 0.01)
        operand = getattr(ar, "operand", float)
        state = step.start([operand(value) for value in network.output])
        for layer, residual in zip(layers.tolist(), rows.residual_mps.tolist(), strict=True):
            state = step.step(state, [operand(value) for value in layer], operand(residual))
        ends[name] = np.array(state.output) @ layers[-1]
    assert abs(ends["float32"] - ends["float64"]) < 2e-5
    assert abs(ends["float32-truncated"] - ends["float64"]) < 1e-3
