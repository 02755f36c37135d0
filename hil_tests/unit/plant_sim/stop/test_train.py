"""The train of precise stopping: its motion against the closed form and against small steps, its readings."""

from __future__ import annotations

from math import exp
from typing import Any

import pytest

from hil_tests.support.stops import EXACT, FLAT, stop_scenario
from railhil.bus.layout import CHECK_CORRECT, CHECK_ERRONEOUS
from railhil.plant_sim.stop.brake import Going, gone_on
from railhil.plant_sim.stop.draws import drawn_run, drawn_train
from railhil.plant_sim.stop.plant import StopPlant
from railhil.plant_sim.stop.train import StopTrain

TICK_S = 0.016


def train_of(*settings: str, seed: int = 1, run: int = 1, name: str = "yizhuang_stop") -> StopTrain:
    task = stop_scenario(*settings, name=name).task
    train = drawn_train(task, seed)
    return StopTrain(task, train, drawn_run(task, train, seed, run), seed, run)


def braked(train: StopTrain, accel_mps2: float = -0.8, after_s: float = 0.0) -> float:
    """Where the train stands after a command."""
    train.command(accel_mps2, after_s)
    for _ in range(6000):
        train.advance()
        if train.motion.speed_mps == 0.0:
            return train.motion.position_m
    raise AssertionError("it still moves")


def stop_distance_m(v0_mps: float, a_mps2: float, delay_s: float, lag_s: float) -> float:
    """Equations (4) and (5), by bisection."""

    def speed(t: float) -> float:
        return v0_mps - a_mps2 * (t - lag_s * (1.0 - exp(-t / lag_s)))

    low, high = 0.0, 1000.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if speed(middle) > 0.0 else (low, middle)
    braking = 0.5 * low * low - lag_s * low + lag_s * lag_s * (1.0 - exp(-low / lag_s))
    return v0_mps * (low + delay_s) - a_mps2 * braking


@pytest.mark.parametrize(("kmh", "after_s"), [(60, 0.0), (60, 0.0117), (45, 0.0031), (7, 0.016)])
def test_it_stops_where_the_closed_form_says(kmh: float, after_s: float) -> None:
    train = train_of(*EXACT, *FLAT, f"task.start_kmh={kmh}")
    gone_m = braked(train, after_s=after_s) - train.task.start_m
    v0_mps = kmh / 3.6
    expected_m = v0_mps * after_s + stop_distance_m(v0_mps, 0.8 * 0.985, 0.64, 0.42)
    assert gone_m == pytest.approx(expected_m, abs=1e-6)  # 2 mm are asked for


def test_with_grades_and_a_loss_at_low_speed_it_stops_where_small_steps_do() -> None:
    train = train_of(*EXACT, "task.true.low_speed_loss=0.15", "task.start_m=2440", "task.grade=[[0, 3], [2500, -2]]")
    stop_m = braked(train)
    s, v, a, n, step = 2440.0, 60 / 3.6, 9.81 * 0.003, 0, 2e-4
    while v > 0.0:
        grade = -9.81 * (0.003 if s < 2500 else -0.002)
        told = -0.8 * 0.985 if n >= 3200 else 9.81 * 0.003
        middle = a + (told - a) * 0.5 * step / 0.42
        force = middle * (0.85 if middle < 0.0 and v <= 2.0 else 1.0)
        s += v * step + 0.5 * (force + grade) * step * step
        v += (force + grade) * step
        a += (told - middle) * step / 0.42
        n += 1
    assert stop_m == pytest.approx(s, abs=2e-3)


def test_it_keeps_its_speed_on_a_grade_until_it_is_told_otherwise() -> None:
    train = train_of(*EXACT, "task.start_m=1900")
    for _ in range(500):
        train.advance()
    assert train.motion.speed_mps == pytest.approx(60 / 3.6, abs=1e-9)


def test_a_newer_command_overtakes_one_that_begins_later() -> None:
    train = train_of(*EXACT, *FLAT)
    train.command(-1.0, 0.025)
    train.advance()
    train.command(-0.2)
    for _ in range(600):
        train.advance()
    assert train.motion.drive_mps2 == pytest.approx(-0.2 * 0.985, abs=1e-6)


def test_notches_round_the_command() -> None:
    train = train_of(*EXACT, *FLAT, "task.brake.notch_mps2=0.15", "task.true.gain=1.0")
    train.command(-0.7)
    for _ in range(600):
        train.advance()
    assert train.motion.drive_mps2 == pytest.approx(-0.75, abs=1e-6)


def test_a_standing_train_is_held_and_starts_with_traction() -> None:
    train = train_of(*EXACT, "task.start_kmh=0", "task.grade=[[0, -20]]")
    for _ in range(100):
        train.advance()
    assert train.motion.speed_mps == 0.0
    train.command(0.3)
    for _ in range(100):
        train.advance()
    assert train.motion.speed_mps > 0.1


def test_a_standing_train_whose_traction_is_not_yet_stronger_than_the_wander_is_held() -> None:
    """It used to look for the instant of its standstill again and again."""
    train = train_of(*EXACT, *FLAT, "task.start_kmh=0")
    going = train.going
    begun = Going(going.now_s, going.motion._replace(drive_mps2=0.01), going.piece, False, -1.0)
    held = gone_on(train.course, begun, 0.3, -5.0, begun.now_s + 0.0032)
    assert held.now_s == begun.now_s + 0.0032
    assert held.motion[:2] == begun.motion[:2]
    assert held.motion.drive_mps2 > 0.01
    assert held.stopped_s == -1.0
    # The traction has become the stronger one.
    assert gone_on(train.course, begun, 0.3, 0.0, begun.now_s + 0.0032).motion.speed_mps > 0.0


