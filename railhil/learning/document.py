"""The weights file: a parameter file of the law (:mod:`railhil.scenarios.parameters`), the same bytes each time."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import fields
from importlib.metadata import version
from typing import Any

from railhil.controller_node.high_speed.modelling import HELD_OUT
from railhil.controller_node.high_speed.network import Network
from railhil.controller_node.high_speed.training import BP_DECAY, BP_ITERATIONS, Recipe
from railhil.judge.record import Record
from railhil.learning.models import Learned
from railhil.record.framelog import log_sha256

_HEAD = "# Written by railhil train-model from a recorded run. For railhil run --parameters.\n"
#: Digits of the errors.
_DIGITS = 5


def notes(record: Record, recipe: Recipe, period_s: float, learned: Learned) -> dict[str, Any]:
    """How the networks were made; no date and no path. Errors in km/h, by sampling period in s."""
    solver = "" if recipe.kind == "bp" else " --pinv" if recipe.ridge is None else f" --ridge {recipe.ridge:g}"
    options = f"--hidden {recipe.hidden}{solver} --seed {recipe.seed} --period {period_s:g}"
    method: dict[str, Any] = {"ridge": recipe.ridge} if recipe.ridge is not None else {"pinv": True}
    if recipe.kind == "bp":
        method = {"method": f"L-BFGS-B of scipy {version('scipy')}", "decay": BP_DECAY, "iterations": BP_ITERATIONS}
    return {
        "railhil": version("railhil"),
        "options": options,
        "record_sha256": log_sha256(record.log),
        "scenario_sha256": record.scenario.sha256,
        "driver": record.certificate["controller"],
        "sample_period_s": period_s,
        "hidden": recipe.hidden,
        "seed": recipe.seed,
        **method,
        "samples": learned.rows,
        "samples_not_trained_on": HELD_OUT,
        "period_s": list(learned.errors),
        "rmse_linear_kmh": [_rounded(error.linear_kmh) for error in learned.errors.values()],
        "rmse_integrated_kmh": [_rounded(error.integrated_kmh) for error in learned.errors.values()],
    }


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def document(law: str, record: Record, learned: Learned, noted: Mapping[str, Any]) -> str:
    """The text of the file."""
    return (
        f"{_HEAD}law = {_toml(law)}\n"
        + "".join(_network(network) for network in learned.networks)
        + _table("training", {"scenario": record.scenario.name, "seeds": [record.certificate["seed"]]})
        + _table("training.notes", noted)
    )


def _network(network: Network) -> str:
    values = {item.name: getattr(network, item.name) for item in fields(network)}
    return "\n[[parameters.networks]]\n" + "".join(f"{key} = {_toml(value)}\n" for key, value in values.items())


def _table(title: str, values: Mapping[str, Any]) -> str:
    return f"\n[{title}]\n" + "".join(f"{key} = {_toml(value)}\n" for key, value in values.items())


def _toml(value: Any) -> str:
    if isinstance(value, str):
        # Escapes of JSON are escapes of TOML.
        return json.dumps(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple | list):
        inner = [_toml(item) for item in value]
        return f"[{', '.join(inner)}]" if not value or not isinstance(value[0], tuple) else _rows(inner)
    return repr(value)


def _rows(rows: list[str]) -> str:
    return "[\n" + "".join(f"  {row},\n" for row in rows) + "]"
