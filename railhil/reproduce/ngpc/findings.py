"""Tables, bands, statements and figures, beside what the papers print."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from statistics import fmean

from railhil.charts.figure import FREE, TARGET, Chart, Curve, Figure
from railhil.common.digits import count_of
from railhil.report.styles import styles
from railhil.reproduce.comparison import (
    Line,
    Statement,
    Table,
    bounded_line,
    check_bounds,
    divide,
    is_less,
    render,
)
from railhil.reproduce.ngpc.runs import (
    ADAPTIVE,
    BP,
    BRAKING,
    CALM,
    COUPLER_KN,
    CYCLES,
    DRAWN,
    ELM,
    EMERGENCY,
    LAWS,
    MULTI_MODEL,
    MUTATION,
    NORMAL,
    PERIOD_S,
    PERIODS_S,
    PID,
    SITUATIONS,
    SPREAD,
    STOP_M,
    TEXT,
    UNITS,
    UNITS_RMSE,
    WHOLE,
    WIDEST,
    WINDOWS,
    list_laws,
    list_runs,
    name_effort_run,
    name_model_error,
    name_record,
    name_run,
    name_units_run,
)
from railhil.reproduce.paper import Results
from railhil.systems.high_speed.ride import Ride

PRINTED = TEXT.published
_OVER_SEEDS = ("mean", "least", "greatest")
_TITLES = {WHOLE: "RMSE", BRAKING: "RMSE", WINDOWS: "RMSE in the windows", STOP_M: "stop"}
#: Comparisons of the paper's law with another one: statement, situation, figure of the run, the other law.
_COMPARED = (
    ("normal", NORMAL, WHOLE, MULTI_MODEL),
    ("emergency", EMERGENCY, BRAKING, MULTI_MODEL),
    ("emergency_distance", EMERGENCY, STOP_M, ADAPTIVE),
    ("mutation", MUTATION, WINDOWS, MULTI_MODEL),
    ("mutation_peak", MUTATION, WIDEST, MULTI_MODEL),
)
#: Figures of three units: title, name, unit, digits.
_UNIT_FIGURES = (
    ("RMSE of all units", UNITS_RMSE, "km/h", 4),
    ("largest difference of speeds", SPREAD, "km/h", 3),
    ("largest coupler force", COUPLER_KN, "kN", 1),
)
#: Numbers of the figures of each situation.
_FIGURES = {NORMAL: (8, 9), EMERGENCY: (10, 11), MUTATION: (12, 13)}
#: Around the emergency only, km.
_EMERGENCY_KM = (209.0, 215.0)


def _list_keys(situation: str, law: str, results: Results) -> list[str]:
    return list_runs(situation, law, results.seeds)


def _find_mean(results: Results, situation: str, law: str, name: str) -> float | None:
    """Mean of a figure over the seeds whose runs were made."""
    return results.find_spread(_list_keys(situation, law, results), name)[0]


def compare(results: Results) -> list[Table]:
    """All tables."""
    periods = tuple(f"{period_s:g} s" for period_s in PERIODS_S)
    return [
        TEXT.table("modelling", periods, _make_modelling_lines(results)),
        TEXT.table("tracking", _OVER_SEEDS, _make_tracking_lines(results)),
        TEXT.table("stop", _OVER_SEEDS, _make_stop_lines(results)),
        TEXT.table("bands", _OVER_SEEDS, _make_bound_lines(results)),
        TEXT.table("units", _OVER_SEEDS, _make_unit_lines(results)),
        TEXT.table("effort", ("cycles",), _make_effort_lines(results)),
    ]


def _count_runs(results: Results, keys: Sequence[str]) -> str:
    """Number of runs that the figures come from, in words."""
    return count_of(len(results.list_made(keys)), "run")


def _find_model_errors(results: Results, kind: str) -> tuple[float | None, ...]:
    """Mean modelling error over the seeds for each sampling period, km/h."""
    keys = [name_record(results.seeds[0])]
    return tuple(results.reduce(keys, name_model_error(kind, period_s), fmean) for period_s in PERIODS_S)


def _compute_effort(results: Results, law: str) -> float | None:
    """Cycles of a law's control period, in units of the cycles of ELM-NGPC."""
    return divide(*(results.find(name_effort_run(name), CYCLES) for name in (law, ELM)))


def _make_modelling_lines(results: Results) -> Iterator[Line]:
    linear, integrated = (_find_model_errors(results, kind) for kind in ("linear", "integrated"))
    linear_kmh, integrated_kmh = PRINTED["linear_kmh"], PRINTED["integrated_kmh"]
    yield Line("linear model", "RMSE", "km/h", 4, linear_kmh, linear, 3)
    yield Line("integrated model", "RMSE", "km/h", 4, integrated_kmh, integrated)
    remark = "computed from the two printed figures"
    ratios = tuple(map(divide, linear, integrated))
    yield Line("linear by integrated", "quotient", "", 2, linear_kmh / integrated_kmh, ratios, remark=remark)


