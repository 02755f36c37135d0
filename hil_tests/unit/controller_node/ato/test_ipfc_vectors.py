"""The IPFC law against ten single steps with every intermediate, in float64 and in fixed point."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hil_tests.support.ipfc_steps import BASIS, STEPS, VECTORS
from railhil.common.errors import InputError
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.float64 import Float64
from railhil.controller_node.ato.ipfc_constants import RISE_Q, IpfcParameters
from railhil.controller_node.ato.laws.ipfc import Ipfc, IpfcState
from railhil.controller_node.ato.pfc_constants import GAIN_Q
from railhil.controller_node.ato.pfc_model import SOFTENING_Q
from railhil.controller_node.laws import load, names
from railhil.controller_node.laws.base import NOTCH_RAW_Q, SPEED_Q, LawInputs
from railhil.scenarios.load import load as load_scenario

SCENARIO = load_scenario("lvshun_tieshan")


class Noting(Float64):
    """Keeps what the law notes, by name; ``c`` and the like as lists."""

    def __init__(self) -> None:
        super().__init__()
        self.values: dict[str, Any] = {}

    def note(self, name: str, a: float, q: int, unit: str = "") -> float:
        self.values[name] = a
        return a

    def note_all(self, name: str, values: Any, q: int, unit: str = "") -> tuple[float, ...]:
        self.values[name] = tuple(values)
        return tuple(values)


def raw(value: float, q: int) -> int:
    return math.floor(value * 2**q + 0.5)


def float_step(vector: dict[str, Any], law: Ipfc[float] | None = None) -> Any:
    state, given = vector["state"], vector["input"]
    law = law or Ipfc(Noting(), SCENARIO)
    before = IpfcState(tuple(state["X"]), state["u_prev"], tuple(state["e_hist"]), state["e_prev"])
    new_state, outputs = law.step(before, LawInputs(given["y"], given["r0"], given["rf"]))
    return new_state, outputs, law._ar.values


def iq_step(vector: dict[str, Any], arithmetic: Any = None) -> Any:
    state, given = vector["state"], vector["input"]
    before = IpfcState(
        tuple(raw(x, GAIN_Q) for x in state["X"]),
        raw(state["u_prev"], GAIN_Q),
        tuple(raw(e, SPEED_Q) for e in state["e_hist"]),
        raw(state["e_prev"], SPEED_Q),
    )
    preview = [raw(r, SPEED_Q) for r in given["rf"]]
    inputs = LawInputs(raw(given["y"], SPEED_Q), raw(given["r0"], SPEED_Q), preview)
    return Ipfc(arithmetic or make("iq"), SCENARIO).step(before, inputs)


def test_there_are_ten_steps() -> None:
    assert len(STEPS) == 10


@pytest.mark.parametrize("name", STEPS)
def test_float64_meets_every_intermediate(name: str) -> None:
    expected = STEPS[name]["output"]
    state, outputs, noted = float_step(STEPS[name])
    for key, value in {
        "ym": noted["y_m"],
        "t_s": noted["t_s"],
        "mu_ts": noted["mu_ts"],
        "mu_y": noted["mu_y"],
        "mu": noted["mu"],
        "alpha": noted["alpha"],
        "c": noted["c"],
        "e_n": noted["e"],
        "d": noted["d"],
        "u_raw": outputs.notch_raw,
    }.items():
        np.testing.assert_allclose(value, expected[key], rtol=0, atol=1e-9, err_msg=key)
    assert outputs.notes[0] == BASIS[expected["basis"]]
    assert outputs.notch * 256 == expected["notch_code"]
    assert outputs.notes[1] == noted["alpha"]
    assert outputs.notes[2] == noted["mu"]
    assert state.notch == outputs.notch
    assert state.model_errors[:-1] == tuple(STEPS[name]["state"]["e_hist"][1:])


@pytest.mark.parametrize("name", STEPS)
def test_fixed_point_is_within_2e_4_notch(name: str) -> None:
    expected = STEPS[name]["output"]
    arithmetic = make("iq")
    _, outputs = iq_step(STEPS[name], arithmetic)
    assert outputs.notch == expected["notch_code"]
    assert outputs.notes[0] == BASIS[expected["basis"]]
    assert outputs.notes[1] / 2**SOFTENING_Q == pytest.approx(expected["alpha"], abs=1e-6)
    assert arithmetic.counters.wraps == 0
    if name == "syn_sat_high":
        # Two deviations and more lie beyond the 100 km/h at which fixed point saturates, the notch beyond its range.
        assert arithmetic.counters.saturations >= 2
        assert outputs.notch_raw / 2**NOTCH_RAW_Q > 7
    else:
        assert arithmetic.counters.saturations == 0
        assert outputs.notch_raw / 2**NOTCH_RAW_Q == pytest.approx(expected["u_raw"], abs=2e-4)


@pytest.mark.parametrize("row", VECTORS["mu_ts"])
def test_satisfaction_with_the_rise_time(row: dict[str, float]) -> None:
    assert Ipfc(Float64(), SCENARIO).rise_satisfaction(row["t_s"]) == pytest.approx(row["mu"], abs=1e-9)
    law: Ipfc[int] = Ipfc(make("iq"), SCENARIO)
    # 0.06 us is one LSB of t_s: on a flank of 6 ms it moves the satisfaction by 1e-5.
    assert law.rise_satisfaction(raw(row["t_s"], RISE_Q)) / 2**24 == pytest.approx(row["mu"], abs=2e-5)


@pytest.mark.parametrize("row", VECTORS["mu_y"])
def test_satisfaction_with_a_predicted_speed(row: dict[str, float]) -> None:
    miss = row["y"] - (row["lo"] + row["hi"]) / 2
    assert Ipfc(Float64(), SCENARIO).speed_satisfaction(miss, miss) == pytest.approx(row["mu"], abs=1e-9)
    law: Ipfc[int] = Ipfc(make("iq"), SCENARIO)
    assert law.speed_satisfaction(raw(miss, SPEED_Q), raw(miss, SPEED_Q)) / 2**24 == pytest.approx(row["mu"], abs=2e-4)


def test_satisfaction_is_that_of_the_worse_extreme() -> None:
    law = Ipfc(Float64(), SCENARIO)
    assert law.speed_satisfaction(-0.03, 0.01) == pytest.approx(0.5)
    assert law.speed_satisfaction(-0.03, 0.036) == pytest.approx(0.2)


@pytest.mark.parametrize("row", VECTORS["alpha"])
def test_softening_factor(row: dict[str, float]) -> None:
    law = Ipfc(Float64(), SCENARIO)
    assert law.softening(row["mu"]) == pytest.approx(row["alpha"], abs=1e-9)
    fixed: Ipfc[int] = Ipfc(make("iq"), SCENARIO)
    assert fixed.softening(raw(row["mu"], 24)) / 2**30 == pytest.approx(row["alpha"], abs=2e-6)


@pytest.mark.parametrize("arithmetic", ["float64", "iq"])
def test_first_step_of_a_cubic_launch_asks_for_some_brake(arithmetic: str) -> None:
    number = make(arithmetic)
    law = Ipfc(number, SCENARIO)
    # v* = 0.08 t^2 m/s, in km/h: 0.072 i^2 at i half seconds.
    preview = [number.from_raw(raw(0.072 * i**2, SPEED_Q), SPEED_Q) for i in range(1, 11)]
    zero = number.from_raw(0, SPEED_Q)
    inputs = LawInputs(zero, zero, preview)
    _, outputs = law.step(law.start(inputs), inputs)
    assert number.raw(outputs.notch, 8) == -106


def test_start_takes_earlier_errors_as_the_first() -> None:
    number = Noting()
    law = Ipfc(number, SCENARIO)
    inputs = LawInputs(50.0, 51.0, [51.0] * 10)
    state = law.start(inputs)
    assert state.model_errors == (50.0,) * 8
    assert state.tracking_error == 1.0
    law.step(state, inputs)
    assert number.values["e"] == (0.0, 0.0)


def test_notch_really_sent_drives_the_model() -> None:
    number = Noting()
    law = Ipfc(number, SCENARIO)
    inputs = LawInputs(50.0, 51.0, [51.0] * 10)
    state, _ = law.step(law.start(inputs), inputs)
    law.step(law.with_sent(state, -2.0), inputs)
    with_brake = number.values["y_m"]
    law.step(law.with_sent(state, 2.0), inputs)
    unit = law.table.step_response[0].value
    assert number.values["y_m"] - with_brake == pytest.approx(4 * unit, abs=1e-12)


def test_a_speed_that_falls_to_zero_saturates_and_does_not_wrap() -> None:
    arithmetic = make("iq")
    law: Ipfc[int] = Ipfc(arithmetic, SCENARIO)
    speed = raw(78.0, SPEED_Q)
    inputs = LawInputs(speed, speed, [speed] * 10)
    state, _ = law.step(law.start(inputs), inputs)
    _, outputs = law.step(state, LawInputs(0, speed, [speed] * 10))
    assert outputs.notch == 7 * 256
    assert arithmetic.counters.wraps == 0
    assert arithmetic.counters.saturations > 0


def test_polynomial_orders_may_differ() -> None:
    vector = STEPS["run_t_k360"]
    both = float_step(vector)[2]
    for orders in ({"set_point_order": 1}, {"error_order": 1}, {"set_point_order": 3}):
        law = Ipfc(Noting(), SCENARIO, replace(IpfcParameters(), **orders))
        noted = float_step(vector, law)[2]
        assert len(noted["c"]) == orders.get("set_point_order", 2)
        assert len(noted["e"]) == orders.get("error_order", 2)
        assert noted["d"] != both["d"]
        c, e = noted["c"], noted["e"]
        rise = sum(x * 3**n for n, x in enumerate(c, 1)) - sum(x * 3**n for n, x in enumerate(e, 1))
        free = sum(row.value * x for row, x in zip(law.table.free[2], _model_after(law, vector), strict=True))
        alone = (1 - 0.85**3) * (vector["input"]["r0"] - vector["input"]["y"])
        assert noted["d"][0] == pytest.approx(alone + rise - free, abs=1e-9)


def _model_after(law: Ipfc[float], vector: dict[str, Any]) -> list[float]:
    drive = [*vector["state"]["X"], vector["state"]["u_prev"]]
    return [sum(k.value * x for k, x in zip(row, drive, strict=True)) for row in law.table.model]


def test_law_is_found_by_its_entry_point() -> None:
    assert "ipfc" in names()
    assert load("ipfc") is Ipfc


def test_unknown_law_is_one_line_with_the_names_there_are() -> None:
    with pytest.raises(InputError, match=r"^controller: name: found 'ipcf', allowed one of .*ipfc.*did you mean ipfc"):
        load("ipcf")
