"""Random numbers of faults in a run that is given as a vector: values from its draws, samples from its noise."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.figures import QUICK_TOML
from railhil.faults.language import parse
from railhil.run.local import unrecorded_run
from railhil.scenarios.fault_list import draw_each, draw_faults, list_draws, name_fault_draws
from railhil.scenarios.load import load
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.streams import Chain, ChainSamples, fault_samples, keys_of

FAULTS = (
    "TRN_SPEED delay uniform(10ms,50ms) jitter normal(10ms,2ms) @1s",
    "mass scale uniform(0.9,1.1) @0s seed 4",
    "sensor.speed offset normal(0,0.2) @2s",
)


def test_values_take_the_last_draws_in_the_order_of_faults_and_names() -> None:
    faults = [parse(text) for text in FAULTS]
    assert list_draws(faults) == [(1, "delay_s"), (1, "jitter_s"), (3, "error")]
    assert name_fault_draws(FAULTS) == (
        "fault 1 TRN_SPEED delay_s",
        "fault 1 TRN_SPEED jitter_s",
        "fault 3 speed error",
    )
    found = draw_each(faults, 9, (7.0, 7.0, 0.0, 1.5, -1.0))
    assert found[0].parameter("delay_s") == pytest.approx(0.03)
    assert found[0].parameter("jitter_s") == pytest.approx(0.013)
    assert found[2].parameter("error") == pytest.approx(-0.2)


def test_a_fault_with_a_seed_of_its_own_is_the_same_in_every_run() -> None:
    faults = [parse(text) for text in FAULTS]
    assert draw_each(faults, 1, (0.0,) * 3)[1] == draw_each(faults, 2, (1.0,) * 3)[1] == draw_each(faults, 3, ())[1]


@given(st.lists(st.floats(-40, 40), min_size=3, max_size=3))
def test_drawn_values_stay_within_the_bounds_of_their_parameters(draws: list[float]) -> None:
    first, _, third = draw_each([parse(text) for text in FAULTS], 0, draws)
    assert 0.01 <= first.parameter("delay_s") <= 0.05
    assert first.parameter("jitter_s") >= 0.0
    assert third.parameter("error") == pytest.approx(0.2 * draws[2])


@given(st.integers(0, 2**32 - 1))
def test_without_draws_the_seed_draws_the_values(seed: int) -> None:
    scenario = replace(load("lvshun_tieshan"), faults=FAULTS)
    first, other = draw_faults(scenario, seed), draw_faults(scenario, seed + 1)
    assert first == draw_faults(scenario, seed)
    assert (first[0] == other[0], first[1] == other[1]) == (False, True)


def test_samples_of_a_chain_have_their_distributions() -> None:
    chain: Chain = ((3, 0.6), (8, -0.8))
    samples = ChainSamples(keys_of(chain, 1001))
    normal = np.array([samples.standard_normal() for _ in range(4000)])
    assert abs(normal.mean()) < 0.05
    assert abs(normal.std() - 1.0) < 0.05
    uniform = [samples.random() for _ in range(4000)]
    assert 0.0 <= min(uniform) <= max(uniform) < 1.0
    assert abs(np.mean(uniform) - 0.5) < 0.02
    whole = np.bincount([samples.integers(2, 4, endpoint=True) for _ in range(3000)])
    assert whole[:2].tolist() == [0, 0]
    assert whole[2:].min() > 900
    assert {samples.integers(2, 4) for _ in range(100)} == {2, 3}


def test_each_fault_has_a_sequence_of_its_own_and_one_with_a_seed_keeps_it() -> None:
    first = [fault_samples(0, number, None, ((5, 1.0),)).standard_normal() for number in (1, 2)]
    assert first[0] != first[1]
    own = [fault_samples(0, 1, 6, chain).random() for chain in ((), ((5, 1.0),))]
    assert own[0] == own[1]


@pytest.mark.parametrize("fault", ["sensor.speed noise 0.2 @1s", "TRN_SPEED loss 20% @1s"])
def test_another_chain_draws_other_samples_on_the_bench(fault: str, tmp_path: Path) -> None:
    """A fault in the plant and one of the telegrams, without the noise of the sensor itself."""
    path = tmp_path / "short.toml"
    path.write_text(QUICK_TOML)
    runs = []
    for chain in ([[5, 1.0]], [[5, 1.0]], [[6, 1.0]]):
        spec = RunSpec(str(path), ("sensors.speed_noise_sigma_kmh=0", f"noise={chain}"), bus="local", faults=(fault,))
        result = unrecorded_run(spec.load(), spec)
        runs.append((result.score.signed, [one.hits for one in result.faults]))
    assert runs[0] == runs[1]
    assert runs[0] != runs[2]
