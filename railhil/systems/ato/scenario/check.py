"""Consistency of a scenario beyond single values: conditions between values that a run requires, and its reaches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from itertools import pairwise
from math import fsum

import numpy as np

from railhil.common.digits import count_of
from railhil.common.errors import Words
from railhil.dbc import Contract
from railhil.faults.truth import HOLE_MAX_S
from railhil.scenarios.carried import SIGMAS, Reach
from railhil.scenarios.model import Timing
from railhil.scenarios.profiles import find_lowest
from railhil.scenarios.validation import Refuse
from railhil.systems.ato.scenario import model
from railhil.systems.ato.scenario.effort import force_limit_n, resistance_n
from railhil.systems.ato.scenario.model import Effort, Scenario, Uniform
from railhil.systems.ato.scenario.perturb import count_draws, name_draws
from railhil.systems.ato.scenario.target import Target

_SAMPLE_S = 0.1


def train_reaches(scenario: Scenario, target: Target) -> Iterator[Reach]:
    """Bounds that a run of ``ato`` can reach.

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

    fastest_mps = max(limit for _, limit in find_lowest(line.speed_limit_mps, train.length_m, train.speed_limit_mps))
    noise_mps = max(sensors.speed_noise_sigma_mps, _find_most(drawn.speed_noise_sigma_mps, 0.0))
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
        for factor in _find_ends(drawn.grade_factor, 1.0)
        for offset in _find_ends(drawn.grade_offset_permil, 0.0)
    ]
    grade_key = ("line", "grade_permil") if drawn.grade_factor is None else ("perturbations", "grade_factor")
    for signal in ("TRK_INFO.Gradient", "SIM_TRUTH.TrueGrade"):
        yield Reach(signal, min(grades), max(grades), grade_key, f"grades from {min(grades):g} to {max(grades):g}")

    yield Reach("NOTCH_CMD.NotchCmd", -train.notch_max, train.notch_max, ("train", "notch_max"), train.notch_max)
    yield Reach("TRN_POS.NotchActual", -train.notch_max, train.notch_max, ("train", "notch_max"), train.notch_max)
    inertia_kg = train.inertial_mass_kg * min(1.0, _find_ends(drawn.mass_factor, 1.0)[0])
    uphill_n, downhill_n = (float(resistance_n(train, 0.0, grade)) for grade in (max(grades), min(grades)))
    running_n = float(resistance_n(train, fastest_mps, 0.0)) * _find_most(drawn.davis_factor, 1.0)
    pull_n, push_n = _strongest_n(train.traction), _strongest_n(train.brake)
    for side, force_n, signal in (("traction", pull_n, "TractionForce"), ("brake", push_n, "BrakeForce")):
        yield Reach(f"SIM_TRUTH.{signal}", 0.0, force_n, ("train", side, "force_max_kn"), force_n / 1000)
    # Of a moving train: resistance by the grade and forces, each for the lightest train of all that are drawn.
    accel_mps2 = pull_n / inertia_kg - min(0.0, downhill_n) / train.inertial_mass_kg
    decel_mps2 = push_n / inertia_kg + (max(0.0, uphill_n) + running_n) / train.inertial_mass_kg
    for side, force_n, low, high in (("traction", pull_n, 0.0, accel_mps2), ("brake", push_n, -decel_mps2, 0.0)):
        yield Reach("SIM_TRUTH.TrueAccel", low, high, ("train", side, "force_max_kn"), force_n / 1000)


def _find_ends(drawn: Uniform | None, nominal: float) -> tuple[float, float]:
    return (nominal, nominal) if drawn is None else (min(drawn.low, nominal), max(drawn.high, nominal))


def _find_most(drawn: Uniform | None, nominal: float) -> float:
    return _find_ends(drawn, nominal)[1]


def _strongest_n(effort: Effort) -> float:
    """The largest force at any speed: power only lowers it."""
    speeds_mps = [0.0, *(speed for speed, _ in effort.curve)]
    return float(force_limit_n(Effort(effort.force_max_n, None, effort.curve), speeds_mps).max())


