"""What the paper with one unit says about its results, and what it comes to here."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from statistics import fmean

from railhil.reproduce.ngpc import published
from railhil.reproduce.ngpc.bands import BANDS
from railhil.reproduce.ngpc.names import (
    ADAPTIVE,
    BP,
    CALM,
    COUPLER_KN,
    ELM,
    EMERGENCY,
    MULTI_MODEL,
    MUTATION,
    NORMAL,
    PERIODS_S,
    PID,
    RMSE,
    STOP_M,
    UNITS,
    UNITS_RMSE,
    WIDEST,
    effort_key,
    key,
    mean,
    record_key,
    seeds_of,
    units_key,
    units_made,
)
from railhil.reproduce.ngpc.tables import effort, model_errors, quotient
from railhil.reproduce.paper import FOLLOWS, FOLLOWS_NOT, IN_PART, OPEN, Results, Statement, checked

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
    calm = (ELM, MULTI_MODEL, ADAPTIVE, PID)
    units = [
        [units_key(kind, law, loop, seed) for kind, law, loop in UNITS if kind == of for seed in results.seeds]
        for of in ("free", "coupled")
    ]
    return [
        checked(results, _model(results), [record_key(results.seeds[0])]),
        *_comparisons(results),
        checked(results, _stop(results), _keys(results, EMERGENCY, ELM)),
        checked(results, _effort(results), [effort_key(law) for law in (ELM, BP, ADAPTIVE)]),
        checked(results, _calm(results, calm), [one for law in calm for one in _keys(results, CALM, law)]),
        _bands(results),
        checked(results, _units(results), units[0]),
        checked(results, _coupler(results), units[1]),
    ]


def _keys(results: Results, situation: str, law: str) -> list[str]:
    return [key(situation, law, seed) for seed in seeds_of(situation, law, results.seeds)]


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
        both = [seeds_of(situation, law, results.seeds) for law in (ELM, other)]
        seeds = [seed for seed in results.seeds if all(seed in of_law for of_law in both)]
        own, theirs = (results.over([key(situation, law, seed) for seed in seeds], name, fmean) for law in (ELM, other))
        unit = "m" if name == STOP_M else "km/h"
        held = own is not None and (theirs is None or own < theirs)
        said = f"{name}: {ELM} {_shown(own, 4)} {unit}, {other} {_shown(theirs, 4)} {unit} ({len(seeds)} seeds)."
        found = Statement(at, f"ELM-NGPC {claim}.", said, FOLLOWS if held else FOLLOWS_NOT)
        yield checked(results, found, [key(situation, law, seed) for law in (ELM, other) for seed in seeds])


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


def _calm(results: Results, order: Sequence[str]) -> Statement:
    found = [mean(results, CALM, law, RMSE[CALM]) for law in order]
    known = [value for value in found if value is not None]
    held = [first < second for first, second in pairwise(known)] if len(known) == len(order) else [False]
    said = ", ".join(f"{law} {_shown(value, 4)}" for law, value in zip(order, found, strict=True))
    return Statement(
        "railhil's specification",
        "without gradient and wind, which are not in the papers, ELM-NGPC < multi-model GPC < A-GPC < PID.",
        f"RMSE in km/h, {said}.",
        _verdict(held),
    )


def _bands(results: Results) -> Statement:
    made = [band for band in BANDS if band.is_measured(results)]
    missed = [
        f"{band.law}, {band.situation}, allowed {band.text} {band.unit}: "
        f"{_shown(mean(results, band.situation, band.law, band.name), band.digits)}"
        for band in made
        if not band.holds(results)
    ]
    left = f" ({len(BANDS) - len(made)} not made)" if len(made) < len(BANDS) else ""
    said = f"{len(made) - len(missed)} of {len(made)} hold{left}"
    return Statement(
        "railhil's specification",
        "bands and bounds of the table above.",
        f"{said}; not: {'; '.join(missed)}." if missed else f"{said}.",
        OPEN if left else _verdict([band.holds(results) for band in made]),
    )


def _units(results: Results) -> Statement:
    own, theirs = (_of_units(results, "free", law, "unit", UNITS_RMSE) for law in (ELM, PID))
    held = own is not None and theirs is not None and own < theirs
    return Statement(
        "Paper with three units",
        "NGPC with a loop for each unit follows the target closer than PID (prototype: 0.210 and 0.329 km/h).",
        f"RMSE of all units without couplers, mean over {len(results.seeds)} seeds: {ELM} {_shown(own, 4)} km/h, "
        f"PID {_shown(theirs, 4)} km/h.",
        FOLLOWS if held else FOLLOWS_NOT,
        "The paper with three units uses BP; its PID has no published gains, that of the prototype others than here.",
    )


def _coupler(results: Results) -> Statement:
    said, ratios = [], []
    for law in (PID, ELM):
        three, one = (_of_units(results, "coupled", law, loop, COUPLER_KN) for loop in ("unit", "mean"))
        pairs = [
            [results.value(units_key("coupled", law, loop, seed), COUPLER_KN) for loop in ("unit", "mean")]
            for seed in results.seeds
        ]
        of_law = [quotient(*pair) for pair in pairs]
        known = [ratio for ratio in of_law if ratio is not None]
        between = f"{min(known):.1f} to {max(known):.1f} times" if known else "-"
        said.append(f"{law} {_shown(three, 1)} kN with three loops, {_shown(one, 1)} kN with one ({between})")
        ratios += of_law
    return Statement(
        "railhil's specification",
        "one loop on the mean speed has 2 to 8 times less coupler force than a loop for each unit.",
        f"means over {len(results.seeds)} seeds and the ratios of each: {'; '.join(said)}.",
        _verdict([ratio is not None and ratio >= 2 for ratio in ratios]),
    )


def _of_units(results: Results, kind: str, law: str, loop: str, name: str) -> float | None:
    """Mean over the seeds."""
    return results.over(units_made(results, kind, law, loop), name, fmean)


def _shown(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
