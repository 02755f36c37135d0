"""From checked file tables (units as written) to :mod:`.model` (SI units)."""

from __future__ import annotations

from dataclasses import dataclass, replace

from railhil.common.errors import Finding, Sentence, Words
from railhil.scenarios.validation import Keys, Refuse
from railhil.systems.ato.scenario import model, schema
from railhil.systems.ato.scenario.generate import CurveLimits
from railhil.systems.ato.scenario.importers import railtoolkit, ttobench
from railhil.systems.ato.scenario.importers.section import Stop, StopLine, list_begins


def effort(table: schema.EffortTable) -> model.Effort:
    """Force limit in N over m/s."""
    return model.Effort(
        force_max_n=table.force_max_kn * 1000,
        power_max_w=None if table.power_max_kw is None else table.power_max_kw * 1000,
        curve=tuple((kmh / 3.6, kn * 1000) for kmh, kn in table.curve_kmh_kn or ()),
    )


def train(table: schema.TrainTable | schema.ImportedTrainTable, refuse: Refuse) -> model.Train:
    """The train, with inertial mass and force per notch computed. Raises :class:`InputError`."""
    if isinstance(table, schema.ImportedTrainTable):
        return railtoolkit.load_train(
            table.railtoolkit,
            train_id=table.train_id,
            actuator_pole_per_s=table.actuator_pole_per_s,
            accel_per_notch_mps2=table.accel_per_notch_mps2,
            notch_max=table.notch_max,
        )
    mass_kg = table.mass_t * 1000
    if table.inertial_mass_t is not None and table.rotating_mass_factor is None:
        inertial_mass_kg = table.inertial_mass_t * 1000
    elif table.rotating_mass_factor is not None and table.inertial_mass_t is None:
        inertial_mass_kg = mass_kg * (1 + table.rotating_mass_factor)
    else:
        raise refuse(("train",), *_one_of("rotating_mass_factor", table.rotating_mass_factor, "inertial_mass_t"))
    if table.force_per_notch_n is not None and table.accel_per_notch_mps2 is None:
        force_per_notch_n = table.force_per_notch_n
    elif table.accel_per_notch_mps2 is not None and table.force_per_notch_n is None:
        force_per_notch_n = table.accel_per_notch_mps2 * inertial_mass_kg
    else:
        raise refuse(("train",), *_one_of("force_per_notch_n", table.force_per_notch_n, "accel_per_notch_mps2"))
    return model.Train(
        name=table.name,
        mass_kg=mass_kg,
        inertial_mass_kg=inertial_mass_kg,
        length_m=table.length_m,
        davis_a_n_per_kn=table.davis.a_n_per_kn,
        davis_b_n_per_kn_kmh=table.davis.b_n_per_kn_kmh,
        davis_c_n_per_kn_kmh2=table.davis.c_n_per_kn_kmh2,
        traction=effort(table.traction),
        brake=effort(table.brake),
        actuator_pole_per_s=table.actuator_pole_per_s,
        force_per_notch_n=force_per_notch_n,
        notch_max=table.notch_max,
        speed_limit_mps=table.speed_limit_kmh / 3.6,
        service_braking_mps2=table.service_braking_mps2,
        gravity_mps2=table.gravity_mps2,
        electric_brake=None if table.electric_brake is None else effort(table.electric_brake),
    )


@dataclass(frozen=True, slots=True)
class RunLine:
    """The line of a run: the length of its section if it was cut between two stops, and remarks about its file."""

    line: model.Line
    section_m: float | None
    remarks: tuple[str, ...]


