"""The environment of Gymnasium: a run like any other, given its commands step by step."""

from __future__ import annotations

import sys
import threading
import warnings
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import railhil
from hil_tests.support.paths import ROOT
from hil_tests.support.short_runs import RUN_2M_TOML
from railhil.common.errors import InputError

gymnasium = pytest.importorskip("gymnasium", reason="MISSING CAPABILITY gymnasium (extra gym)")

from railhil.gym import GymCommands, RunEnv  # noqa: E402


@pytest.fixture
def short(tmp_path: Path) -> str:
    """2 m in 4 s."""
    path = tmp_path / "short.toml"
    path.write_text(RUN_2M_TOML, encoding="utf-8")
    return str(path)


def played(env: Any, seed: int, notch: Any) -> tuple[list[tuple[Any, ...]], dict[str, Any]]:
    """The steps of an episode, and its last info.

    :param notch: of an observation.
    """
    observed, info = env.reset(seed=seed)
    steps, is_over = [], False
    while not is_over:
        observed, reward, terminated, truncated, info = env.step(np.array([notch(observed)]))
        steps.append((tuple(observed), reward, terminated, truncated))
        is_over = terminated or truncated
    return steps, info


def follow(observed: Any) -> float:
    """A notch that follows the set-point; readings 1 and 2 are speed and set-point in m/s."""
    return float(10.8 * (observed[2] - observed[1]))


@pytest.mark.slow
def test_an_episode_has_the_bytes_of_a_run_whose_controller_plays_its_commands(short: str, tmp_path: Path) -> None:
    env = RunEnv(short, out=tmp_path / "episodes")
    steps, info = played(env, 5, follow)
    run = railhil.run(short, controller=GymCommands.play(env.commands), seed=5, out=tmp_path / "played")
    assert run.frames_sha256 == info["frames_sha256"]
    assert (run.verdict, run.scores) == (info["verdict"], info["scores"])
    kept = railhil.open_run(info["folder"])
    assert Path(info["folder"]) == tmp_path / "episodes" / "episode-1"
    assert kept.frames_sha256 == info["frames_sha256"]
    assert len(steps) == len(env.commands)


@pytest.mark.slow
def test_the_notches_on_the_bus_are_those_of_a_function_that_computes_the_same(short: str, tmp_path: Path) -> None:
    """A function of the user's has another name in the handshake, and gives the same signals at every instant."""
    env = RunEnv(short, out=tmp_path / "episodes")
    _, info = played(env, 0, follow)
    run = railhil.run(
        short, controller=lambda reading: 10.8 * (reading.set_point_mps - reading.speed_mps), out=tmp_path / "function"
    )
    episode = railhil.open_run(info["folder"])
    assert list(episode.signals) == list(run.signals)
    for name in run.signals:
        np.testing.assert_array_equal(episode.signals[name], run.signals[name], err_msg=name)
    assert run.scores == info["scores"]


@pytest.mark.slow
def test_a_seed_gives_the_same_episode_and_another_seed_another_one(short: str) -> None:
    env = RunEnv(short)
    first, info = played(env, 7, follow)
    again, repeated = played(env, 7, follow)
    _, other = played(env, 8, follow)
    assert first == again
    assert info == repeated
    assert other["frames_sha256"] != info["frames_sha256"]


@pytest.mark.slow
def test_the_reward_is_the_cost_of_the_judge_at_the_end_and_nothing_before(short: str) -> None:
    env = RunEnv(short)
    steps, info = played(env, 0, follow)
    rewards = [reward for _, reward, _, _ in steps]
    limits = {"stop_error_m": 0.3, "punctuality_s": 0.3}
    assert rewards[:-1] == [0.0] * (len(rewards) - 1)
    wanted = sum(100.0 if (value := info["scores"][key]) is None else min(100.0, value / limit)
                 for key, limit in limits.items())  # fmt: skip
    assert rewards[-1] == pytest.approx(-wanted, rel=1e-12)