#: The target curve must reach the planned distance and time this closely (rounded hand-made nodes still
#: pass).
DISTANCE_TOLERANCE_M = 0.01
TIME_TOLERANCE_S = 0.01
#: Rounding by which the target may exceed a speed limit.
SPEED_TOLERANCE_MPS = 0.01
#: Above this delay the predictive laws limit-cycle (IPFC reading 6).
LOOP_DELAY_MAX_S = 0.3
#: A balise number may be reused only after this many others: receivers tell a balise from the previous one by its
#: number, and some in between may have been lost.
BALISES_BETWEEN = 15

#: By which the sum of the squares of a noise's coefficients may differ from 1.
NOISE_POWER_TOLERANCE = 1e-9

#: No train on rails is faster.
_FASTEST_MPS = 200.0
_NS_PER_MS = 1_000_000


def check_tables(train: model.Train, line: model.Line, refuse: Refuse) -> None:
    """Profiles, effort curves and balises in increasing order, limits above zero."""
    for key, rows in (("grade_permil", line.grade_permil), ("speed_limit_kmh", line.speed_limit_mps)):
        _check_increasing([row[0] for row in rows], ("line", key), refuse)
    for row, (_, limit_mps) in enumerate(line.speed_limit_mps):
        if limit_mps <= 0:
            raise refuse(("line", "speed_limit_kmh", row), round(limit_mps * 3.6, 6), "a limit above 0")
    for row, (_, permil) in enumerate(line.grade_permil):
        if abs(permil) > 200:
            raise refuse(("line", "grade_permil", row), permil, "a grade from -200 to 200 permil")
    efforts = {"traction": train.traction, "brake": train.brake, "electric_brake": train.electric_brake}
    for key, effort in efforts.items():
        if effort is None:
            continue
        _check_increasing([row[0] for row in effort.curve], ("train", key, "curve_kmh_kn"), refuse)
        for row, point in enumerate(effort.curve):
            if min(point) < 0:
                raise refuse(("train", key, "curve_kmh_kn", row), list(point), "speed and force of at least 0")
    order = sorted(range(len(line.balises)), key=lambda index: line.balises[index].surveyed_m)
    for place, index in enumerate(order):
        near = order[max(0, place - BALISES_BETWEEN) : place]
        number = line.balises[index].number
        if twins := [other for other in near if line.balises[other].number == number]:
            allowed = f"a number that none of the {BALISES_BETWEEN} balises before and behind it has"
            raise refuse(("line", "balises", max(index, *twins), "number"), number, allowed)
    if train.inertial_mass_kg < train.mass_kg:
        found = f"{train.inertial_mass_kg / 1000:g} t"
        raise refuse(("train", "inertial_mass_t"), found, "at least mass_t")


def check_timing(timing: Timing, perturbations: model.Perturbations, contract: Contract, refuse: Refuse) -> None:
    """Whole multiples of the base tick, loop delay below its hard limit and below the control period.

    :param contract: a scenario may set the period of a port that has one in its table.
    """
    tick_ns = timing.base_tick_ns
    if tick_ns <= 0:
        raise refuse(("timing", "base_tick_ms"), tick_ns / 1e6, "at least 0.000001 ms")
    known = [port.name for port in contract.ports if port.period_ns]
    for port in timing.port_period_ns:
        if port not in known:
            raise refuse(("timing", "port_period_ms", port), Words("no such port"), f"one of {', '.join(known)}")
    periods = {("timing", "control_period_ms"): timing.control_period_ns} | {
        ("timing", "port_period_ms", port): period_ns for port, period_ns in timing.port_period_ns.items()
    }
    for key, period_ns in periods.items():
        if period_ns <= 0 or period_ns % tick_ns:
            raise refuse(key, period_ns / 1e6, f"a whole multiple of base_tick_ms = {tick_ns / 1e6:g}")
    longest_s = min(LOOP_DELAY_MAX_S, timing.control_period_ns * 1e-9)
    if not 0 <= timing.loop_delay_s <= longest_s:
        raise refuse(("timing", "loop_delay_s"), timing.loop_delay_s, f"0 to {longest_s:g} s")
    delay = perturbations.loop_delay_s
    if delay is not None and not 0 <= delay.low <= delay.high <= longest_s:
        raise refuse(("perturbations", "loop_delay_s"), [delay.low, delay.high], f"0 to {longest_s:g} s")


