"""Figures of docs/howto/train_model.md."""

from __future__ import annotations

from collections.abc import Sequence

from hil_tests.documents.figures import row, tuning_notes
from hil_tests.support.paths import ROOT
from railhil.bench import direct_run
from railhil.scenarios.load import load_any
from railhil.scenarios.run_spec import LawSpec, RunSpec

_SEEDS = range(201, 206)


def modelling() -> Sequence[str]:
    """What the shipped ELM's file says of its training; a test makes the file again."""
    notes = tuning_notes(ROOT / "controller_node/high_speed/weights/elm_ngpc_hst1.toml")
    return [
        row(f"{name}, km/h", *(f"{value:.4f}" for value in notes[key]))
        for name, key in (("linear model", "rmse_linear_kmh"), ("with the network", "rmse_integrated_kmh"))
    ]


def _rmse(law: str, scenario: str, score: str) -> list[float]:
    loaded, spec = load_any(scenario), LawSpec(law, "float64")
    found = [direct_run(loaded, RunSpec(law=spec, seed=seed)).score.values[score] for seed in _SEEDS]
    return [float("inf") if value is None else value for value in found]


def emergency() -> Sequence[str]:
    """RMSE of each law in the emergency, on seeds on which nothing was trained or chosen."""
    rows = []
    for law in ("elm_ngpc", "bp_ngpc", "os_elm_ngpc", "res_ngpc", "mm_gpc", "pid"):
        found = _rmse(law, "jinan_xuzhou_emergency", "emergency_rmse_kmh")
        rows.append(row(f"`{law}`", " ".join(f"{value:.3f}" for value in found), f"{sum(found) / len(found):.3f}"))
    return rows


def normal() -> Sequence[str]:
    """The same of the ELM in normal running."""
    found = _rmse("elm_ngpc", "jinan_xuzhou", "rmse_kmh")
    return (" ".join(f"{value:.3f}" for value in found) + f", mean {sum(found) / len(found):.3f}.",)
