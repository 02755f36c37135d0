"""Rows of the page's columns from telegrams: while they come, and of a whole record."""

from __future__ import annotations

from typing import Any

import numpy as np

from railhil.panel.declared import ERROR, LAMP, Layout
from railhil.scenarios.model import AnyScenario
from railhil.supervisor.judging import judging_of
from railhil.supervisor.signals import signal_table
from railhil.supervisor.trace import FloatArray, Trace


def rows_of(
    scenario: AnyScenario,
    layout: Layout,
    trace: Trace,
    notes: Any = None,
    after_s: float = -1.0,
    before_s: float = np.inf,
) -> FloatArray:
    """One row for each telegram of the truth: time in s, then the columns in their shown units.

    :param after_s, before_s: only rows later than the one and earlier than the other; the present tick is not complete.
    :returns: shape (n, 1 + columns); unknown values are NaN.
    """
    _, table = signal_table(scenario, trace, notes)
    table = table[(table[:, 0] > after_s) & (table[:, 0] < before_s)]
    further = [_sampled(trace, table[:, 0], port, signal) for _, port, signal in judging_of(scenario).shown]
    table = np.column_stack([table, *further])
    plain = [column for column in layout.columns if column.kind != LAMP and column.name != ERROR]
    table = table * np.array([1.0, *(column.factor for column in plain)])
    beside = []
    if any(column.name == ERROR for column in layout.columns):
        beside.append(table[:, 1 + layout.target] - table[:, 1 + layout.speed])
    beside += [_sampled(trace, table[:, 0], lamp.port, lamp.signal) for lamp in layout.lamps]
    return np.column_stack([table, *beside])


def _sampled(trace: Trace, time_s: FloatArray, port: str, signal: str) -> FloatArray:
    """The last known value of a signal at each instant, NaN before the first."""
    at = np.searchsorted(trace.times_s(port), time_s, side="right") - 1
    known: FloatArray = np.append(trace.values(port, signal), np.nan)[at]
    return np.where(at >= 0, known, np.nan)
