"""Learning of delay and 1/gain over speed and load, on a brake of which both are known."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from hil_tests.support.stops import stop_scenario
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.laws.memory import Remembered
from railhil.controller_node.stop.laws.ilc_stop import IlcStop, IlcStopParameters
from railhil.controller_node.stop.least_squares import LeastSquares, checked

STORED: Any = {"theta": [1.0, 1.0, 0.0], "covariance": [0.01, 0, 0, 0.01, 0, 0.01], "runs": 3, "last_run": 3}
DELAY_S, LAG_S, DECEL_MPS2 = 0.6, 0.4, 0.8
TRUE_S, GAIN, LOADED = 1.06, 0.97, 0.11


class Brake:
    """Runs of one train at speeds and loads that change."""

    def __init__(self, seed: int = 2) -> None:
        self.random = np.random.default_rng(seed)
        self.values: Any = None
        self.number = 0

    def run(self, *, off_m: float = 0.0, usable: float = 1.0, number: int | None = None) -> float:
        self.number = self.number + 1 if number is None else number
        squares = LeastSquares(make("float64"), self.values, DELAY_S, LAG_S)
        speed, load = self.random.uniform(12.5, 17.0), float(round(self.random.uniform(0, 100)))
        state = squares.start()
        regressors, expected = squares.distance(state, speed, DECEL_MPS2, load)
        state = squares.begin(state, 1.0, regressors, expected)
        state = squares.begin(state, 0.0, regressors, 0.0)
        needed = TRUE_S * speed + (1 / GAIN + LOADED * load / 100) * speed**2 / (2 * DECEL_MPS2)
        error = needed - DECEL_MPS2 * LAG_S**2 / 2 - expected + off_m + 0.1 * self.random.standard_normal()
        for _ in range(2):
            state = squares.step(state, usable, float(self.number), error)
        self.values = json.loads(json.dumps(squares.memory(state)))
        checked(self.values)
        return float(error)


def test_it_finds_delay_gain_and_load():
    brake = Brake()
    errors = [brake.run() for _ in range(60)]
    assert np.abs(errors[0]) > 3.0
    assert np.sqrt(np.square(errors[30:]).mean()) < 0.3
    assert brake.values["theta"][2] == pytest.approx(LOADED, abs=0.02)
    assert (brake.values["runs"], brake.values["last_run"]) == (60, 60)


@pytest.mark.parametrize("gate", [{"off_m": 38.0}, {"off_m": 5.0}, {"usable": 0.0}, {"number": 30}, {"number": 12}])
def test_gates(gate):
    brake = Brake()
    for _ in range(30):
        brake.run()
    known = brake.values
    brake.run(**gate)
    assert brake.values == known


def test_the_law_uses_and_keeps_it():
    scenario = stop_scenario()
    parameters = IlcStopParameters(learning="rls_load")
    values = {"version": 1, "records": [], "braking": {**STORED, "theta": [1.0, 1.1, 0.0]}}
    IlcStop.check_memory(scenario, values)
    law = IlcStop(make("float64"), scenario, parameters, Remembered(values))
    readings = [16000.0] * 5 + [1.0, 1.0] + [0.0] * 12
    state, _ = law.step(law.start(readings), readings)
    assert law.memory(state)["braking"] == values["braking"]
    assert state.own.now[1] == pytest.approx(1.0 * 16 + 1.1 * 16**2 / 1.6 - 0.8 * 0.4**2 / 2, abs=1e-5)


@pytest.mark.parametrize(
    "change", [{"theta": [1.0, 9.0, 0.0]}, {"covariance": [0.0] * 6}, {"covariance": [float("nan")] * 6}]
)
def test_stored_values_that_no_brake_has_are_refused(change):
    with pytest.raises(ValueError, match=r"brake|covariance"):
        checked({**STORED, **change})


def test_fixed_point_is_refused():
    with pytest.raises(InputError, match="rls_load in fixed point"):
        IlcStop(make("iq"), stop_scenario(), IlcStopParameters(learning="rls_load"))
