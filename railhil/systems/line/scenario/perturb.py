"""Perturbed runs over a line: one draw for all legs and balises, and a mass for each section."""

from __future__ import annotations

from dataclasses import replace

from railhil.scenarios import streams
from railhil.scenarios.profiles import Profile
from railhil.systems.ato.scenario.model import Balise, Line, Uniform
from railhil.systems.ato.scenario.perturb import apply_draws, unit_draws
from railhil.systems.line.scenario.model import LineScenario


def perturb_line(line: LineScenario, seed: int) -> LineScenario:
    """What :func:`railhil.systems.ato.scenario.perturb.perturb` does for a train of ``ato``, for the whole line.

    The train, the grades of all legs and the balises of all legs are drawn once.

    :raises ValueError: a negative seed.
    """
    joined = replace(line, line=_join(line.legs))
    actual = apply_draws(joined, unit_draws(joined, seed).tolist())
    legs = _split(actual.line, line.legs)
    return replace(line, train=actual.train, sensors=actual.sensors, timing=actual.timing, line=legs[0], legs=legs)


def section_mass_factors(line: LineScenario, seed: int) -> tuple[float, ...]:
    """Factor of the train's mass in each section, one number of a stream of their own each.

    It is on top of the factor that is drawn for the whole line.

    :raises ValueError: a negative seed.
    """
    units = streams.generator(seed, streams.SECTION_LOAD).random(len(line.sections)).tolist()
    return tuple(_between(line.perturbations.section_mass_factor, unit) for unit in units)


def atp_wheel_factor(line: LineScenario, seed: int) -> float:
    """Share of the true distance and speed that the train protection's own axle sensor reads.

    Its number follows those of the balises, so it changes none of them.

    :raises ValueError: a negative seed.
    """
    earlier = len(unit_draws(replace(line, line=_join(line.legs)), seed))
    unit = streams.generator(seed, streams.PERTURBATION).random(earlier + 1).tolist()[-1]
    return _between(line.perturbations.atp_wheel_factor, unit)


def _between(bounds: Uniform | None, unit: float) -> float:
    return 1.0 if bounds is None else bounds.low + (bounds.high - bounds.low) * unit


def _join(legs: tuple[Line, ...]) -> Line:
    """The grades and balises of all legs, one after the other; only for draws, which go row by row."""
    grades: Profile = tuple(row for leg in legs for row in leg.grade_permil)
    balises: tuple[Balise, ...] = tuple(balise for leg in legs for balise in leg.balises)
    return replace(legs[0], grade_permil=grades, balises=balises)


def _split(joined: Line, legs: tuple[Line, ...]) -> tuple[Line, ...]:
    """The legs with the drawn grades and balises of their joined line."""
    grades, balises, drawn = list(joined.grade_permil), list(joined.balises), []
    for leg in legs:
        own = tuple(grades[: len(leg.grade_permil)]), tuple(balises[: len(leg.balises)])
        del grades[: len(leg.grade_permil)], balises[: len(leg.balises)]
        drawn.append(replace(leg, grade_permil=own[0], balises=own[1]))
    return tuple(drawn)
