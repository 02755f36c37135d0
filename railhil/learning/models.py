"""Networks for every power unit of a recorded run, their errors on samples outside the training data, and the weights
file. The file is a parameter file of the law (:mod:`railhil.scenarios.parameters`), with the same bytes each time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from importlib.metadata import version
from typing import Any

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.common.version import full_version
from railhil.controller_node.high_speed.model import pade_zoh
from railhil.controller_node.high_speed.network import Network
from railhil.controller_node.high_speed.training import (
    BP_DECAY,
    BP_ITERATIONS,
    HELD_OUT,
    PERIODS_S,
    ModelError,
    Recipe,
    Rows,
    rows_of,
    train_and_judge,
)
from railhil.judge.folder import code_sha256
from railhil.judge.record import Record
from railhil.learning.series import Series, read_series
from railhil.record.framelog import log_sha256
from railhil.scenarios.tomlfile import toml_table, toml_value

_HEAD = "# Written by railhil train-model from a recorded run. For railhil run --parameters.\n"
#: Digits of the errors.
_DIGITS = 5
#: Code on which the training depends, in addition to that of the bench.
_OWN_CODE = ("learning",)


@dataclass(frozen=True, slots=True)
class Unit:
    """Linear model of a power unit (delay and lag in s), and its part of the record."""

    delay_s: float
    lag_s: float
    series: Series

    def rows(self, period_s: float, phase_s: float) -> Rows:
        """Training data at a sampling period."""
        return rows_of(pade_zoh(self.delay_s, self.lag_s, period_s), *self.series.sample(period_s, phase_s))


@dataclass(frozen=True, slots=True)
class TrainedModels:
    """``networks``: one for each unit. ``rows`` (their number) and ``errors`` (by sampling period in s) are of the
    first unit."""

    networks: tuple[Network, ...]
    errors: Mapping[float, ModelError]
    rows: int


def find_units(record: Record) -> list[Unit]:
    """The power units of a record.

    :raises InputError: the record's system has none.
    """
    scenario = record.scenario
    tables = getattr(getattr(scenario, "task", None), "unit", None)
    if not tables:
        raise InputError(record.log, "system", scenario.system, "a system of high-speed trains: hst1 or emu3")
    return [
        Unit(table.traction_delay_s, table.lag_s, read_series(scenario, record.trace, number, len(tables)))
        for number, table in enumerate(tables, 1)
    ]


def train_models(record: Record, recipe: Recipe, period_s: float) -> TrainedModels:
    """Train a network for each power unit.

    :param period_s: sampling period of the law that will use them.
    :raises InputError: the record is of another system or too short.
    """
    units = find_units(record)
    phases = [unit.series.phase_s(period_s) for unit in units]
    networks = [_train(record, unit, recipe, period_s, phase_s)[0] for unit, phase_s in zip(units, phases, strict=True)]
    first = units[0]
    errors = {at_s: _train(record, first, recipe, at_s, phases[0])[1] for at_s in PERIODS_S}
    return TrainedModels(tuple(networks), errors, len(first.rows(period_s, phases[0])))


def _train(record: Record, unit: Unit, recipe: Recipe, period_s: float, phase_s: float) -> tuple[Network, ModelError]:
    rows = unit.rows(period_s, phase_s)
    if len(rows) < 2 * HELD_OUT:
        found = Words(f"{count_of(len(rows), 'sample')} of {period_s:g} s")
        raise InputError(record.log, "length", found, f"at least {2 * HELD_OUT}")
    try:
        return train_and_judge(rows, recipe, period_s, unit.delay_s, unit.lag_s)
    except ValueError as error:
        raise InputError(
            "command line", "--ridge", recipe.ridge, "one that determines all weights", str(error)
        ) from None


def describe_training(record: Record, recipe: Recipe, period_s: float, models: TrainedModels) -> dict[str, Any]:
    """Origin of the networks; no date and no path. Errors in km/h, by sampling period in s."""
    solver = "" if recipe.kind == "bp" else " --pinv" if recipe.ridge is None else f" --ridge {recipe.ridge:g}"
    options = f"--hidden {recipe.hidden}{solver} --seed {recipe.seed} --period {period_s:g}"
    method: dict[str, Any] = {"ridge": recipe.ridge} if recipe.ridge is not None else {"pinv": True}
    if recipe.kind == "bp":
        method = {"method": f"L-BFGS-B of scipy {version('scipy')}", "decay": BP_DECAY, "iterations": BP_ITERATIONS}
    return {
        "railhil": full_version(),
        "code_sha256": code_sha256(),
        "training_sha256": code_sha256(_OWN_CODE),
        "options": options,
        "record_sha256": log_sha256(record.log),
        "scenario_sha256": record.scenario.sha256,
        "driver": record.certificate["controller"],
        "sample_period_s": period_s,
        "hidden": recipe.hidden,
        "seed": recipe.seed,
        **method,
        "samples": models.rows,
        "samples_not_trained_on": HELD_OUT,
        "period_s": list(models.errors),
        "rmse_linear_kmh": [_round(error.linear_kmh) for error in models.errors.values()],
        "rmse_integrated_kmh": [_round(error.integrated_kmh) for error in models.errors.values()],
    }


def _round(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def render_file(law: str, record: Record, models: TrainedModels, notes: Mapping[str, Any]) -> str:
    """The text of the file."""
    networks = [{item.name: getattr(network, item.name) for item in fields(network)} for network in models.networks]
    return (
        f"{_HEAD}law = {toml_value(law)}\n"
        + "".join(toml_table("[parameters.networks]", network) for network in networks)
        + toml_table("training", {"scenario": record.scenario.name, "seeds": [record.certificate["seed"]]})
        + toml_table("training.notes", notes)
    )
