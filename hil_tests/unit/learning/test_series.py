"""Speeds and commands of a record at the sampling instants of a law."""

from __future__ import annotations

import numpy as np
import pytest

from railhil.learning.series import Series


def series(late_every: int = 4) -> Series:
    """A command that changes each second from 0.2 s on, in telegrams of 40 ms; some are recorded a tick late."""
    ticks = np.arange(500)
    command_s = 0.04 * (ticks + (ticks % late_every == 0))
    seconds = np.floor((0.04 * ticks - 0.2) / 1.0 + 1e-9)
    return Series(0.04 * ticks, 0.5 * 0.04 * ticks, command_s, 0.01 * (seconds + 1.0))


def test_the_sampling_instant_is_that_of_the_changes() -> None:
    assert series().phase_s(1.0) == pytest.approx(0.2)


def test_a_command_that_never_changes_has_the_instant_0() -> None:
    still = Series(np.arange(3.0), np.zeros(3), np.arange(3.0), np.zeros(3))
    assert still.phase_s(1.0) == 0.0


def test_samples_are_the_speed_and_the_whole_command_of_the_period() -> None:
    speeds, commands = series().sample(1.0, 0.2)
    assert speeds == pytest.approx(0.5 * (0.2 + np.arange(len(speeds))))
    # A telegram that comes a tick later does not dilute the command.
    assert commands == pytest.approx(0.01 * (1.0 + np.arange(len(speeds))))


def test_longer_periods_have_mean_commands_and_shorter_ones_interpolated_speeds() -> None:
    _, commands = series().sample(2.0, 0.2)
    assert commands == pytest.approx(0.01 * (1.5 + 2.0 * np.arange(len(commands))))
    speeds, _ = series().sample(0.5, 0.2)
    assert speeds == pytest.approx(0.5 * (0.2 + 0.5 * np.arange(len(speeds))))
