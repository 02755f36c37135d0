"""Networks for every power unit of a recorded run, and how well they explain samples that they were not trained on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from railhil.common.digits import count_of
from railhil.common.errors import InputError, Words
from railhil.controller_node.high_speed.model import pade_zoh
from railhil.controller_node.high_speed.modelling import HELD_OUT, PERIODS_S, ModelError, rows_of, trained
from railhil.controller_node.high_speed.network import Network
from railhil.controller_node.high_speed.training import Recipe, Rows
from railhil.judge.record import Record
from railhil.learning.series import Series, series_of


@dataclass(frozen=True, slots=True)
class Unit:
    """Linear model of a power unit (delay and lag in s), and its part of the record."""

    delay_s: float
    lag_s: float
    series: Series

    def rows(self, period_s: float, phase_s: float) -> Rows:
        """Training data at a sampling period."""
        return rows_of(pade_zoh(self.delay_s, self.lag_s, period_s), *self.series.sampled(period_s, phase_s))


@dataclass(frozen=True, slots=True)
class Learned:
    """``networks``: one for each unit. Of the first unit: number of ``rows``, ``errors`` by sampling period in s."""

    networks: tuple[Network, ...]
    errors: Mapping[float, ModelError]
    rows: int


def units_of(record: Record) -> list[Unit]:
    """The power units of a record.

    :raises InputError: the record's system has none.
    """
    scenario = record.scenario
    tables = getattr(getattr(scenario, "task", None), "unit", None)
    if not tables:
        raise InputError(record.log, "system", scenario.system, "a system of high-speed trains: hst1 or emu3")
    return [
        Unit(table.traction_delay_s, table.lag_s, series_of(scenario, record.trace, number, len(tables)))
        for number, table in enumerate(tables, 1)
    ]


def learn(record: Record, recipe: Recipe, period_s: float) -> Learned:
    """Train a network for each power unit.

    :param period_s: sampling period of the law that will use them.
    :raises InputError: the record is of another system or too short.
    """
    units = units_of(record)
    phases = [unit.series.phase_s(period_s) for unit in units]
    networks = [
        _trained(record, unit, recipe, period_s, phase_s)[0] for unit, phase_s in zip(units, phases, strict=True)
    ]
    first = units[0]
    errors = {at_s: _trained(record, first, recipe, at_s, phases[0])[1] for at_s in PERIODS_S}
    return Learned(tuple(networks), errors, len(first.rows(period_s, phases[0])))


def _trained(record: Record, unit: Unit, recipe: Recipe, period_s: float, phase_s: float) -> tuple[Network, ModelError]:
    rows = unit.rows(period_s, phase_s)
    if len(rows) < 2 * HELD_OUT:
        found = Words(f"{count_of(len(rows), 'sample')} of {period_s:g} s")
        raise InputError(record.log, "length", found, f"at least {2 * HELD_OUT}")
    try:
        return trained(rows, recipe, period_s, unit.delay_s, unit.lag_s)
    except ValueError as error:
        raise InputError(
            "command line", "--ridge", recipe.ridge, "one that determines all weights", str(error)
        ) from None
