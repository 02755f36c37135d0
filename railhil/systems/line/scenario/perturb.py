"""Perturbed runs over a line: one draw for all legs and balises, and a mass for each section."""

from __future__ import annotations

from dataclasses import dataclass, replace

from railhil.scenarios import streams
from railhil.scenarios.profiles import Profile
from railhil.systems.ato.scenario.model import Balise, Line, Uniform
from railhil.systems.ato.scenario.perturb import apply_draws, unit_draws
from railhil.systems.line.scenario.model import LineScenario


@dataclass(frozen=True, slots=True)
class DrawnLine:
    """The scenario of a run, and what its draws add.

    ``section_masses``: factor of the train's mass in each section. ``atp_wheel_factor``: share of the true distance and
    speed that the train protection's own axle sensor reads.
    """

    scenario: LineScenario
    section_masses: tuple[float, ...]
    atp_wheel_factor: float = 1.0


def draw_line(scenario: LineScenario, seed: int, drawn: bool = True) -> DrawnLine:
    """What :func:`railhil.systems.ato.scenario.perturb.perturb` does for a train of ``ato``, for the whole line.

    The train, the grades of all legs and the balises of all legs are drawn once. The number for the wheel of the train
    protection follows those of the balises, so it changes none of them. The masses of the sections come from a stream
    of their own, one number each.

    :param drawn: whether the run is perturbed; otherwise nothing is drawn.
    :raises ValueError: a negative seed.
    """
    if not drawn:
        return DrawnLine(scenario, (1.0,) * len(scenario.sections))
    joined = replace(scenario, line=_join(scenario.legs))
    units = unit_draws(joined, seed).tolist()
    actual = apply_draws(joined, units)
    assert isinstance(actual, LineScenario)
    legs = _split(actual.line, scenario.legs)
    given = scenario.perturbations
    last = streams.generator(seed, streams.PERTURBATION).random(len(units) + 1).tolist()[-1]
    loads = streams.generator(seed, streams.SECTION_LOAD).random(len(scenario.sections)).tolist()
    return DrawnLine(
        replace(actual, line=legs[0], legs=legs),
        tuple(_between(given.section_mass_factor, unit) for unit in loads),
        _between(given.atp_wheel_factor, last),
    )


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
