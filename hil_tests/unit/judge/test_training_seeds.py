"""Whether a run is an evaluation of a law: in a system whose plant draws the same in every run, any run may not be."""

from __future__ import annotations

from pathlib import Path

import pytest

from railhil.common.errors import InputError
from railhil.controller_node.high_speed.laws.delay_gpc import DelayGpc
from railhil.judge.training_seeds import check_unseen, chosen_on, seed_was_trained
from railhil.record.telemetry import LawOrigin
from railhil.scenarios.load import load_any
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec

CHOSEN = LawOrigin("ours", {"jinan_xuzhou": range(100, 110), "lvshun_tieshan": range(100, 110)})
STILL = ("task.gradient_permil=0", "task.wind_sigma_mps2=0", "task.noise_sigma_mps=0")


def trained(name: str, seed: int, *settings: str, perturbed: bool = False) -> bool | None:
    return seed_was_trained(load_any(name, settings), RunSpec(name, settings, seed=seed, perturbed=perturbed), CHOSEN)


@pytest.mark.parametrize("perturbed", [False, True])
def test_a_high_speed_run_draws_with_its_seed_whether_it_is_perturbed_or_not(perturbed: bool) -> None:
    found = [trained("jinan_xuzhou", seed, perturbed=perturbed) for seed in (99, 100, 109, 110)]
    assert found == [False, True, True, False]


def test_a_nominal_run_is_not_one_of_those_on_which_parameters_were_chosen() -> None:
    assert trained("jinan_xuzhou", 100, *STILL) is False
    assert trained("lvshun_tieshan", 100) is False
    assert trained("lvshun_tieshan", 100, perturbed=True) is True


def test_the_seeds_of_a_search_count_too() -> None:
    scenario = load_any("jinan_xuzhou")
    tuned = ParameterSet("pid", {"kp_per_s": 0.5}, Path("tuned.toml"), training_seeds=frozenset({7}))
    run = RunSpec("jinan_xuzhou", law=LawSpec("pid", parameters=tuned), seed=7)
    assert seed_was_trained(scenario, run, None) is True
    with pytest.raises(InputError, match="tuned"):
        check_unseen(scenario, run)


def test_our_law_is_not_evaluated_on_the_seeds_of_its_design() -> None:
    scenario = load_any("jinan_xuzhou_emergency")
    origin = LawOrigin(DelayGpc.parameters_origin, DelayGpc.design_seeds)
    law = LawSpec("delay_gpc", "float64")
    with pytest.raises(InputError, match="105, on which delay_gpc's own parameters were chosen"):
        check_unseen(scenario, RunSpec(scenario.name, law=law, seed=105), origin)
    check_unseen(scenario, RunSpec(scenario.name, law=law, seed=211), origin)


EXTENDS = 'schema_version = 1\nsystem = "{system}"\nextends = "{name}"\nname = "mine"\ntitle = "Mine"\n'


@pytest.mark.parametrize(
    ("name", "system", "judged", "other"),
    [
        ("lvshun_tieshan", "ato", "plan.stop_error_max_m=0.1", "watch.emergency_ms=900"),
        ("jinan_xuzhou", "hst1", "task.rmse_max_kmh=0.9", "task.gradient_permil=3"),
    ],
)
def test_a_scenario_is_known_by_its_content_whatever_it_is_called(
    name: str, system: str, judged: str, other: str, tmp_path: Path
) -> None:
    mine = tmp_path / "mine.toml"
    text = EXTENDS.format(system=system, name=name)
    mine.write_text(text if system != "ato" else text.replace('system = "ato"\n', ""))
    seeds = range(95, 105)
    assert [chosen_on(CHOSEN.design_seeds, load_any(str(mine), given), seeds) for given in ((), (judged,))] == [
        [100, 101, 102, 103, 104]
    ] * 2
    assert chosen_on(CHOSEN.design_seeds, load_any(str(mine), (other,)), seeds) == []
    assert chosen_on(CHOSEN.design_seeds, load_any(name, (other,)), seeds) == [100, 101, 102, 103, 104]
    assert chosen_on({"a_scenario_that_is_gone": range(200)}, load_any(name), seeds) == []
