"""The sections of a line as scenarios of ``ato``, their target curves, and the choice of a running time.

A section has coordinates of its own: position 0 is the stopping point of its departure stop, time 0 its departure.
"""

from __future__ import annotations

from dataclasses import fields, replace
from functools import lru_cache

from railhil.scenarios import profiles
from railhil.systems.ato.scenario.canonical import scenario_sha256
from railhil.systems.ato.scenario.generate import CurveLimits, generate, generate_fastest
from railhil.systems.ato.scenario.model import Balise, Line, Perturbations, RunPlan, Scenario, TargetCurve, Train
from railhil.systems.ato.scenario.target import target_of
from railhil.systems.line.scenario.model import LineScenario, Mode, Section
from railhil.systems.line.scenario.statement import OVERSPEED, PROTECTION

#: Largest running time of a section, as a multiple of that of the timetable (chosen).
RUNNING_TIME_MAX_RATIO = 1.3
#: A curve may become faster by this ratio when it is fitted to place and time; beyond it, it is generated again.
FASTER_MAX_RATIO = 1.001
#: The ways to choose a running time: exact time left, or one of the profiles, in the order of ``Section.profiles``.
PROFILES = ("fast", "normal", "economy")


def cut_section(leg: Line, train: Train, from_m: float, to_m: float, name: str) -> Line:
    """The line between two places, in coordinates that begin at the first one.

    It keeps the profiles under the train that stands at ``from_m``, and the balises from one place to the other.

    :param leg: its profiles and balises in the coordinates of ``from_m`` and ``to_m``.
    """
    rear_m = from_m - train.length_m
    return Line(
        name=name,
        grade_permil=profiles.shift(profiles.cut(leg.grade_permil, rear_m, to_m), from_m),
        speed_limit_mps=profiles.shift(profiles.cut(leg.speed_limit_mps, rear_m, to_m), from_m),
        balises=tuple(
            Balise(balise.number, balise.surveyed_m - from_m, balise.true_m - from_m)
            for balise in leg.balises
            if from_m <= balise.surveyed_m <= to_m
        ),
    )


def section_line(line: LineScenario, index: int) -> Line:
    """Profiles and balises of a section in its own coordinates.

    :param index: number of the section, from 0.
    """
    section = line.sections[index]
    here, there = line.stops[section.departure], line.stops[section.arrival]
    leg = line.legs[section.leg]
    name = f"{leg.name}: {here.name} - {there.name}"
    return cut_section(leg, line.train, here.position_m, there.position_m, name)


def section_scenario(
    line: LineScenario, index: int, target: TargetCurve | None = None, running_time_s: float | None = None
) -> Scenario:
    """A section as a complete scenario of ``ato``, in its own coordinates.

    The faults of the line are left out. A mass drawn for each section becomes the mass drawn for the run, unless the
    line has one that is drawn for all sections.

    :param index: number of the section, from 0.
    :param target: its target curve; None: that of the timetable.
    :param running_time_s: its running time; None: that of the timetable.
    """
    section = line.sections[index]
    here, there = line.stops[section.departure], line.stops[section.arrival]
    drawn = line.perturbations
    perturbations = Perturbations(**{item.name: getattr(drawn, item.name) for item in fields(Perturbations)})
    scenario = Scenario(
        name=f"{line.name}_section_{index + 1}",
        title=f"{line.title}: section {index + 1}, {here.name} - {there.name}",
        train=line.train,
        line=section_line(line, index),
        target=section.target if target is None else target,
        plan=RunPlan(
            distance_m=there.position_m - here.position_m,
            running_time_s=section.running_time_s if running_time_s is None else running_time_s,
            stop_error_max_m=there.stop_error_max_m,
            time_error_max_s=line.route.arrival_error_max_s,
        ),
        timing=line.timing,
        sensors=line.sensors,
        energy=line.energy,
        watch=line.watch,
        perturbations=replace(perturbations, mass_factor=drawn.mass_factor or drawn.section_mass_factor),
        law=line.usual_law,
        assumptions=tuple(
            sentence for sentence in line.assumptions if not sentence.startswith((PROTECTION, OVERSPEED))
        ),
    )
    return replace(scenario, sha256=scenario_sha256(scenario))