@pytest.mark.slow
def test_a_law_as_reference_adds_the_criteria_without_a_limit(short: str) -> None:
    plain, _ = played(RunEnv(short), 0, follow)
    scaled, _ = played(RunEnv(short, reference="ipfc"), 0, follow)
    assert scaled[-1][1] < plain[-1][1]


@pytest.mark.slow
def test_a_train_that_stops_ends_the_episode_and_one_whose_time_is_over_cuts_it(short: str) -> None:
    stopped, info = played(RunEnv(short), 0, lambda observed: 4.0 if observed[0] < 2 else -7.0)
    assert stopped[-1][2:] == (True, False), info
    standing, info = played(RunEnv(short), 0, lambda observed: -7.0)
    assert standing[-1][2:] == (False, True)
    assert "not stopped" in info["reasons"]
    assert standing[-1][1] == -200.0


@pytest.mark.slow
def test_a_run_that_is_not_trustworthy_cuts_the_episode(short: str) -> None:
    """A fault that never acts makes a run INVALID."""
    steps, info = played(RunEnv(short, faults="brake off @900s"), 0, follow)
    assert info["verdict"] == "INVALID"
    assert steps[-1][2:] == (False, True)


@pytest.mark.slow
def test_requirements_judge_an_episode(short: str, tmp_path: Path) -> None:
    file = tmp_path / "slow.toml"
    file.write_text('[[requirement]]\nid = "SLOW-1"\nsays = "never true_speed > 1 km/h"\n', encoding="utf-8")
    _, info = played(RunEnv(short, requirements=str(file)), 0, follow)
    assert info["verdict"] == "FAIL"
    assert "SLOW-1" in info["reasons"]


@pytest.mark.slow
@pytest.mark.parametrize("scenario", ["short", "yizhuang_stop", "emu3"])
def test_gymnasiums_own_checker_finds_nothing(scenario: str, short: str) -> None:
    """But three recommendations for learners: normalised commands, and bounds that readings do not have."""
    from gymnasium.utils.env_checker import check_env

    env = RunEnv(short if scenario == "short" else scenario)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        check_env(env, skip_render_check=True)
    env.close()
    known = ("symmetric and normalized", "minimum value is -infinity", "maximum value is infinity")
    assert [str(one.message) for one in said if not any(words in str(one.message) for words in known)] == []


def test_commands_have_the_bounds_of_their_signals(short: str) -> None:
    assert (RunEnv(short).action_space.low, RunEnv(short).action_space.high) == (-7.0, 7.0)
    stop = RunEnv("yizhuang_stop")
    assert [one.name for one in stop.terms.commands] == ["u", "start", "valid"]
    assert (list(stop.action_space.low), list(stop.action_space.high)) == ([-2000, 0, 0], [2000, 160, 1])


def test_an_episode_that_is_left_leaves_no_thread_and_no_folder(short: str, tmp_path: Path) -> None:
    before = threading.active_count()
    env = RunEnv(short, out=tmp_path / "episodes")
    for _ in range(2):
        env.reset(seed=1)
        env.step(np.array([1.0]))
    assert threading.active_count() == before + 1
    env.close()
    assert threading.active_count() == before
    assert list((tmp_path / "episodes").iterdir()) == []


def test_gymnasium_makes_it_by_name(short: str) -> None:
    env = gymnasium.make("railhil/Run-v0", scenario=short, max_episode_steps=2)
    env.reset(seed=0)
    env.step(np.array([1.0]))
    assert env.step(np.array([1.0]))[2:4] == (False, True)
    env.close()


@pytest.mark.slow
def test_a_seed_that_is_drawn_is_named_and_follows_from_the_one_given(short: str) -> None:
    env = RunEnv(short)
    drawn = [[env.reset(seed=seed)[1]["seed"] for seed in (3, None, None)] for _ in range(2)]
    assert drawn[0] == drawn[1]
    assert len(set(drawn[0])) == 3
    env.close()


