"""Modelling error, tracking, emergency stop and computing effort, beside what the paper prints."""

from __future__ import annotations

from collections.abc import Iterator
from statistics import fmean

from railhil.reproduce.ngpc import published
from railhil.reproduce.ngpc.names import (
    ADAPTIVE,
    BP,
    CYCLES,
    ELM,
    EMERGENCY,
    LAWS,
    MUTATION,
    NORMAL,
    PERIODS_S,
    RMSE,
    STOP_M,
    WIDEST,
    effort_key,
    model_error,
    over_seeds,
    record_key,
)
from railhil.reproduce.paper import Line, Results, Table

_OVER_SEEDS = ("mean", "least", "greatest")


def tables(results: Results) -> list[Table]:
    """All tables."""
    return [_modelling(results), _tracking(results), _stop(results), _effort(results)]


def model_errors(results: Results, kind: str) -> tuple[float | None, ...]:
    """Mean modelling error over the seeds for each sampling period, km/h."""
    keys = [record_key(seed) for seed in results.seeds]
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
    note = "The paper prints curves and no numbers. Mean, least and greatest over the seeds."
    return Table(
        "tracking", "Tracking of the target (figures 8 to 13)", _OVER_SEEDS, tuple(_tracking_lines(results)), note
    )


def _tracking_lines(results: Results) -> Iterator[Line]:
    for situation in (NORMAL, EMERGENCY, MUTATION):
        for title, name in (("RMSE", RMSE[situation]), ("largest error", WIDEST)):
            for law in LAWS:
                yield Line(law, f"{situation}, {title}", "km/h", 4, None, over_seeds(results, situation, law, name))


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
