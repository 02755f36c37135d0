"""Meaning of the keys of ``line``'s scenario files that ``ato`` does not have."""

from __future__ import annotations

from railhil.systems.ato.scenario import keys
from railhil.systems.line.scenario.protection_keys import ATP_MEANING

_STOPS = {
    "name": "name of a stop, in the order of the run",
    "position_m": "position of the train's front at its stopping point, in the line's positions",
    "service": "stop, pass (the train runs through) or terminal; default: stop, terminal for the last one",
    "platform": "side of the doors: left, right, both, or none",
    "psd": "whether the platform has doors of its own",
    "mode": "what the track side orders for the section from here: timetable, fast, normal or economy (its profile)",
    "arrive_s": "arrival by the timetable, from the start of the run; a multiple of the control period",
    "running_time_s": "from the departure before, instead of arrive_s",
    "depart_s": "departure by the timetable; default: the arrival plus route.dwell_s",
    "stop_error_max_m": "limit of a PASS here; default: that of the route",
    "dwell_min_s": "shortest time from standstill to departure here; default: that of the route",
    "eoa_overlap_m": "end of authority behind this stop; default: that of the protection",
    "svl_overlap_m": "supervised location behind this stop; default: that of the protection",
}
_CHOICE = {
    "from_stop": "first stop, name or number of a stop of the line's file (default: its first)",
    "to_stop": "last stop (default: that of the line's file)",
    "running_time_s": "running time of each section, if its stops do not give one",
    "dwell_s": "from arrival to departure by the timetable: one value, or one for each stop between the ends",
    "platform": "side of the doors: one for all stops, or one for each: left, right, both, none",
    "psd": "platform doors: one value for all stops, or one for each",
    "mode": "order for the sections: one for all stops, or one for each: timetable, fast, normal, economy",
    "target_files": "target curves of the sections, shipped names or paths; one that does not fit is generated",
}
_LEG = {
    **_CHOICE,
    "line": "return (the same line in the other direction), or a line file, whose first stop is the turn-back",
    "turn_back_s": "from the arrival at the turn-back to the departure",
}
_ROUTE = {
    **_CHOICE,
    "first_departure_s": "departure from the first stop, from the start of the run",
    "running_time_reserve_percent": "over the generator's fastest, rounded up to s, where no time is given",
    "stop_error_max_m": "limit of a PASS at every stop",
    "door_window_m": "doors open only if the train stands within this distance of the stopping point",
    "arrival_error_max_s": "limit of a PASS: early or late arrival",
    "departure_late_max_s": "limit of a late departure in the tables",
    "overtime_max_s": "end of the run after the last arrival of the timetable",
    "regulation": "retime (exact time left), profiles (fast, normal, economy) or none (always the timetable's)",
    "profiles_percent": "reserves of fast, normal and economy over the generator's fastest",
    "dwell_min_s": "shortest time from standstill to departure",
    "dwell_disturbance_s": "uniform bounds of what is added to each dwell, drawn with the seed in every run",
    "hold.probability": "probability of an additional dwell at a stop",
    "hold.extra_s": "its uniform bounds",
    "doors.open_s": "time that the doors take to open",
    "doors.close_s": "time that they take to close",
    "doors.warn_s": "warning before they close",
    "doors.reopen_max": "how often they reopen for an obstacle before they count as failed",
    "jog.attempts": "how often the train creeps on to a stopping point that it has not reached",
    "jog.reach_m": "from how far",
    "jog.speed_kmh": "largest speed of creeping",
    "signal[].position_m": "position of a signal, in the positions of its leg's line",
    "signal[].clear_s": "it shows red until this time of the run",
    "signal[].leg": "its leg, from 1",
}
#: By dotted key, with the keys of ``ato``.
MEANING = {
    **keys.MEANING,
    "system": "line",
    "section": "only this section, from 1, as a scenario of ato; also --section",
    "train.emergency.braking_mps2": "emergency brake: force as deceleration of the nominal inertial mass",
    "train.emergency.dead_s": "its dead time",
    "train.emergency.lag_s": "its time constant",
    "line.direction": "forward, or return: the line seen from the other cab at its last stop",
    "line.balises_before_stop_m": "balises at these distances before every stop, numbered along the run",
    **{f"route.stops[].{name}": meaning for name, meaning in _STOPS.items()},
    **{f"route.leg[].{name}": meaning for name, meaning in _LEG.items()},
    **{f"route.{name}": meaning for name, meaning in _ROUTE.items()},
    **{
        name.replace("target.", "route.", 1): meaning
        for name, meaning in keys.MEANING.items()
        if name.startswith("target.generate.")
    },
    **ATP_MEANING,
    "perturbations.section_mass_factor": "mass, drawn for each section: the load changes at the stops",
    "perturbations.atp_wheel_factor": "reading of the train protection's own axle sensor",
}
#: The keys that a scenario based on another one changes most often.
USUAL = (
    "route.running_time_reserve_percent",
    "route.stop_error_max_m",
    "route.arrival_error_max_s",
    "route.dwell_min_s",
    "route.dwell_disturbance_s",
    "route.regulation",
    *(name for name in keys.USUAL if not name.startswith("plan.")),
    "perturbations.section_mass_factor",
)
