"""Tables, bands, statements and figures, beside what the papers print."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import pairwise
from statistics import fmean
from typing import TYPE_CHECKING

from railhil.common.digits import count_of
from railhil.reproduce.comparison import Band, Finding, Line, Table, check_bands, decimal, is_less, quotient
from railhil.reproduce.ngpc.runs import (
    ADAPTIVE,
    BP,
    BRAKING,
    CALM,
    COUPLER_KN,
    CYCLES,
    DELAY,
    DRAWN,
    ELM,
    EMERGENCY,
    LATER,
    LAWS,
    MULTI_MODEL,
    MUTATION,
    NORMAL,
    PERIODS_S,
    PID,
    RESIDUAL,
    SITUATIONS,
    SPREAD,
    STOP_M,
    TEXT,
    UNITS,
    UNITS_RMSE,
    WHOLE,
    WIDEST,
    WINDOWS,
    Drawable,
    effort_key,
    key,
    keys_of,
    model_error,
    record_key,
    units_key,
)
from railhil.reproduce.paper import Results

if TYPE_CHECKING:
    from railhil.charts.figure import Figure
    from railhil.report.pictures import Picture

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
    return keys_of(situation, law, results.seeds)


def _find_spread(keys: Callable[[Results], list[str]], name: str, results: Results) -> tuple[float | None, ...]:
    return results.spread(keys(results), name)


def _find_mean(results: Results, situation: str, law: str, name: str) -> float | None:
    """Mean of a figure over the seeds whose runs were made."""
    return results.spread(_list_keys(situation, law, results), name)[0]


def _make_band(situation: str, law: str, least: float | None, most: float, name: str = "") -> Band:
    """Bounds of the mean of a figure over the seeds, by default of the error from the target."""
    name = name or SITUATIONS[situation].rmse
    unit, digits = ("m", 1) if name == STOP_M else ("km/h", 4)
    needs = partial(_list_keys, situation, law)
    measured = partial(_find_spread, needs, name)
    return Band(
        f"{situation}, {_TITLES[name]}", law, unit, digits, least, most, needs, measured, unmade="not all runs made"
    )


#: Bands and bounds that railhil's own specification sets for its laws.
BANDS = (
    _make_band(NORMAL, RESIDUAL, 0.09, 0.12),
    _make_band(NORMAL, ELM, 0.14, 0.21),
    _make_band(NORMAL, PID, 0.17, 0.22),
    _make_band(NORMAL, MULTI_MODEL, 0.11, 0.15),
    _make_band(NORMAL, ADAPTIVE, 0.13, 0.20),
    _make_band(EMERGENCY, ELM, 0.24, 0.33),
    _make_band(EMERGENCY, MULTI_MODEL, 0.69, 0.79),
    *(_make_band(EMERGENCY, law, 4380.0, 4420.0, STOP_M) for law in (ELM, MULTI_MODEL, ADAPTIVE, RESIDUAL, DELAY)),
    _make_band(NORMAL, DELAY, None, 0.072),
    _make_band(EMERGENCY, DELAY, None, 0.197),
    _make_band(MUTATION, DELAY, None, 0.168),
    _make_band(LATER, DELAY, None, 0.31),
)


def compare(results: Results) -> list[Table]:
    """All tables."""
    periods = tuple(f"{period_s:g} s" for period_s in PERIODS_S)
    return [
        TEXT.table("modelling", periods, _make_modelling_lines(results)),
        TEXT.table("tracking", _OVER_SEEDS, _make_tracking_lines(results)),
        TEXT.table("stop", _OVER_SEEDS, _make_stop_lines(results)),
        TEXT.table("bands", _OVER_SEEDS, _make_band_lines(results)),
        TEXT.table("units", _OVER_SEEDS, _make_unit_lines(results)),
        TEXT.table("effort", ("cycles",), _make_effort_lines(results)),
    ]


def _count_runs(results: Results, keys: Sequence[str]) -> str:
    """Number of runs that the figures come from, in words."""
    return count_of(len(results.made(keys)), "run")


def _find_model_errors(results: Results, kind: str) -> tuple[float | None, ...]:
    """Mean modelling error over the seeds for each sampling period, km/h."""
    keys = [record_key(results.seeds[0])]
    return tuple(results.over(keys, model_error(kind, period_s), fmean) for period_s in PERIODS_S)


def _compute_effort(results: Results, law: str) -> float | None:
    """Cycles of a law's control period, in units of the cycles of ELM-NGPC."""
    return quotient(*(results.value(effort_key(name), CYCLES) for name in (law, ELM)))


