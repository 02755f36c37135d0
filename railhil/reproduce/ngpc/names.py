"""Names of the runs of the protocol and of the figures that are read from them."""

from __future__ import annotations

from collections.abc import Mapping
from statistics import fmean

from railhil.reproduce.paper import Results

#: The law of the paper with one unit, its comparators, the baselines that a law with a network is judged against, and
#: the best of railhil's own.
ELM, BP, MULTI_MODEL, ADAPTIVE = "elm_ngpc", "bp_ngpc", "mm_gpc", "a_gpc"
LAWS = (ELM, BP, MULTI_MODEL, ADAPTIVE, "pid", "pid_ff", "res_ngpc", "delay_gpc")
#: Situations of the paper with one unit, and the figure of each that says how well the target is followed.
NORMAL, EMERGENCY, MUTATION = "normal", "emergency", "mutation"
RMSE: Mapping[str, str] = {NORMAL: "rmse_kmh", EMERGENCY: "emergency_rmse_kmh", MUTATION: "rmse_kmh"}
WIDEST, STOP_M = "max_error_kmh", "emergency_stop_m"
#: Estimated cycles of the target processor for one control period.
CYCLES = "cycles"
#: Sampling periods of the modelling error, s.
PERIODS_S = (0.5, 1.0, 2.0, 4.0)


def key(situation: str, law: str, seed: int) -> str:
    """Name of a run."""
    return f"{situation}-{law}-{seed}"


def record_key(seed: int) -> str:
    """Name of the run whose record tests the models."""
    return f"record-{seed}"


def effort_key(law: str) -> str:
    """Name of the run whose operations are counted."""
    return f"effort-{law}"


def model_error(kind: str, period_s: float) -> str:
    """Name of a modelling error; kind: ``linear`` or ``integrated``."""
    return f"{kind}_{period_s:g}s_kmh"


def over_seeds(
    results: Results, situation: str, law: str, name: str
) -> tuple[float | None, float | None, float | None]:
    """Mean, least and greatest value of a figure over the seeds."""
    keys = [key(situation, law, seed) for seed in results.seeds]
    return results.over(keys, name, fmean), results.over(keys, name, min), results.over(keys, name, max)


def mean(results: Results, situation: str, law: str, name: str) -> float | None:
    """Mean of a figure over the seeds."""
    return over_seeds(results, situation, law, name)[0]