def check_vector(scenario: Scenario, refuse: Refuse) -> None:
    """The scenario's own draws are as many as its run has, and its noise is standard normal."""
    draws, names = scenario.draws, name_draws(scenario)
    if draws and not any(names):
        raise refuse(("draws",), Words(count_of(len(draws), "number")), "none without [perturbations]")
    if draws and len(draws) != len(names):
        balises, of_line = len(scenario.line.balises), count_draws(scenario.line)
        of_faults = f", {len(names) - of_line} for values of faults" if len(names) > of_line else ""
        allowed = f"{len(names)} numbers: {of_line - balises} and one for each balise{of_faults}"
        raise refuse(("draws",), Words(count_of(len(draws), "number")), allowed)
    power = fsum(coefficient**2 for _, coefficient in scenario.noise)
    if scenario.noise and abs(power - 1.0) > NOISE_POWER_TOLERANCE:
        raise refuse(("noise",), power, f"1 +- {NOISE_POWER_TOLERANCE:g}, the sum of the squares of the coefficients")


def check_perturbations(perturbations: model.Perturbations, refuse: Refuse) -> None:
    """Bounds in order, factors above zero, noise not negative."""
    for name in (item.name for item in fields(perturbations)):
        bounds: model.Uniform | None = getattr(perturbations, name)
        if bounds is None:
            continue
        key = ("perturbations", "speed_noise_sigma_kmh" if name == "speed_noise_sigma_mps" else name)
        if bounds.low > bounds.high:
            raise refuse(key, [bounds.low, bounds.high], "[low, high] with low <= high")
        if name.endswith("factor") and bounds.low <= 0:
            raise refuse(key, [bounds.low, bounds.high], "factors above 0")
        if name == "speed_noise_sigma_mps" and bounds.low < 0:
            raise refuse(key, [bounds.low * 3.6, bounds.high * 3.6], "at least 0")


def check_watch(watch: model.WatchLimits, refuse: Refuse) -> None:
    """Each level of the ladder is entered later than the previous one."""
    levels = ("hold_ms", "traction_cut_ms", "service_brake_ms", "emergency_ms")
    for before, after in pairwise(levels):
        if getattr(watch, after) <= getattr(watch, before):
            raise refuse(("watch", after), getattr(watch, after), f"more than {before} = {getattr(watch, before)}")