def _make_tracking_lines(results: Results) -> Iterator[Line]:
    for situation, one in SITUATIONS.items():
        in_windows = one["rmse"] == WINDOWS
        titled = [("RMSE in the windows" if in_windows else "RMSE", one["rmse"]), ("largest error", WIDEST)]
        titled += [("RMSE over the run", WHOLE)] if in_windows else []
        for title, name in titled:
            for law in list_laws(situation):
                keys = _list_keys(situation, law, results)
                if results.list_made(keys):
                    found, remark = results.find_spread(keys, name), _count_runs(results, keys)
                    yield Line(law, f"{situation}, {title}", "km/h", 4, None, found, remark=remark)


def _make_stop_lines(results: Results) -> Iterator[Line]:
    for law in LAWS:
        found = results.find_spread(_list_keys(EMERGENCY, law, results), STOP_M)
        yield Line(law, "emergency stop", "m", 1, PRINTED["stop_m"] if law == ELM else None, found, 0)


def _make_bound_lines(results: Results) -> Iterator[Line]:
    """Bounds of the mean of a figure over the seeds, by default of the error from the target."""
    for one in TEXT.bounds["bands"]:
        situation, law = one["situation"], one["law"]
        name = one.get("figure", SITUATIONS[situation]["rmse"])
        unit, digits = ("m", 1) if name == STOP_M else ("km/h", 4)
        keys = _list_keys(situation, law, results)
        yield bounded_line(
            law, f"{situation}, {_TITLES[name]}", unit, digits, (one.get("least"), one["most"]),
            results.find_spread(keys, name), unmade="" if results.has(keys) else "not all runs made",
            remark=f" ({_count_runs(results, keys)})",
        )  # fmt: skip


def _make_unit_lines(results: Results) -> Iterator[Line]:
    for title, name, unit, digits in _UNIT_FIGURES:
        for kind, law, loop in UNITS:
            if kind == "free" and name == COUPLER_KN:
                continue
            keys = [name_units_run(kind, law, loop, seed) for seed in results.seeds]
            item = f"{law}, {'a loop for each unit' if loop == 'unit' else 'one loop on the mean'}"
            found, remark = results.find_spread(keys, name), _count_runs(results, keys)
            yield Line(item, f"{kind} units, {title}", unit, digits, None, found, remark=remark)


def _make_effort_lines(results: Results) -> Iterator[Line]:
    minutes = PRINTED["minutes"]
    for law in (BP, ADAPTIVE):
        yield Line(law, "by that of ELM-NGPC", "", 2, minutes[law] / minutes[ELM], (_compute_effort(results, law),))


def judge(results: Results) -> list[Statement]:
    """All statements, in the order of the paper."""
    return [
        _judge_model(results),
        *_judge_laws(results),
        _judge_stop(results),
        _judge_effort(results),
        _judge_calm(results, (ELM, MULTI_MODEL, ADAPTIVE, PID)),
        TEXT.judge("bands", results, [], *check_bounds(list(_make_bound_lines(results)), _name_bound)),
        _judge_units(results),
        _judge_coupler(results),
    ]


def _name_bound(line: Line) -> str:
    law, _, allowed = line.item.partition(", ")
    situation, _, _ = line.quantity.partition(", ")
    return f"{law}, {situation}, {allowed} {line.unit}"


def _judge_model(results: Results) -> Statement:
    found = tuple(map(divide, _find_model_errors(results, "linear"), _find_model_errors(results, "integrated")))
    said = ", ".join(f"{render(value, 2)} at {period:g} s" for value, period in zip(found, PERIODS_S, strict=True))
    holds = [is_less(1, value) for value in found]
    return TEXT.judge("model", results, [name_record(results.seeds[0])], f"by a factor of {said}.", holds)


def _judge_laws(results: Results) -> Iterator[Statement]:
    for statement, situation, name, other in _COMPARED:
        count = min(len(_list_keys(situation, law, results)) for law in (ELM, other))
        both = [_list_keys(situation, law, results)[:count] for law in (ELM, other)]
        own, theirs = (results.reduce(keys, name, fmean) for keys in both)
        unit = "m" if name == STOP_M else "km/h"
        held = own is not None and (theirs is None or own < theirs)
        said = f"{name}: {ELM} {render(own, 4)} {unit}, {other} {render(theirs, 4)} {unit} ({count} seeds)."
        yield TEXT.judge(statement, results, both[0] + both[1], said, [held])


def _judge_stop(results: Results) -> Statement:
    found = _find_mean(results, EMERGENCY, ELM, STOP_M)
    held = found is not None and found <= PRINTED["stop_max_m"]
    return TEXT.judge("stop", results, _list_keys(EMERGENCY, ELM, results), f"{render(found, 1)} m.", [held])