def line(table: schema.LineTable, train_length_m: float, refuse: Refuse) -> RunLine:
    """The line of the run.

    Raises :class:`InputError` for contradictory or missing sources and for unknown stops.
    """
    whole = whole_line(table, train_length_m, refuse)
    if table.from_stop is None and table.to_stop is None:
        if table.stops:
            found = Finding(f"{len(table.stops)} stops in system ato")
            allowed = '2 of them by from_stop and to_stop; several stops: system = "line"'
            raise refuse(("line", "stops"), found, allowed)
        if table.balises_before_stop_m:
            key = ("line", "balises_before_stop_m")
            raise refuse(key, table.balises_before_stop_m, Sentence("used only with line.from_stop"))
        return RunLine(whole.line, None, _remarks(whole, 0.0))
    here, there = (
        find_stop(whole, ("line", key), choice, refuse)
        for key, choice in (("from_stop", table.from_stop), ("to_stop", table.to_stop))
    )
    if whole.stops[there].position_m <= whole.stops[here].position_m:
        raise refuse(("line", "to_stop"), table.to_stop, "a stop behind from_stop in the direction of running")
    section = whole.section(here, there, train_length_m, tuple(table.balises_before_stop_m))
    start_m = whole.stops[here].position_m
    return RunLine(section, whole.stops[there].position_m - start_m, _remarks(whole, start_m))


def _remarks(whole: StopLine, start_m: float) -> tuple[str, ...]:
    return tuple(f"line: {remark}" for remark in (*whole.remarks, *list_begins(whole.line, start_m)))


def find_stop(whole: StopLine, keys: Keys, choice: str | int | None, refuse: Refuse) -> int:
    """Index of the stop that a key names.

    Raises :class:`InputError` unless there is exactly one such stop.
    """
    names = [stop.name for stop in whole.stops]
    if isinstance(choice, int) and 0 <= choice < len(names):
        return choice
    if isinstance(choice, str) and names.count(choice) > 1:
        numbers = ", ".join(str(number) for number, name in enumerate(names) if name == choice)
        raise refuse(keys, Words(f"{choice} is the name of several stops"), f"one of their numbers {numbers}")
    if isinstance(choice, str) and choice in names:
        return names.index(choice)
    allowed = ", ".join(names) if names else "no stop: the line has none"
    raise refuse(keys, Words() if choice is None else choice, f"one of {allowed}")


def whole_line(table: schema.TrackTable, train_length_m: float, refuse: Refuse) -> StopLine:
    """The whole line with its stops: those of the table, otherwise those of its file.

    Raises :class:`InputError` for contradictory or missing sources.
    """
    own = table.grade_permil is not None or table.speed_limit_kmh is not None
    sources = [
        word
        for word, given in (
            ("profiles", own),
            ("railtoolkit", table.railtoolkit),
            ("ttobench", table.ttobench),
            ("railml", table.railml),
        )
        if given
    ]
    if len(sources) != 1:
        words = Words(" and ".join(sources) or "neither profiles nor an import")
        raise refuse(("line",), words, "one of grade_permil with speed_limit_kmh, railtoolkit, ttobench, railml")
    balises = tuple(
        model.Balise(balise.number, balise.surveyed_m, balise.surveyed_m if balise.true_m is None else balise.true_m)
        for balise in table.balises
    )
    if table.railtoolkit is not None:
        found = railtoolkit.load_line(table.railtoolkit, train_length_m=train_length_m, path_id=table.path_id)
    elif table.ttobench is not None:
        found = ttobench.load_line(table.ttobench)
    elif table.railml is not None:
        # Imported here, because few scenarios have such a file and every process would load the parser.
        from railhil.systems.ato.scenario.importers import railml

        found = railml.load_line(
            table.railml,
            track_ids=table.track_ids or (),
            reverse=table.track_direction == "reverse",
            default_limit_mps=None if table.default_limit_kmh is None else table.default_limit_kmh / 3.6,
        )
    else:
        if table.grade_permil is None or table.speed_limit_kmh is None or table.name is None:
            raise refuse(("line",), Words("not all of them"), "name, grade_permil and speed_limit_kmh together")
        limits = tuple((from_m, limit_kmh / 3.6) for from_m, limit_kmh in table.speed_limit_kmh)
        found = StopLine(model.Line(table.name, tuple(table.grade_permil), limits), ())
    lines = found.line
    named = model.Line(table.name or lines.name, lines.grade_permil, lines.speed_limit_mps, balises or lines.balises)
    stops = tuple(Stop(stop.name, stop.position_m) for stop in table.stops)
    return replace(found, line=named, stops=stops or found.stops)


def plan(table: schema.PlanTable, running_time_s: float) -> model.RunPlan:
    """The run plan with the running time that was given or computed."""
    return model.RunPlan(
        distance_m=table.distance_m,
        running_time_s=running_time_s,
        stop_error_max_m=table.stop_error_max_m,
        time_error_max_s=table.time_error_max_s,
        overtime_max_s=table.overtime_max_s,
    )