def check_periods(timing: Timing, watch: model.WatchLimits, sdt: bool, contract: Contract, refuse: Refuse) -> None:
    """Check that no telegram of a healthy run is older than a watch allows, and that a safe command comes with its
    command."""
    tick_ns = timing.base_tick_ns
    usual = {port.name: port.period_ns for port in contract.ports}

    def ticks(port: str) -> int:
        return max(1, timing.port_period_ns.get(port, usual[port]) // tick_ns)

    # The train's watch sees the ticks of this age before the next command, the controller's watch all of them.
    longest_ns = {
        "TRN_SPEED": ("watch.hold_ms", max(watch.hold_ms * _NS_PER_MS, tick_ns)),
        "NOTCH_CMD": ("watch.hold_ms", watch.hold_ms * _NS_PER_MS // tick_ns * tick_ns + tick_ns),
        "TRN_POS": ("the age at which a position is lost", model.POSITION_AGE_MAX_MS * _NS_PER_MS),
        "TRK_INFO": ("watch.emergency_ms", watch.emergency_ms * _NS_PER_MS),
        "SIM_TRUTH": ("no verdict without the truth for longer", round(HOLE_MAX_S * 1e9)),
    }
    for port, (why, most_ns) in longest_ns.items():
        if ticks(port) * tick_ns > most_ns:
            keys = ("timing", "port_period_ms", port) if port in timing.port_period_ns else ("timing", "base_tick_ms")
            found_ms = timing.port_period_ns.get(port, tick_ns) / _NS_PER_MS
            raise refuse(keys, found_ms, f"{port} every {most_ns / _NS_PER_MS:g} ms at least: {why}")
    if sdt and ticks("NOTCH_SDT") != ticks("NOTCH_CMD"):
        key = "NOTCH_SDT" if "NOTCH_SDT" in timing.port_period_ns else "NOTCH_CMD"
        allowed = "NOTCH_SDT as often as NOTCH_CMD: with safety.sdt it confirms every command"
        raise refuse(("timing", "port_period_ms", key), timing.port_period_ns[key] / _NS_PER_MS, allowed)


def check_authority(scenario: model.Scenario, refuse: Refuse) -> None:
    """The emergency brake can follow the curve to the end of the train's authority."""
    watch, train = scenario.watch, scenario.train
    if not watch.end_of_authority:
        return
    speeds_mps = np.arange(0.0, min(train.speed_limit_mps, _FASTEST_MPS) + 1.0)
    steepest_permil = max(0.0, -min(permil for _, permil in scenario.line.grade_permil))
    force_n = float(force_limit_n(train.brake, speeds_mps).min()) - train.mass_kg * train.gravity_mps2 * (
        steepest_permil / 1000
    )
    largest_mps2 = force_n / train.inertial_mass_kg
    if watch.end_of_authority_braking_mps2 > largest_mps2:
        allowed = f"at most {largest_mps2:.2f} m/s2, what the brake gives on the steepest descent"
        raise refuse(("watch", "end_of_authority_braking_mps2"), watch.end_of_authority_braking_mps2, allowed)


def make_target(curve: model.TargetCurve, refuse: Refuse) -> Target:
    """The evaluated curve. Raises :class:`InputError` unless it starts at time 0, moves and stops."""
    key = ("target", "nodes_s_mps2")
    if len(curve.nodes) < 2:
        raise refuse(key, [list(node) for node in curve.nodes], "at least two nodes [time s, acceleration m/s2]")
    if curve.nodes[0][0] != 0:
        raise refuse((*key, 0), list(curve.nodes[0]), "time 0 in the first node")
    _check_increasing([node[0] for node in curve.nodes], key, refuse)
    if curve.nodes[-1][1] >= 0:
        raise refuse((*key, len(curve.nodes) - 1), list(curve.nodes[-1]), "a deceleration below 0 in the last node")
    try:
        return Target(curve)
    except ValueError as error:
        raise refuse(key, Words(str(error)), "a curve that stops") from None


def check_run(scenario: model.Scenario, target: Target, refuse: Refuse) -> None:
    """The target reaches the planned distance at the planned time and keeps to the speed limits."""
    plan = scenario.plan
    if abs(target.stop_position_m - plan.distance_m) > DISTANCE_TOLERANCE_M:
        raise refuse(
            ("plan", "distance_m"),
            plan.distance_m,
            f"{target.stop_position_m:.4f} m, where the target curve stops, +-{DISTANCE_TOLERANCE_M} m",
        )
    if abs(target.stop_time_s - plan.running_time_s) > TIME_TOLERANCE_S:
        raise refuse(
            ("plan", "running_time_s"),
            plan.running_time_s,
            f"{target.stop_time_s:.4f} s, when the target curve stops, +-{TIME_TOLERANCE_S} s",
        )
    if plan.distance_m * scenario.wheel_factor_max > model.DISTANCE_MAX_M:
        section = "sensors" if scenario.sensors.wheel_factor == scenario.wheel_factor_max else "perturbations"
        allowed = (
            f"at most {model.DISTANCE_MAX_M / plan.distance_m:g}: an odometer reads up to {model.DISTANCE_MAX_M:g} m"
        )
        raise refuse((section, "wheel_factor"), scenario.wheel_factor_max, allowed)
    time_s = np.arange(0.0, target.stop_time_s, _SAMPLE_S)
    speed, position = target.speed_mps(time_s), target.position_m(time_s)
    limit = find_lowest(scenario.line.speed_limit_mps, scenario.train.length_m, scenario.train.speed_limit_mps)
    row = np.clip(np.searchsorted([step[0] for step in limit], position, side="right") - 1, 0, None)
    above = speed - np.array([step[1] for step in limit])[row]
    worst = int(np.argmax(above))
    if above[worst] > SPEED_TOLERANCE_MPS:
        raise refuse(
            ("target",),
            f"{speed[worst] * 3.6:.2f} km/h at {time_s[worst]:.1f} s, {position[worst]:.1f} m",
            f"{limit[int(row[worst])][1] * 3.6:.2f} km/h there",
        )
    if float(speed.min()) < -SPEED_TOLERANCE_MPS:
        when = float(time_s[int(np.argmin(speed))])
        raise refuse(("target",), f"{float(speed.min()):.3f} m/s at {when:.1f} s", "no running back before the stop")


def _check_increasing(values: list[float], key: tuple[str | int, ...], refuse: Refuse) -> None:
    for row, (earlier, later) in enumerate(pairwise(values), start=1):
        if later <= earlier:
            raise refuse((*key, row), later, f"more than {earlier:g}: rows are in increasing order")