@pytest.mark.slow
def test_episodes_side_by_side_do_not_disturb_each_other(short: str) -> None:
    alone = [played(RunEnv(short), seed, follow)[1]["frames_sha256"] for seed in (1, 2)]
    both = [RunEnv(short), RunEnv(short)]
    observed = [env.reset(seed=seed)[0] for env, seed in zip(both, (1, 2), strict=True)]
    found: dict[int, str] = {}
    while len(found) < 2:
        for number, env in enumerate(both):
            if number not in found:
                observed[number], _, terminated, truncated, info = env.step(np.array([follow(observed[number])]))
                if terminated or truncated:
                    found[number] = info["frames_sha256"]
    assert [found[0], found[1]] == alone


def test_without_gymnasium_the_line_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [one for one in sys.modules if one.startswith("railhil.gym")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    assert "(the extra [gym])" in refused(lambda: import_module("railhil.gym"))


def refused(call: Any) -> str:
    with pytest.raises(InputError) as found:
        call()
    assert "\n" not in str(found.value)
    return str(found.value)


def test_bad_input_is_one_line(short: str) -> None:
    env = RunEnv(short)
    assert "no episode, expected reset() first" in refused(lambda: env.step(np.zeros(1)))
    assert "options" in refused(lambda: env.reset(options={"notch": 3}))
    assert "seed" in refused(lambda: env.reset(seed=2**70))
    assert "no_such" in refused(lambda: RunEnv("no_such"))
    assert "no_law" in refused(lambda: RunEnv(short, reference="no_law"))
    assert "perturbed" in refused(lambda: RunEnv(short, perturbed=1))  # type: ignore[arg-type]
    assert "render_mode" in refused(lambda: RunEnv(short, render_mode="human"))  # type: ignore[arg-type]
    env.reset(seed=0)
    assert "finite" in refused(lambda: env.step(np.array([np.nan])))
    assert "[1.0, 2.0]" in refused(lambda: env.step(np.array([1.0, 2.0])))
    assert env.step(np.array([1.0]))[1:4] == (0.0, False, False)
    assert env.commands == [(1.0,)]
    env.close()


def test_a_player_whose_commands_end_early_is_no_controller(short: str, tmp_path: Path) -> None:
    run = railhil.run(short, controller=GymCommands.play([(1.0,)]), out=tmp_path / "played")
    assert run.verdict == "INVALID"
    assert "no command after the 1 given" in run.reasons[0]


@pytest.mark.long
def test_a_small_learner_finds_a_law_that_passes() -> None:
    """CMA-ES on three weights from zero: the train learns to depart, to follow and to stop."""
    cmaes = pytest.importorskip("cmaes", reason="MISSING CAPABILITY cmaes")
    env = RunEnv(ROOT / "hil_tests/data/pairs.toml")
    search = cmaes.CMA(mean=np.zeros(3), sigma=1.0, seed=1, population_size=8)

    def episode(weights: Any) -> tuple[float, str]:
        before: list[Any] = []

        def notch(observed: Any) -> float:
            speed, wanted = observed[1:3]
            was, wanted_before = before[-1] if before else (speed, wanted)
            before.append((speed, wanted))
            return float(10 * weights @ np.array([wanted - speed, wanted - wanted_before, was - speed]))

        steps, info = played(env, 0, notch)
        return -steps[-1][1], info["verdict"]

    assert episode(np.zeros(3)) == (200.0, "FAIL")
    verdicts: list[str] = []
    while "PASS" not in verdicts and len(verdicts) < 64:
        asked = [search.ask() for _ in range(search.population_size)]
        found = [episode(weights) for weights in asked]
        search.tell([(weights, cost) for weights, (cost, _) in zip(asked, found, strict=True)])
        verdicts += [verdict for _, verdict in found]
    assert "PASS" in verdicts
