"""The audit of laws without formats: commands before they are rounded for the bus, against those in float64."""

from __future__ import annotations

import pytest

from railhil.audit.bars import bars
from railhil.audit.result import Options, audit
from railhil.audit.shadow import QuantityError, errors, shadow_run
from railhil.controller_node.arithmetic import make
from railhil.controller_node.cost import Cost
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec

SCENARIO = load_any("jinan_xuzhou", ["task.start_s=1500", "task.duration_s=30", "task.rmse_max_kmh=9"])
LAW = LawSpec("delay_gpc", "float32")


@pytest.mark.slow
def test_the_largest_difference_of_the_command_is_a_limit_of_the_audit() -> None:
    result = audit(SCENARIO, Options(LAW, seed=1, runs=0))
    bar = next(bar for bar in result.bars if bar.name == "largest difference of accel[0] from float64's")
    error = next(error for error in result.errors if error.name == "accel[0]")
    assert bar.allowed == "at most 0.0001 m/s2"
    assert bar.met
    assert error.maximum is not None
    assert 0.0 < error.maximum <= 1e-4


@pytest.mark.slow
def test_a_law_without_formats_is_compared_by_a_twin_that_is_told_what_was_sent() -> None:
    shadow = shadow_run(SCENARIO, LAW, make("float32"), twin=make("float32"), seed=1)
    driving, twin = (
        next(error for error in errors(shadow.quantities, which, shadow.reference) if error.name == "accel[0]")
        for which in (shadow.audited, shadow.twin)
    )
    assert twin.maximum is not None
    assert driving.maximum is not None
    # The driving one knows its commands before they are rounded, to half of 0.001 m/s2.
    assert twin.maximum < 1e-4 < driving.maximum


def test_a_larger_difference_misses_the_limit() -> None:
    shadow = shadow_run(SCENARIO, LAW, make("float32"), seed=1)
    price: Cost = shadow.audited.controller.cost
    for maximum, met in ((1.1e-4, False), (0.9e-4, True), (None, False)):
        found = [QuantityError("accel[0]", 24, "m/s2", maximum, maximum, 0.0, 1, 0)]
        limited = bars(shadow, price, errors=found, limits={"accel": 1e-4})
        assert next(bar.met for bar in limited if "accel[0]" in bar.name) is met
    assert not any("accel" in bar.name for bar in bars(shadow, price, errors=found))