def _judge_effort(results: Results) -> Statement:
    found = {law: _compute_effort(results, law) for law in (BP, ADAPTIVE)}
    said = ", ".join(f"{law} {render(value, 2)} times the cycles of {ELM}" for law, value in found.items())
    holds = [is_less(1, value) for value in found.values()]
    return TEXT.judge("effort", results, [name_effort_run(law) for law in (ELM, BP, ADAPTIVE)], f"{said}.", holds)


def _judge_calm(results: Results, laws: Sequence[str]) -> Statement:
    found = [_find_mean(results, CALM, law, WHOLE) for law in laws]
    holds = [is_less(*both) for both in pairwise(found)] if None not in found else [False]
    said = ", ".join(f"{law} {render(value, 4)}" for law, value in zip(laws, found, strict=True))
    needs = [one for law in laws for one in _list_keys(CALM, law, results)]
    return TEXT.judge("calm", results, needs, f"RMSE in km/h, {said}.", holds)


def _list_unit_keys(results: Results, kind: str, law: str, loop: str) -> list[str]:
    return [name_units_run(kind, law, loop, seed) for seed in results.seeds]


def _list_needed_units(results: Results, wanted: str) -> list[str]:
    return [one for kind, law, loop in UNITS if kind == wanted for one in _list_unit_keys(results, kind, law, loop)]


def _judge_units(results: Results) -> Statement:
    own, theirs = (
        results.find_spread(_list_unit_keys(results, "free", law, "unit"), UNITS_RMSE)[0] for law in (ELM, PID)
    )
    said = (
        f"RMSE of all units without couplers, mean over {len(results.seeds)} seeds: {ELM} {render(own, 4)} km/h, "
        f"PID {render(theirs, 4)} km/h."
    )
    return TEXT.judge("units", results, _list_needed_units(results, "free"), said, [is_less(own, theirs)])


def _judge_coupler(results: Results) -> Statement:
    said: list[str] = []
    ratios: list[float | None] = []
    for law in (PID, ELM):
        keys = [_list_unit_keys(results, "coupled", law, loop) for loop in ("unit", "mean")]
        three, one = (results.find_spread(of_loop, COUPLER_KN)[0] for of_loop in keys)
        pairs = zip(*keys, strict=True)
        of_law = [divide(*(results.find(one, COUPLER_KN) for one in pair)) for pair in pairs]
        known = [ratio for ratio in of_law if ratio is not None]
        between = f"{min(known):.1f} to {max(known):.1f} times" if known else "-"
        said.append(f"{law} {render(three, 1)} kN with three loops, {render(one, 1)} kN with one ({between})")
        ratios += of_law
    text = f"means over {len(results.seeds)} seeds and the ratios of each: {'; '.join(said)}."
    holds = [ratio is not None and ratio >= 2 for ratio in ratios]
    return TEXT.judge("coupler", results, _list_needed_units(results, "coupled"), text, holds)


def draw(results: Results) -> list[Figure]:
    """Figures 8 to 13: speed and its error over distance in each situation, of the first seed."""
    drawn = {situation: _find_drawn(results, situation) for situation in _FIGURES}
    return [_make_figure(situation, rides) for situation, rides in drawn.items() if rides]


def _find_drawn(results: Results, situation: str) -> dict[str, Ride]:
    """The ride of each law whose run was drawn."""
    keys = {law: name_run(situation, law, results.seeds[0]) for law in DRAWN}
    found = {law: results.runs[one].curves for law, one in keys.items() if one in results.runs}
    return {law: ride for law, ride in found.items() if ride is not None}


def _make_figure(situation: str, rides: dict[str, Ride]) -> Figure:
    looks = {law: style.look for law, style in zip(DRAWN, styles(DRAWN), strict=True)}
    place = "position (km)"
    speeds: list[Curve] = []
    errors: list[Curve] = []
    for law, ride in rides.items():
        part = slice(None, None, max(1, round(PERIOD_S / (ride.time_s[1] - ride.time_s[0]))))
        position_km = ride.position_m[part] / 1e3
        if law == DRAWN[0]:
            speeds.append(Curve("target", position_km, ride.target_mps[part] * 3.6, TARGET))
        speeds.append(Curve(law, position_km, ride.speed_mps[part] * 3.6, looks[law]))
        errors.append(Curve(law, position_km, ride.error_kmh[part], looks[law]))
    bounds = _EMERGENCY_KM if situation == EMERGENCY else FREE
    charts = [
        Chart(speeds, "", "speed (km/h)", bounds, (0.0, None), sync=place, height_px=210),
        Chart(errors, place, "error (km/h)", bounds, sync=place, height_px=290),
    ]
    upper, lower = _FIGURES[situation]
    title = f"Figures {upper} and {lower}: speed and its error, {situation}"
    caption = "True speed; the error is the speed less the target. The papers have these curves as pictures only."
    return Figure(f"figures_{upper}_{lower}", title, caption, charts)
