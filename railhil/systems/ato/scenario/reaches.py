"""What a run of ``ato`` can reach (:mod:`railhil.scenarios.carried`)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from railhil.scenarios.carried import SIGMAS, Reach
from railhil.systems.ato.scenario.effort import force_limit_n, resistance_n
from railhil.systems.ato.scenario.model import Effort, Scenario, Uniform
from railhil.systems.ato.scenario.profiles import front_speed_limit
from railhil.systems.ato.scenario.target import Target

_SAMPLE_S = 0.1


def train_reaches(scenario: Scenario, target: Target) -> Iterator[Reach]:
    """What a run of ``ato`` can reach.

    :param target: its target curve, which has been checked.
    """
    plan, line, train, sensors = scenario.plan, scenario.line, scenario.train, scenario.sensors
    drawn = scenario.perturbations
    wheel_max = scenario.wheel_factor_max
    way_m = plan.distance_m * wheel_max
    yield Reach("TRN_POS.TrainPos", 0.0, way_m, ("plan", "distance_m"), plan.distance_m)
    yield Reach("TRK_INFO.TargetPos", 0.0, plan.distance_m, ("plan", "distance_m"), plan.distance_m)
    yield Reach("TRK_INFO.TargetTime", 0.0, plan.running_time_s, ("plan", "running_time_s"), plan.running_time_s)
    target_max_mps = float(target.speed_mps(np.arange(0.0, target.stop_time_s, _SAMPLE_S)).max())
    yield Reach("TRK_INFO.TargetSpeed", 0.0, target_max_mps, ("target",), f"{target_max_mps * 3.6:.2f} km/h")
    for row, (from_m, limit_mps) in enumerate(line.speed_limit_mps):
        found = [from_m, round(limit_mps * 3.6, 6)]
        yield Reach("TRK_INFO.SpeedLimit", 0.0, limit_mps, ("line", "speed_limit_kmh", row), found)
    for row, balise in enumerate(line.balises):
        at_m = balise.surveyed_m
        yield Reach("BALISE.BalisePos", at_m, at_m, ("line", "balises", row, "surveyed_m"), at_m)

    fastest_mps = max(limit for _, limit in front_speed_limit(line, train))
    noise_mps = max(sensors.speed_noise_sigma_mps, _most(drawn.speed_noise_sigma_mps, 0.0))
    read_mps = fastest_mps * wheel_max + SIGMAS * noise_mps + sensors.speed_lsb_mps
    noise_section = "sensors" if noise_mps == sensors.speed_noise_sigma_mps else "perturbations"
    # The key with the largest part of it is named.
    _, keys, value_mps = max(
        (fastest_mps, ("line", "speed_limit_kmh"), fastest_mps),
        (SIGMAS * noise_mps, (noise_section, "speed_noise_sigma_kmh"), noise_mps),
        (sensors.speed_lsb_mps, ("sensors", "speed_lsb_kmh"), sensors.speed_lsb_mps),
    )
    yield Reach("TRN_SPEED.TrainSpeed", 0.0, read_mps, keys, round(value_mps * 3.6, 6))

    grades = [
        permil * factor + offset
        for _, permil in line.grade_permil
        for factor in _ends(drawn.grade_factor, 1.0)
        for offset in _ends(drawn.grade_offset_permil, 0.0)
    ]
    grade_key = ("line", "grade_permil") if drawn.grade_factor is None else ("perturbations", "grade_factor")
    for signal in ("TRK_INFO.Gradient", "SIM_TRUTH.TrueGrade"):
        yield Reach(signal, min(grades), max(grades), grade_key, f"grades from {min(grades):g} to {max(grades):g}")

    yield Reach("NOTCH_CMD.NotchCmd", -train.notch_max, train.notch_max, ("train", "notch_max"), train.notch_max)
    yield Reach("TRN_POS.NotchActual", -train.notch_max, train.notch_max, ("train", "notch_max"), train.notch_max)
    inertia_kg = train.inertial_mass_kg * min(1.0, _ends(drawn.mass_factor, 1.0)[0])
    uphill_n, downhill_n = (float(resistance_n(train, 0.0, grade)) for grade in (max(grades), min(grades)))
    running_n = float(resistance_n(train, fastest_mps, 0.0)) * _most(drawn.davis_factor, 1.0)
    pull_n, push_n = _strongest_n(train.traction), _strongest_n(train.brake)
    for side, force_n, signal in (("traction", pull_n, "TractionForce"), ("brake", push_n, "BrakeForce")):
        yield Reach(f"SIM_TRUTH.{signal}", 0.0, force_n, ("train", side, "force_max_kn"), force_n / 1000)
    # Of a moving train: resistance by the grade and forces, each for the lightest train of all that are drawn.
    accel_mps2 = pull_n / inertia_kg - min(0.0, downhill_n) / train.inertial_mass_kg
    decel_mps2 = push_n / inertia_kg + (max(0.0, uphill_n) + running_n) / train.inertial_mass_kg
    for side, force_n, low, high in (("traction", pull_n, 0.0, accel_mps2), ("brake", push_n, -decel_mps2, 0.0)):
        yield Reach("SIM_TRUTH.TrueAccel", low, high, ("train", side, "force_max_kn"), force_n / 1000)


def _ends(drawn: Uniform | None, nominal: float) -> tuple[float, float]:
    return (nominal, nominal) if drawn is None else (min(drawn.low, nominal), max(drawn.high, nominal))


def _most(drawn: Uniform | None, nominal: float) -> float:
    return _ends(drawn, nominal)[1]


def _strongest_n(effort: Effort) -> float:
    """The largest force at any speed: power only lowers it."""
    speeds_mps = [0.0, *(speed for speed, _ in effort.curve)]
    return float(force_limit_n(Effort(effort.force_max_n, None, effort.curve), speeds_mps).max())