def test_low_adhesion_limits_the_braking_and_the_slide_is_seen() -> None:
    sliding = ("task.rail.slide_share=1.0", "task.rail.adhesion_mps2=[0.6, 0.6]")
    train = train_of(*EXACT, *FLAT, *sliding)
    train.command(-0.8)
    for _ in range(600):
        train.advance()
    assert train.slides
    assert train.accel_mps2 == pytest.approx(-0.6, abs=1e-9)


def test_samples_are_spaced_evenly_and_the_last_one_is_of_the_instant() -> None:
    train = train_of(*EXACT, *FLAT, "task.true.delay_s=0")
    train.command(-0.8)
    for _ in range(300):
        train.advance()
    assert train.samples[-1] == round(train.motion.speed_mps * 1000.0)
    steps = [before - after for before, after in zip(train.samples, train.samples[1:], strict=False)]
    assert all(abs(step - 0.8 * 0.985 * 3.2) <= 1 for step in steps)


def test_noise_of_the_samples_has_the_given_deviation() -> None:
    train = train_of("task.wander_sigma_mps=0", "task.cruise_sigma_mps=0", *FLAT)
    found = []
    for _ in range(2000):
        train.advance()
        found += [sample - 60_000 / 3.6 for sample in train.samples]
    mean = sum(found) / len(found)
    assert abs(mean) < 0.5
    assert (sum((x - mean) ** 2 for x in found) / len(found)) ** 0.5 == pytest.approx(10.0, rel=0.05)


def test_balises_tell_the_distance_by_the_wheels() -> None:
    train = train_of(
        *EXACT, *FLAT, "task.sensors.balise_sigma_m=0", "task.start_m=2550", "task.start_kmh=36",
        name="yizhuang_stop_closed",
    )  # fmt: skip
    seen: dict[int, float] = {}
    while train.motion.position_m < 2631:
        train.advance()
        seen.setdefault(*train.passed)
    # The first of the four lies behind the start.
    assert [round(metres / (1.0 + train.wheel), 6) for metres in seen.values()] == [0.0, 17.0, 45.0, 65.0]
    assert [*seen] == [0, 2, 3, 4]


def test_the_wander_ends_with_the_brake_command() -> None:
    def speeds(wander: float) -> list[float]:
        train = train_of(f"task.wander_sigma_mps={wander}", "task.cruise_sigma_mps=0", *FLAT)
        for _ in range(50):
            train.advance()
        train.command(-0.8)
        found = []
        for _ in range(200):
            train.advance()
            found.append(train.motion.speed_mps)
        return found

    apart = [a - b for a, b in zip(speeds(0.02), speeds(0.0), strict=True)]
    assert abs(apart[0]) > 1e-3
    assert apart[-1] == pytest.approx(apart[0], abs=1e-9)


class TestDraws:
    def drawn(self, *settings: str, seed: int = 5, run: int = 1) -> Any:
        task = stop_scenario(*settings, name="yizhuang_stop_closed").task
        train = drawn_train(task, seed)
        return train, drawn_run(task, train, seed, run)

    def test_the_train_is_the_same_in_all_runs_of_a_sequence(self) -> None:
        (train, first), (again, second) = self.drawn(), self.drawn(run=2)
        assert train == again
        assert first.gain != second.gain
        assert first.start_mps != second.start_mps
        assert self.drawn(seed=6)[0] != train

    def test_a_run_is_repeated_by_its_number(self) -> None:
        assert self.drawn(run=7) == self.drawn(run=7)

    def test_switching_something_on_changes_no_other_draw(self) -> None:
        _, plain = self.drawn()
        _, more = self.drawn("task.rail.slide_share=1.0", "task.load_percent=[20, 80]")
        assert more.gain == plain.gain
        assert more.start_mps == plain.start_mps
        assert more.adhesion_mps2 > 0.0
        assert 20 <= more.load_percent <= 80

    @pytest.mark.slow
    def test_the_gain_scatters_as_the_scenario_says(self) -> None:
        gains = [self.drawn(seed=seed)[0].gain for seed in range(200)]
        mean = sum(gains) / len(gains)
        assert mean == pytest.approx(1.0, abs=0.012)
        assert (sum((gain - mean) ** 2 for gain in gains) / len(gains)) ** 0.5 == pytest.approx(0.05, rel=0.2)

    def test_a_loaded_train_brakes_less(self) -> None:
        full = ("task.load_percent=[100, 100]", "task.true.full_load_gain=0.9")
        assert self.drawn(*full)[1].gain == pytest.approx(0.9 * self.drawn()[1].gain)


@pytest.mark.parametrize(("gone_m", "raw", "correct"), [(16_777.0, 16_777_000, True), (16_778.0, 2**24 - 1, False)])
def test_a_distance_beyond_its_signal_says_that_it_is_none(gone_m: float, raw: int, correct: bool) -> None:
    plant = StopPlant(stop_scenario(*EXACT, *FLAT), 0, False, 0.0, 1)
    moved = plant.train.motion._replace(position_m=plant.train.task.start_m + gone_m)
    plant.train.going = plant.train.going._replace(motion=moved)
    telegram: Any = plant.makers["ODO"]()
    assert telegram.odometer == pytest.approx(raw, abs=1)
    assert telegram.check == (CHECK_CORRECT if correct else CHECK_ERRONEOUS)
