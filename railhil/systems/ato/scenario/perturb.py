"""Perturbed runs: one random draw of every quantity with a distribution in the scenario's ``perturbations``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from railhil.scenarios import streams
from railhil.scenarios.model import Timing
from railhil.systems.ato.scenario.model import Balise, Line, Scenario, Sensors, Train, Uniform


class _Draws:
    """Draws in a fixed order; a missing distribution still consumes its random number.

    Therefore the draw of one quantity does not depend on which other quantities a scenario perturbs.
    """

    def __init__(self, units: Sequence[Any]) -> None:
        self._units = iter(units)

    def between(self, bounds: Uniform | None, nominal: float) -> Any:
        unit = next(self._units)
        return nominal if bounds is None else bounds.low + (bounds.high - bounds.low) * unit


#: Number of draws per run, not counting one for each balise and those of its faults.
_DRAWS = 9


def count_draws(line: Line) -> int:
    """Number of draws of the perturbations of a run on a line. Those of its faults follow them."""
    return _DRAWS + len(line.balises)


def name_draws(scenario: Scenario) -> tuple[str | None, ...]:
    """The name of each draw, in their order; None: the scenario has no distribution for it."""
    given = scenario.perturbations
    named: list[tuple[str, Uniform | None]] = [
        ("mass factor", given.mass_factor),
        ("Davis factor", given.davis_factor),
        ("grade factor", given.grade_factor),
        ("grade offset", given.grade_offset_permil),
        ("actuator pole", given.actuator_pole_factor),
        ("force gain", given.force_gain_factor),
        ("speed noise", given.speed_noise_sigma_mps),
        ("wheel factor", given.wheel_factor),
        ("loop delay", given.loop_delay_s),
        *((f"balise {balise.number}", given.balise_position_error_m) for balise in scenario.line.balises),
    ]
    perturbed = tuple(name if bounds is not None else None for name, bounds in named)
    if not scenario.faults:
        return perturbed
    # Only a run with faults loads their language.
    from railhil.scenarios.fault_list import name_fault_draws

    return perturbed + name_fault_draws(scenario.faults)


def unit_draws(scenario: Scenario, seed: int) -> NDArray[np.float64]:
    """Numbers in 0..1 that determine the perturbations of a run, shape (draws,), behind which there may be others: the
    scenario's own ``draws``, else those of the seed.

    Raises ``ValueError`` for a negative seed.
    """
    if scenario.draws:
        return unit_numbers(np.array([scenario.draws])).reshape(-1)
    return streams.generator(seed, streams.PERTURBATION).random(count_draws(scenario.line))


def unit_numbers(draws: NDArray[np.float64]) -> NDArray[np.float64]:
    """Standard normal numbers of N runs as numbers in 0..1, shape (N, draws)."""
    return np.array([list(map(streams.probability_of, row)) for row in draws.tolist()])


def find_actual(scenario: Scenario, seed: int, perturbed: bool) -> Scenario:
    """The scenario of a run: perturbed if this is asked for, or if the scenario has its own draws.

    Raises ``ValueError`` for a negative seed.
    """
    return perturb(scenario, seed) if perturbed or scenario.draws else scenario


def perturb(scenario: Scenario, seed: int) -> Scenario:
    """The scenario with every quantity of ``scenario.perturbations`` drawn from its uniform distribution.

    The mass factor scales mass and inertial mass, the Davis factor all three coefficients, the grade is
    multiplied and then offset, the force gain scales the force per notch (not the force limits), and the
    balise error moves each balise against its surveyed position. ``sha256`` stays the nominal scenario's: together with
    the seed it identifies the run, and a controller that knows only the nominal train compares the same hash. Raises
    ``ValueError`` for a negative seed.
    """
    return apply_draws(scenario, unit_draws(scenario, seed).tolist())


def apply_draws(scenario: Scenario, units: Sequence[Any]) -> Scenario:
    """:func:`perturb` with given draws.

    :param units: one number for each draw, further ones are ignored; with arrays of shape (N,) the perturbed quantities
        are such arrays as well.
    """
    given = scenario.perturbations
    draws = _Draws(units)
    mass = draws.between(given.mass_factor, 1.0)
    davis = draws.between(given.davis_factor, 1.0)
    grade_factor = draws.between(given.grade_factor, 1.0)
    grade_offset_permil = draws.between(given.grade_offset_permil, 0.0)
    pole = draws.between(given.actuator_pole_factor, 1.0)
    gain = draws.between(given.force_gain_factor, 1.0)
    sensors = Sensors(
        speed_lsb_mps=scenario.sensors.speed_lsb_mps,
        speed_noise_sigma_mps=draws.between(given.speed_noise_sigma_mps, scenario.sensors.speed_noise_sigma_mps),
        odometer_lsb_m=scenario.sensors.odometer_lsb_m,
        wheel_factor=draws.between(given.wheel_factor, scenario.sensors.wheel_factor),
    )
    timing: Timing = replace(
        scenario.timing, loop_delay_s=draws.between(given.loop_delay_s, scenario.timing.loop_delay_s)
    )
    train: Train = replace(
        scenario.train,
        mass_kg=scenario.train.mass_kg * mass,
        inertial_mass_kg=scenario.train.inertial_mass_kg * mass,
        davis_a_n_per_kn=scenario.train.davis_a_n_per_kn * davis,
        davis_b_n_per_kn_kmh=scenario.train.davis_b_n_per_kn_kmh * davis,
        davis_c_n_per_kn_kmh2=scenario.train.davis_c_n_per_kn_kmh2 * davis,
        actuator_pole_per_s=scenario.train.actuator_pole_per_s * pole,
        force_per_notch_n=scenario.train.force_per_notch_n * gain,
    )
    line: Line = replace(
        scenario.line,
        grade_permil=tuple(
            (from_m, permil * grade_factor + grade_offset_permil) for from_m, permil in scenario.line.grade_permil
        ),
        balises=tuple(
            Balise(
                balise.number,
                balise.surveyed_m,
                balise.true_m + draws.between(given.balise_position_error_m, 0.0),
            )
            for balise in scenario.line.balises
        ),
    )
    # The draws have been applied: nothing may apply them again.
    return replace(scenario, train=train, line=line, sensors=sensors, timing=timing, draws=())