def sensors(table: schema.SensorsTable) -> model.Sensors:
    """Sensors in SI units."""
    return model.Sensors(
        speed_lsb_mps=table.speed_lsb_kmh / 3.6,
        speed_noise_sigma_mps=table.speed_noise_sigma_kmh / 3.6,
        odometer_lsb_m=table.odometer_lsb_m,
        wheel_factor=table.wheel_factor,
    )


def energy(table: schema.EnergyTable) -> model.Energy:
    """Energy coefficients, auxiliary power in W."""
    return model.Energy(
        xi_m=table.xi_m,
        xi_b=table.xi_b,
        auxiliary_power_w=table.auxiliary_power_kw * 1000,
        regenerative_efficiency=table.regenerative_efficiency,
    )


def watch(table: schema.WatchTable) -> model.WatchLimits:
    """Reaction ladder, margin in m/s."""
    return model.WatchLimits(
        hold_ms=table.hold_ms,
        traction_cut_ms=table.traction_cut_ms,
        service_brake_ms=table.service_brake_ms,
        emergency_ms=table.emergency_ms,
        overspeed_margin_mps=table.overspeed_margin_kmh / 3.6,
        speed_change_max_mps2=table.speed_change_max_mps2,
        stuck_change_mps=table.stuck_change_kmh / 3.6,
        scale_error_max_percent=table.scale_error_max_percent,
        channel_bad_max=table.channel_bad_max,
        brake_share_min_percent=table.brake_share_min_percent,
        runaway_mps=table.runaway_kmh / 3.6,
        overruns_max=table.overruns_max,
        notch_step_max=table.notch_step_max,
        two_sources_max=table.two_sources_max,
        traction_left_max_percent=table.traction_left_max_percent,
        grade_allowance_permil=table.grade_allowance_permil,
        end_of_authority=table.end_of_authority,
        end_of_authority_margin_m=table.end_of_authority_margin_m,
        end_of_authority_braking_mps2=table.end_of_authority_braking_mps2,
    )


def safety(table: schema.SafetyTable) -> model.Safety:
    """Safe data transmission."""
    return model.Safety(sdt=table.sdt, n_rxsafe=table.n_rxsafe, cmthr=table.cmthr)


def uniform(pair: tuple[float, float] | None, divide: float = 1.0) -> model.Uniform | None:
    """A distribution from its bounds, both divided by a number."""
    return None if pair is None else model.Uniform(pair[0] / divide, pair[1] / divide)


def perturbations(table: schema.PerturbationsTable) -> model.Perturbations:
    """Distributions in SI units."""

    return model.Perturbations(
        mass_factor=uniform(table.mass_factor),
        davis_factor=uniform(table.davis_factor),
        grade_offset_permil=uniform(table.grade_offset_permil),
        grade_factor=uniform(table.grade_factor),
        actuator_pole_factor=uniform(table.actuator_pole_factor),
        force_gain_factor=uniform(table.force_gain_factor),
        speed_noise_sigma_mps=uniform(table.speed_noise_sigma_kmh, 3.6),
        loop_delay_s=uniform(table.loop_delay_s),
        wheel_factor=uniform(table.wheel_factor),
        balise_position_error_m=uniform(table.balise_position_error_m),
    )


def curve_limits(table: schema.GenerateTable) -> CurveLimits:
    """Limits of a generated target speed curve in SI units."""
    return CurveLimits(
        accel_max_mps2=table.accel_max_mps2,
        braking_max_mps2=table.braking_max_mps2,
        jerk_max_mps3=table.jerk_max_mps3,
        end_braking_mps2=table.end_braking_mps2,
        traction_utilisation=table.traction_utilisation,
        brake_utilisation=table.brake_utilisation,
        speed_margin_mps=table.speed_margin_kmh / 3.6,
        hold_min_s=table.hold_min_s,
        coast=table.coast,
    )


def _one_of(first: str, given: float | None, second: str) -> tuple[Words, str]:
    return Words("both" if given is not None else "neither"), f"exactly one of {first} and {second}"