def _make_modelling_lines(results: Results) -> Iterator[Line]:
    linear, integrated = (_find_model_errors(results, kind) for kind in ("linear", "integrated"))
    linear_kmh, integrated_kmh = PRINTED["linear_kmh"], PRINTED["integrated_kmh"]
    yield Line("linear model", "RMSE", "km/h", 4, linear_kmh, linear, 3)
    yield Line("integrated model", "RMSE", "km/h", 4, integrated_kmh, integrated)
    remark = "computed from the two printed figures"
    ratios = tuple(map(quotient, linear, integrated))
    yield Line("linear by integrated", "quotient", "", 2, linear_kmh / integrated_kmh, ratios, remark=remark)


def _make_tracking_lines(results: Results) -> Iterator[Line]:
    for situation, one in SITUATIONS.items():
        in_windows = one.rmse == WINDOWS
        titled = [("RMSE in the windows" if in_windows else "RMSE", one.rmse), ("largest error", WIDEST)]
        titled += [("RMSE over the run", WHOLE)] if in_windows else []
        for title, name in titled:
            for law in one.laws:
                keys = _list_keys(situation, law, results)
                if results.made(keys):
                    found, remark = results.spread(keys, name), _count_runs(results, keys)
                    yield Line(law, f"{situation}, {title}", "km/h", 4, None, found, remark=remark)


def _make_stop_lines(results: Results) -> Iterator[Line]:
    for law in LAWS:
        found = results.spread(_list_keys(EMERGENCY, law, results), STOP_M)
        yield Line(law, "emergency stop", "m", 1, PRINTED["stop_m"] if law == ELM else None, found, 0)


def _make_band_lines(results: Results) -> Iterator[Line]:
    return (band.line(results, f" ({_count_runs(results, band.needs(results))})") for band in BANDS)


def _make_unit_lines(results: Results) -> Iterator[Line]:
    for title, name, unit, digits in _UNIT_FIGURES:
        for kind, law, loop in UNITS:
            if kind == "free" and name == COUPLER_KN:
                continue
            keys = [units_key(kind, law, loop, seed) for seed in results.seeds]
            item = f"{law}, {'a loop for each unit' if loop == 'unit' else 'one loop on the mean'}"
            found, remark = results.spread(keys, name), _count_runs(results, keys)
            yield Line(item, f"{kind} units, {title}", unit, digits, None, found, remark=remark)


def _make_effort_lines(results: Results) -> Iterator[Line]:
    minutes = PRINTED["minutes"]
    for law in (BP, ADAPTIVE):
        yield Line(law, "by that of ELM-NGPC", "", 2, minutes[law] / minutes[ELM], (_compute_effort(results, law),))


def check(results: Results) -> Iterator[Finding]:
    """All findings, in the order of the paper."""
    yield _check_model(results)
    yield from _check_laws(results)
    yield _check_stop(results)
    yield _check_effort(results)
    yield _check_calm(results, (ELM, MULTI_MODEL, ADAPTIVE, PID))
    yield check_bands("bands", results, BANDS, _name_band)
    yield _check_units(results)
    yield _check_coupler(results)


def _name_band(band: Band) -> str:
    situation, _, _ = band.at.partition(", ")
    return f"{band.what}, {situation}, {band.limits} {band.unit}"


def _check_model(results: Results) -> Finding:
    found = tuple(map(quotient, _find_model_errors(results, "linear"), _find_model_errors(results, "integrated")))
    said = ", ".join(f"{decimal(value, 2)} at {period:g} s" for value, period in zip(found, PERIODS_S, strict=True))
    holds = [is_less(1, value) for value in found]
    return Finding("model", f"by a factor of {said}.", holds, [record_key(results.seeds[0])])


def _check_laws(results: Results) -> Iterator[Finding]:
    for statement, situation, name, other in _COMPARED:
        count = min(len(_list_keys(situation, law, results)) for law in (ELM, other))
        both = [_list_keys(situation, law, results)[:count] for law in (ELM, other)]
        own, theirs = (results.over(keys, name, fmean) for keys in both)
        unit = "m" if name == STOP_M else "km/h"
        held = own is not None and (theirs is None or own < theirs)
        said = f"{name}: {ELM} {decimal(own, 4)} {unit}, {other} {decimal(theirs, 4)} {unit} ({count} seeds)."
        yield Finding(statement, said, [held], both[0] + both[1])


def _check_stop(results: Results) -> Finding:
    found = _find_mean(results, EMERGENCY, ELM, STOP_M)
    held = found is not None and found <= PRINTED["stop_max_m"]
    return Finding("stop", f"{decimal(found, 1)} m.", [held], _list_keys(EMERGENCY, ELM, results))