def make_target(
    line: LineScenario,
    index: int,
    running_time_s: float,
    distance_m: float,
    curve: TargetCurve | None = None,
) -> TargetCurve:
    """A target curve of a section with exactly this running time and distance.

    The curve of the timetable, a given one or else a generated one is fitted by :func:`fit_target`. The generator runs
    once for equal arguments. A generated curve that the fit would make too fast is generated for the distance itself.

    :param index: number of the section, from 0.
    :param curve: a curve of this section to fit, such as one of its profiles.
    :raises CurveError: no curve is as fast as that.
    """
    section = line.sections[index]
    plain_m = line.stops[section.arrival].position_m - line.stops[section.departure].position_m
    if curve is None and running_time_s == section.running_time_s:
        if distance_m == plain_m:
            return section.target
        curve = section.target
    limits, track = line.route.generate, section_line(line, index)
    if curve is None:
        curve = generate_once(track, line.train, plain_m, running_time_s, limits)
    evaluated = target_of(curve)
    k, s = running_time_s / evaluated.stop_time_s, distance_m / evaluated.stop_position_m
    if s > k * FASTER_MAX_RATIO:
        curve = generate_once(track, line.train, distance_m, running_time_s, limits)
    return fit_target(curve, running_time_s, distance_m)


def fit_target(curve: TargetCurve, running_time_s: float, distance_m: float) -> TargetCurve:
    """The curve, stretched in time and distance: ``t -> t k``, ``a -> a s / k^2``.

    It stops after ``running_time_s`` at ``distance_m`` exactly: k and s are the ratios to its own duration and
    distance. Speeds grow by s / k.
    """
    evaluated = target_of(curve)
    k, s = running_time_s / evaluated.stop_time_s, distance_m / evaluated.stop_position_m
    return TargetCurve(tuple((time_s * k, accel_mps2 * s / k**2) for time_s, accel_mps2 in curve.nodes))


def ordered_time_s(line: LineScenario, section: Section, mode: Mode) -> float:
    """The running time of the profile that the track side orders for a section; without an order the timetable's."""
    if mode == "timetable":
        return section.running_time_s
    place = PROFILES.index(mode)
    if section.profiles:
        return target_of(section.profiles[place]).stop_time_s
    return section.fastest_s * (1.0 + line.route.profiles_percent[place] / 100.0)


def choose_running_time(
    line: LineScenario, index: int, departure_s: float, mode: Mode | None = None
) -> tuple[str, float, TargetCurve | None]:
    """The running time of a section for a departure at a time of the run.

    It is that of the profile that the track side orders. Without such an order it is the time that is left until the
    arrival of the timetable, at least the generator's fastest and at most :data:`RUNNING_TIME_MAX_RATIO` times the
    timetable's.

    :param index: number of the section, from 0.
    :param mode: the order of the track side; None: that of the scenario.
    :returns: ``timetable``, or the name of a profile; the running time in s; and the profile's curve, which the caller
        fits to that time by :func:`make_target`. It is None where no curve is given.
    """
    section, regulation = line.sections[index], line.route.regulation
    mode = line.stops[section.departure].mode if mode is None else mode
    if mode != "timetable":
        curve = section.profiles[PROFILES.index(mode)] if section.profiles else None
        return mode, ordered_time_s(line, section, mode), curve
    if regulation == "none":
        return "timetable", section.running_time_s, section.target
    due_s = line.stops[section.arrival].arrive_s
    assert due_s is not None
    most_s = max(RUNNING_TIME_MAX_RATIO * section.running_time_s, section.fastest_s)
    left_s = min(max(due_s - departure_s, section.fastest_s), most_s)
    if regulation != "profiles" or not section.profiles:
        return "timetable", left_s, None
    durations_s = [target_of(curve).stop_time_s for curve in section.profiles]
    fitting = [place for place, duration_s in enumerate(durations_s) if duration_s <= left_s]
    chosen = max(fitting, key=durations_s.__getitem__, default=0)
    return PROFILES[chosen], max(left_s, durations_s[chosen]), section.profiles[chosen]


@lru_cache(maxsize=256)
def generate_once(
    line: Line, train: Train, distance_m: float, running_time_s: float, limits: CurveLimits
) -> TargetCurve:
    """:func:`railhil.systems.ato.scenario.generate.generate`, made once for equal arguments."""
    return generate(line, train, distance_m, running_time_s, limits)


@lru_cache(maxsize=256)
def find_fastest(line: Line, train: Train, distance_m: float, limits: CurveLimits) -> tuple[float, TargetCurve]:
    """:func:`railhil.systems.ato.scenario.generate.generate_fastest`, made once for equal arguments: a command loads
    its scenario more than once."""
    return generate_fastest(line, train, distance_m, limits)


def fastest_curve(line: LineScenario, index: int) -> TargetCurve:
    """The curve of the shortest running time that regulation can ask a section for.

    :param index: number of the section, from 0.
    """
    section = line.sections[index]
    from_m, to_m = line.stops[section.departure].position_m, line.stops[section.arrival].position_m
    track = cut_section(line.legs[section.leg], line.train, from_m, to_m, "")
    return find_fastest(track, line.train, to_m - from_m, line.route.generate)[1]
