"""Modelling error, tracking, emergency stop and computing effort, beside what the paper prints."""

from __future__ import annotations

from collections.abc import Iterator
from statistics import fmean

from railhil.reproduce.ngpc import published
from railhil.reproduce.ngpc.bands import BANDS, TITLES
from railhil.reproduce.ngpc.names import (
    ADAPTIVE,
    BP,
    COUPLER_KN,
    CYCLES,
    ELM,
    EMERGENCY,
    LAWS,
    PERIODS_S,
    RMSE,
    STOP_M,
    UNIT_FIGURES,
    UNITS,
    WHOLE,
    WIDEST,
    WINDOWS,
    count,
    counted,
    effort_key,
    laws_of,
    made,
    model_error,
    over_seeds,
    record_key,
    units_made,
)
from railhil.reproduce.paper import Line, Results, Table

_OVER_SEEDS = ("mean", "least", "greatest")


def tables(results: Results) -> list[Table]:
    """All tables."""
    return [
        _modelling(results),
        _tracking(results),
        _stop(results),
        _bands(results),
        _units(results),
        _effort(results),
    ]


def model_errors(results: Results, kind: str) -> tuple[float | None, ...]:
    """Mean modelling error over the seeds for each sampling period, km/h."""
    keys = [record_key(results.seeds[0])]
    return tuple(results.over(keys, model_error(kind, period_s), fmean) for period_s in PERIODS_S)


def quotient(value: float | None, other: float | None) -> float | None:
    """A value divided by another; None if there is none."""
    return None if value is None or not other else value / other


def effort(results: Results, law: str) -> float | None:
    """Cycles of a law's control period, in units of those of ELM-NGPC."""
    return quotient(*(results.over([effort_key(name)], CYCLES) for name in (law, ELM)))


def _modelling(results: Results) -> Table:
    linear, integrated = (model_errors(results, kind) for kind in ("linear", "integrated"))
    lines = (
        Line("linear model", "RMSE", "km/h", 4, published.LINEAR_KMH, linear, 3),
        Line("integrated model", "RMSE", "km/h", 4, published.INTEGRATED_KMH, integrated),
        Line(
            "linear by integrated", "quotient", "", 2, published.LINEAR_KMH / published.INTEGRATED_KMH,
            tuple(map(quotient, linear, integrated)), remark="computed from the two printed figures",
        ),
    )  # fmt: skip
    note = "On 300 samples that were not trained on. The paper does not print its sampling period."
    columns = tuple(f"{period_s:g} s" for period_s in PERIODS_S)
    return Table("modelling", "Modelling error (sect. 6.1)", columns, lines, note)


def _tracking(results: Results) -> Table:
    note = (
        "The paper prints curves and no numbers. Mean, least and greatest over the seeds. RMSE of mutations: inside "
        "their windows; over the whole run beside it."
    )
    return Table(
        "tracking", "Tracking of the target (figures 8 to 13)", _OVER_SEEDS, tuple(_tracking_lines(results)), note
    )


def _tracking_lines(results: Results) -> Iterator[Line]:
    for situation, name in RMSE.items():
        titled = [("RMSE in the windows" if name == WINDOWS else "RMSE", name), ("largest error", WIDEST)]
        titled += [("RMSE over the run", WHOLE)] if name == WINDOWS else []
        for title, figure in titled:
            for law in laws_of(situation):
                if not made(results, situation, law):
                    continue
                found = over_seeds(results, situation, law, figure)
                yield Line(law, f"{situation}, {title}", "km/h", 4, None, found, remark=count(results, situation, law))


def _bands(results: Results) -> Table:
    lines = tuple(
        Line(
            f"{band.law}, allowed {band.text}", f"{band.situation}, {TITLES[band.name]}", band.unit, band.digits, None,
            over_seeds(results, band.situation, band.law, band.name),
            remark=f"{band.verdict(results)} ({count(results, band.situation, band.law)})",
        )
        for band in BANDS
    )  # fmt: skip
    note = "Bands that a prototype of railhil set before the bench was written; the mean over the seeds is compared."
    return Table("bands", "Bands of railhil's specification", _OVER_SEEDS, lines, note)


def _units(results: Results) -> Table:
    lines = []
    for title, name, unit, digits in UNIT_FIGURES:
        for kind, law, loop in UNITS:
            if kind == "free" and name == COUPLER_KN:
                continue
            keys = units_made(results, kind, law, loop)
            found = tuple(results.over(keys, name, join) for join in (fmean, min, max))
            loops = "a loop for each unit" if loop == "unit" else "one loop on the mean"
            at = f"{kind} units, {title}"
            lines.append(Line(f"{law}, {loops}", at, unit, digits, None, found, remark=counted(keys)))
    note = "The paper with three units prints curves and no numbers. Mean, least and greatest over the seeds."
    return Table("units", "Three power units, normal running", _OVER_SEEDS, tuple(lines), note)


def _stop(results: Results) -> Table:
    lines = (
        Line(
            law, "emergency stop", "m", 1, published.STOP_M if law == ELM else None,
            over_seeds(results, EMERGENCY, law, STOP_M), 0,
        )
        for law in LAWS
    )  # fmt: skip
    return Table("stop", "Emergency braking at km 210 (figures 10 and 11)", _OVER_SEEDS, tuple(lines))


def _effort(results: Results) -> Table:
    own = published.MINUTES[ELM]
    lines = (
        Line(law, "by that of ELM-NGPC", "", 2, published.MINUTES[law] / own, (effort(results, law),))
        for law in (BP, ADAPTIVE)
    )
    note = (
        "Published: average time of a simulation. Here: estimated cycles of one control period on the target "
        "processor, which do not depend on the machine."
    )
    return Table("effort", "Computing effort (table 1)", ("cycles",), tuple(lines), note)
