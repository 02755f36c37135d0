"""What a run can reach, against what the signals of its telegrams can carry: checked when a scenario is loaded.

A :class:`Reach` says up to where a quantity can go in a run of the scenario, by the keys that determine it. The range
of the signal is that of the port table. Normal draws count up to :data:`SIGMAS` standard deviations. What lies beyond
(a rarer draw, a fault, a train that does not stop) is not refused here: a reading then stays at the end of its range
and its check variable says that it is erroneous, anything else ends the run as an error of the plant.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np

from railhil.common.errors import InputError
from railhil.dbc import Contract
from railhil.scenarios.effort import force_limit_n, resistance_n
from railhil.scenarios.model import Effort, Scenario, Uniform
from railhil.scenarios.profiles import front_speed_limit
from railhil.scenarios.target import Target

#: Standard deviations up to which a normal draw must be carried; one in 500 million goes further.
SIGMAS = 6.0
_SAMPLE_S = 0.1
Keys = tuple[str | int, ...]


class Reach(NamedTuple):
    """How far a quantity goes: ``PORT.Signal``, the smallest and the largest value in its unit.

    ``keys``, ``found``: the key that is named when the signal cannot carry it, and its value.
    """

    signal: str
    low: float
    high: float
    keys: Keys
    found: object


def check_carried(
    contract: Contract, reaches: Iterable[Reach], refuse: Callable[[Keys, object, str], InputError]
) -> None:
    """Refuse what the wire cannot carry.

    :raises InputError: a quantity can leave the range of its signal.
    """
    for reach in reaches:
        port, _, name = reach.signal.partition(".")
        signal = contract.port(port).signal(name)
        lowest, highest = (raw * signal.scale for raw in signal.raw_range)
        if signal.minimum is not None and signal.maximum is not None:
            lowest, highest = signal.minimum, signal.maximum
        # Half a count is rounded to the end of the range.
        if not lowest - signal.scale / 2 <= reach.low <= reach.high <= highest + signal.scale / 2:
            off = reach.low if reach.low < lowest else reach.high
            allowed = f"a value that keeps {reach.signal} within {lowest:.10g} to {highest:.10g} {signal.unit}"
            raise refuse(reach.keys, reach.found, f"{allowed.rstrip()}; this one makes it up to {off:.10g}")


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
