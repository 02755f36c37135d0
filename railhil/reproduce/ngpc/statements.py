"""What the paper with one unit says about its results, and what it comes to here."""

from __future__ import annotations

from collections.abc import Iterator

from railhil.reproduce.ngpc import published
from railhil.reproduce.ngpc.names import (
    ADAPTIVE,
    BP,
    ELM,
    EMERGENCY,
    MULTI_MODEL,
    MUTATION,
    NORMAL,
    PERIODS_S,
    RMSE,
    STOP_M,
    WIDEST,
    mean,
)
from railhil.reproduce.ngpc.tables import effort, model_errors, quotient
from railhil.reproduce.paper import FOLLOWS, FOLLOWS_NOT, IN_PART, Results, Statement

#: Where the paper compares its law with another one: figure, situation, figure of the run, the other law, how.
_COMPARED = (
    ("Figures 8 and 9", NORMAL, RMSE[NORMAL], MULTI_MODEL, "follows the target closer than the multi-model GPC"),
    ("Figures 10 and 11", EMERGENCY, RMSE[EMERGENCY], MULTI_MODEL, "follows it closer in emergency braking"),
    ("Figures 10 and 11", EMERGENCY, STOP_M, ADAPTIVE, "stops in a shorter distance than A-GPC"),
    ("Figures 12 and 13", MUTATION, RMSE[MUTATION], MULTI_MODEL, "overcomes a mutation of the train's parameters"),
    ("Figures 12 and 13", MUTATION, WIDEST, MULTI_MODEL, "does not jump at a mutation, as the multi-model GPC does"),
)


def statements(results: Results) -> list[Statement]:
    """All statements, in the order of the paper."""
    return [_model(results), *_comparisons(results), _stop(results), _effort(results)]


def _verdict(held: list[bool]) -> str:
    return FOLLOWS if all(held) else IN_PART if any(held) else FOLLOWS_NOT


def _model(results: Results) -> Statement:
    found = tuple(map(quotient, model_errors(results, "linear"), model_errors(results, "integrated")))
    said = ", ".join(f"{_shown(value, 2)} at {period:g} s" for value, period in zip(found, PERIODS_S, strict=True))
    printed = published.LINEAR_KMH / published.INTEGRATED_KMH
    return Statement(
        "Sect. 6.1",
        f"the integrated model is better than the linear one, by a factor of {printed:.1f}.",
        f"by a factor of {said}.",
        _verdict([value is not None and value > 1 for value in found]),
        "The factor depends on the sampling period, which the paper does not print.",
    )


def _comparisons(results: Results) -> Iterator[Statement]:
    for at, situation, name, other, claim in _COMPARED:
        own, theirs = (mean(results, situation, law, name) for law in (ELM, other))
        unit = "m" if name == STOP_M else "km/h"
        held = own is not None and (theirs is None or own < theirs)
        said = f"{name}: {ELM} {_shown(own, 4)} {unit}, {other} {_shown(theirs, 4)} {unit}."
        yield Statement(at, f"ELM-NGPC {claim}.", said, FOLLOWS if held else FOLLOWS_NOT)


def _stop(results: Results) -> Statement:
    found = mean(results, EMERGENCY, ELM, STOP_M)
    held = found is not None and found <= published.STOP_MAX_M
    return Statement(
        "Sect. 6.2",
        f"the emergency stop takes {published.STOP_M / 1000:g} km, at most {published.STOP_MAX_M / 1000:g} km.",
        f"{_shown(found, 1)} m.",
        FOLLOWS if held else FOLLOWS_NOT,
        "The profile of the emergency braking is an assumption of the scenario, and determines the distance.",
    )


def _effort(results: Results) -> Statement:
    found = {law: effort(results, law) for law in (BP, ADAPTIVE)}
    said = ", ".join(f"{law} {_shown(value, 2)} times the cycles of {ELM}" for law, value in found.items())
    return Statement(
        "Table 1",
        "ELM-NGPC takes the least time.",
        f"{said}.",
        _verdict([value is not None and value > 1 for value in found.values()]),
        "Both networks are trained before the run here and then do the same operations; the paper does not say what "
        "its times contain.",
    )


def _shown(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
