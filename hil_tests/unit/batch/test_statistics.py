"""IPFC over 200 perturbed runs: the medians that any correct implementation of the paper's law gives on this plant."""

from __future__ import annotations

from math import hypot, pi, sqrt
from statistics import median, stdev

import pytest

from railhil.scenarios.load import load
from railhil.scenarios.run_spec import LawSpec
from railhil.study.perturbed_runs import FIRST_SEED, run_seeds

RUNS = 200
#: Medians and their tolerances; absolute where the name says so.
BANDS = {
    "itae": (2120.0, 0.10 * 2120.0),
    "punctuality_s": (0.078, 0.02),
    "stop_error_m": (0.26, 0.05),
    "comfort": (1.8, 0.15),
}
#: Median energy of 5000 runs with its 95 % interval; two independent programs agree within 0.03 %.
ENERGY_KJ, ENERGY_LOW_KJ, ENERGY_HIGH_KJ = 74_560.0, 74_380.0, 74_760.0
#: Two-sided 95 % of the normal distribution, in standard errors.
NORMAL_95 = 1.96


def energy_tolerance_kj(found: list[float]) -> float:
    """How far the median of a sample may be from that of the 5000 runs.

    Mass alone spreads the energy by 10 %, so a median of 200 has a standard error, sqrt(pi/2) sigma / sqrt(n), of some
    0.5 MJ; that of the 5000 is added as variances are.
    """
    of_sample = sqrt(pi / 2) * stdev(found) / sqrt(len(found))
    of_reference = (ENERGY_HIGH_KJ - ENERGY_LOW_KJ) / (2 * NORMAL_95)
    return NORMAL_95 * hypot(of_sample, of_reference)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize(
    "arithmetic", ["iq", *(pytest.param(one, marks=pytest.mark.long) for one in ("float64", "float32"))]
)
def test_medians_of_200_perturbed_runs(arithmetic):
    seeds = range(FIRST_SEED, FIRST_SEED + RUNS)
    found = run_seeds(load("lvshun_tieshan"), LawSpec(arithmetic=arithmetic), seeds).scores
    assert all(run.values["stop_error_m"] is not None for run in found), "every run stops"
    assert max(run.extras["overspeed_mps"] for run in found) == 0.0
    medians = {name: median(run.values[name] for run in found) for name in BANDS}
    print({name: round(value, 4) for name, value in medians.items()})
    for name, (centre, tolerance) in BANDS.items():
        assert abs(medians[name] - centre) <= tolerance, f"{name}: median {medians[name]}, band {centre} +- {tolerance}"
    energies = [run.values["energy_kj"] for run in found if run.values["energy_kj"] is not None]
    tolerance = energy_tolerance_kj(energies)
    assert 900 < tolerance < 1100, "2 sigma of a sample of 200, less than 1.5 % of the energy"
    assert abs(median(energies) - ENERGY_KJ) <= tolerance
