"""Names of the runs of the protocol and of the figures that are read from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import fmean

from railhil.common.digits import count_of
from railhil.reproduce.paper import Results

#: The law of the paper with one unit, its comparators, the baselines that a law with a network is judged against, and
#: the best of railhil's own.
ELM, BP, MULTI_MODEL, ADAPTIVE = "elm_ngpc", "bp_ngpc", "mm_gpc", "a_gpc"
LAWS = (ELM, BP, MULTI_MODEL, ADAPTIVE, "pid", "pid_ff", "gpc", "res_ngpc", "os_elm_ngpc", "delay_gpc")
PID, RESIDUAL, DELAY = "pid", "res_ngpc", "delay_gpc"
#: Laws that make the long journeys with every seed; the others make them with the first one.
MAIN = (ELM, MULTI_MODEL, ADAPTIVE, PID, RESIDUAL, DELAY)
#: Laws that the figures show.
DRAWN = (ELM, MULTI_MODEL, ADAPTIVE)
#: Situations: of the paper with one unit; with the delay 0.5 s or 1 s longer, or the gain 1.4, instead of its mutation;
#: without gradient and wind; the emergency without identification of the model.
NORMAL, EMERGENCY, MUTATION = "normal", "emergency", "mutation"
LATE, LATER, STRONGER, CALM = "delay+0.5s", "delay+1s", "gain1.4", "calm"
FIXED_MODEL = "emergency-fixed"
#: RMSE inside the windows of a mutation.
WINDOWS = "windows_rmse_kmh"
#: The figure of each situation that says how well the target is followed.
RMSE: Mapping[str, str] = {
    NORMAL: "rmse_kmh",
    EMERGENCY: "emergency_rmse_kmh",
    MUTATION: WINDOWS,
    FIXED_MODEL: "emergency_rmse_kmh",
    LATE: WINDOWS,
    LATER: WINDOWS,
    STRONGER: WINDOWS,
    CALM: "rmse_kmh",
}
#: Laws that are run in the situations beside the papers.
BESIDE: Mapping[str, tuple[str, ...]] = {
    FIXED_MODEL: (ELM, BP),
    LATE: (ELM, PID, RESIDUAL, DELAY),
    LATER: (ELM, PID, RESIDUAL, DELAY),
    STRONGER: (ELM, PID, DELAY),
    CALM: (ELM, MULTI_MODEL, ADAPTIVE, PID),
}
WHOLE = "rmse_kmh"
#: Three power units: free or coupled, law, one loop for each unit or one for all.
UNITS = (
    ("free", PID, "unit"),
    ("free", ELM, "unit"),
    ("coupled", PID, "unit"),
    ("coupled", PID, "mean"),
    ("coupled", ELM, "unit"),
    ("coupled", ELM, "mean"),
)
#: Figures of three units: title, name, unit, digits.
UNITS_RMSE, SPREAD, COUPLER_KN = "units_rmse_kmh", "spread_kmh", "coupler_peak_kn"
UNIT_FIGURES = (
    ("RMSE of all units", UNITS_RMSE, "km/h", 4),
    ("largest difference of speeds", SPREAD, "km/h", 3),
    ("largest coupler force", COUPLER_KN, "kN", 1),
)
WIDEST, STOP_M = "max_error_kmh", "emergency_stop_m"
#: Estimated cycles of the target processor for one control period.
CYCLES = "cycles"
#: Sampling periods of the modelling error, s.
PERIODS_S = (0.5, 1.0, 2.0, 4.0)


def key(situation: str, law: str, seed: int) -> str:
    """Name of a run."""
    return f"{situation}-{law}-{seed}"


def laws_of(situation: str) -> tuple[str, ...]:
    """The laws that are run in a situation."""
    return BESIDE.get(situation, LAWS)


def seeds_of(situation: str, law: str, seeds: Sequence[int]) -> tuple[int, ...]:
    """The seeds with which a law is run in a situation."""
    once = situation in (NORMAL, MUTATION) and law not in MAIN
    return tuple(seeds[:1]) if once else tuple(seeds)


def units_key(kind: str, law: str, loop: str, seed: int) -> str:
    """Name of a run with three units; kind: ``free`` or ``coupled``, loop: ``unit`` or ``mean``."""
    return f"units-{kind}-{law}-{loop}-{seed}"


def record_key(seed: int) -> str:
    """Name of the run whose record tests the models."""
    return f"record-{seed}"


def effort_key(law: str) -> str:
    """Name of the run whose operations are counted."""
    return f"effort-{law}"


def model_error(kind: str, period_s: float) -> str:
    """Name of a modelling error; kind: ``linear`` or ``integrated``."""
    return f"{kind}_{period_s:g}s_kmh"


def made(results: Results, situation: str, law: str) -> list[str]:
    """Names of the runs of a law in a situation that were made."""
    keys = [key(situation, law, seed) for seed in seeds_of(situation, law, results.seeds)]
    return [one for one in keys if one in results.runs]


def over_seeds(
    results: Results, situation: str, law: str, name: str
) -> tuple[float | None, float | None, float | None]:
    """Mean, least and greatest value of a figure over the seeds whose runs were made."""
    keys = made(results, situation, law)
    return results.over(keys, name, fmean), results.over(keys, name, min), results.over(keys, name, max)


def count(results: Results, situation: str, law: str) -> str:
    """How many runs the figures come from, in words."""
    return counted(made(results, situation, law))


def counted(keys: Sequence[str]) -> str:
    """The number of some runs, in words."""
    return count_of(len(keys), "run")


def units_made(results: Results, kind: str, law: str, loop: str) -> list[str]:
    """Names of the runs with three units that were made."""
    keys = [units_key(kind, law, loop, seed) for seed in results.seeds]
    return [one for one in keys if one in results.runs]


def mean(results: Results, situation: str, law: str, name: str) -> float | None:
    """Mean of a figure over the seeds whose runs were made."""
    return over_seeds(results, situation, law, name)[0]
