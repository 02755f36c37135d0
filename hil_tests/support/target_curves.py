"""What every generated target speed curve keeps, and lines drawn for it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import strategies as st

from railhil.scenarios.profiles import profile_value
from railhil.systems.ato.scenario.generate import CurveLimits
from railhil.systems.ato.scenario.model import Effort, Line, TargetCurve, Train
from railhil.systems.ato.scenario.target import Target

TRAIN = Train(
    name="test train",
    mass_kg=200_000.0,
    inertial_mass_kg=212_000.0,
    length_m=80.0,
    davis_a_n_per_kn=2.0,
    davis_b_n_per_kn_kmh=0.01,
    davis_c_n_per_kn_kmh2=0.0005,
    traction=Effort(220_000.0, 2_600_000.0),
    brake=Effort(260_000.0),
    actuator_pole_per_s=0.34,
    force_per_notch_n=45_000.0,
)


def felt_limit_mps(line: Line, train: Train, front_m: float) -> float:
    """Least limit under the whole train, by looking at every metre: slow, but plainly right."""
    under = np.arange(front_m - train.length_m + 1e-6, front_m, 1.0)
    return min(profile_value(line.speed_limit_mps, float(x)) for x in (*under, front_m))


def mean_grade_permil(line: Line, train: Train, front_m: float) -> float:
    under = front_m - train.length_m + (np.arange(80) + 0.5) * train.length_m / 80
    return float(np.mean([profile_value(line.grade_permil, float(x)) for x in under]))


def assert_curve_keeps_everything(curve: TargetCurve, line: Line, train: Train, limits: CurveLimits) -> None:
    """Speed, acceleration, jerk and force limits by brute force over samples of the run."""
    target = Target(curve)
    nodes = np.array(curve.nodes)
    jerk = np.diff(nodes[:, 1]) / np.diff(nodes[:, 0])
    assert np.abs(jerk).max() <= limits.jerk_max_mps3 + 1e-6
    assert nodes[:, 1].max() <= limits.accel_max_mps2 + 1e-9
    assert nodes[:, 1].min() >= -limits.braking_max_mps2 - 1e-9
    assert nodes[0] == pytest.approx((0.0, 0.0))
    assert -limits.end_braking_mps2 - 1e-9 <= nodes[-1, 1] < 0
    weight_kn = train.mass_kg * train.gravity_mps2 / 1000
    for t in np.linspace(0.0, target.stop_time_s, 120)[:-1].tolist():
        v, x, a = target.speed_mps(t), target.position_m(t), target.accel_mps2(t)
        assert -1e-9 <= v <= felt_limit_mps(line, train, x) + 1e-6
        kmh = 3.6 * v
        davis = train.davis_a_n_per_kn + train.davis_b_n_per_kn_kmh * kmh + train.davis_c_n_per_kn_kmh2 * kmh**2
        force_n = train.inertial_mass_kg * a + weight_kn * (davis + mean_grade_permil(line, train, x))
        effort = train.traction
        limit_n = min(effort.force_max_n, effort.power_max_w / v if effort.power_max_w and v > 0 else np.inf)
        if effort.curve:
            limit_n = min(limit_n, float(np.interp(v, *np.array(effort.curve).T)))
        assert force_n <= limit_n * (limits.traction_utilisation + 0.03)
        assert -force_n <= train.brake.force_max_n * (limits.brake_utilisation + 0.03)


@st.composite
def lines(draw: st.DrawFn) -> tuple[Line, float]:
    edges = sorted(draw(st.sets(st.integers(-70, 3000), min_size=0, max_size=8)))
    limits = ((-80.0, draw(st.integers(30, 90)) / 3.6), *((float(x), draw(st.integers(30, 90)) / 3.6) for x in edges))
    grades = ((-80.0, 0.0), *((float(x) + 35.0, float(draw(st.integers(-30, 30)))) for x in edges))
    return Line("drawn", grades, limits), float(draw(st.integers(400, 3000)))