def _check_effort(results: Results) -> Finding:
    found = {law: _compute_effort(results, law) for law in (BP, ADAPTIVE)}
    said = ", ".join(f"{law} {decimal(value, 2)} times the cycles of {ELM}" for law, value in found.items())
    holds = [is_less(1, value) for value in found.values()]
    return Finding("effort", f"{said}.", holds, [effort_key(law) for law in (ELM, BP, ADAPTIVE)])


def _check_calm(results: Results, laws: Sequence[str]) -> Finding:
    found = [_find_mean(results, CALM, law, WHOLE) for law in laws]
    holds = [is_less(*both) for both in pairwise(found)] if None not in found else [False]
    said = ", ".join(f"{law} {decimal(value, 4)}" for law, value in zip(laws, found, strict=True))
    needs = [one for law in laws for one in _list_keys(CALM, law, results)]
    return Finding("calm", f"RMSE in km/h, {said}.", holds, needs)


def _list_unit_keys(results: Results, kind: str, law: str, loop: str) -> list[str]:
    return [units_key(kind, law, loop, seed) for seed in results.seeds]


def _list_needed_units(results: Results, wanted: str) -> list[str]:
    return [one for kind, law, loop in UNITS if kind == wanted for one in _list_unit_keys(results, kind, law, loop)]


def _check_units(results: Results) -> Finding:
    own, theirs = (results.spread(_list_unit_keys(results, "free", law, "unit"), UNITS_RMSE)[0] for law in (ELM, PID))
    said = (
        f"RMSE of all units without couplers, mean over {len(results.seeds)} seeds: {ELM} {decimal(own, 4)} km/h, "
        f"PID {decimal(theirs, 4)} km/h."
    )
    return Finding("units", said, [is_less(own, theirs)], _list_needed_units(results, "free"))


def _check_coupler(results: Results) -> Finding:
    said: list[str] = []
    ratios: list[float | None] = []
    for law in (PID, ELM):
        keys = [_list_unit_keys(results, "coupled", law, loop) for loop in ("unit", "mean")]
        three, one = (results.spread(of_loop, COUPLER_KN)[0] for of_loop in keys)
        pairs = zip(*keys, strict=True)
        of_law = [quotient(*(results.value(one, COUPLER_KN) for one in pair)) for pair in pairs]
        known = [ratio for ratio in of_law if ratio is not None]
        between = f"{min(known):.1f} to {max(known):.1f} times" if known else "-"
        said.append(f"{law} {decimal(three, 1)} kN with three loops, {decimal(one, 1)} kN with one ({between})")
        ratios += of_law
    text = f"means over {len(results.seeds)} seeds and the ratios of each: {'; '.join(said)}."
    holds = [ratio is not None and ratio >= 2 for ratio in ratios]
    return Finding("coupler", text, holds, _list_needed_units(results, "coupled"))


def draw(results: Results) -> Sequence[Picture]:
    """Figures 8 to 13: speed and its error over distance in each situation, of the first seed.

    :raises ImportError: the extra [report] is not installed.
    """
    from railhil.report.pictures import printed

    drawn = {situation: _find_drawn(results, situation) for situation in _FIGURES}
    return printed([_make_figure(situation, runs) for situation, runs in drawn.items() if runs])


def _find_drawn(results: Results, situation: str) -> dict[str, Drawable]:
    """Curves of each law whose run was drawn."""
    keys = {law: key(situation, law, results.seeds[0]) for law in DRAWN}
    found = {law: results.runs[one].curves for law, one in keys.items() if one in results.runs}
    return {law: curves for law, curves in found.items() if isinstance(curves, Drawable)}


def _make_figure(situation: str, runs: dict[str, Drawable]) -> Figure:
    from railhil.charts.figure import FREE, TARGET, Chart, Curve, Figure
    from railhil.report.styles import styles

    looks = {law: style.look for law, style in zip(DRAWN, styles(DRAWN), strict=True)}
    place = "position (km)"
    speeds: list[Curve] = []
    if own := runs.get(DRAWN[0]):
        speeds.append(Curve("target", own.position_m / 1e3, own.target_kmh, TARGET))
    speeds += [Curve(law, one.position_m / 1e3, one.speed_kmh, looks[law]) for law, one in runs.items()]
    errors = [Curve(law, one.position_m / 1e3, one.error_kmh, looks[law]) for law, one in runs.items()]
    bounds = _EMERGENCY_KM if situation == EMERGENCY else FREE
    charts = [
        Chart(speeds, "", "speed (km/h)", bounds, (0.0, None), sync=place, height_px=210),
        Chart(errors, place, "error (km/h)", bounds, sync=place, height_px=290),
    ]
    upper, lower = _FIGURES[situation]
    title = f"Figures {upper} and {lower}: speed and its error, {situation}"
    caption = "True speed; the error is the speed less the target. The papers have these curves as pictures only."
    return Figure(f"figures_{upper}_{lower}", title, caption, charts)
