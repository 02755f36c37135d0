"""The last known values of signals at given instants, and how long they hold."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
import numpy.typing as npt

from railhil.bus.schedule import Schedule
from railhil.dbc import Contract
from railhil.scenarios.model import AnyScenario
from railhil.supervisor.trace import FloatArray, Trace

#: A port that is silent for more of its periods has no value (sink-time supervision).
SILENT_PERIODS: Final = 3
#: Where the row that stands for a gap comes, after the last one before it.
_AFTER_S: Final = 0.001


def holding_s(scenario: AnyScenario, contract: Contract) -> dict[str, float]:
    """How long the value of a port holds without another telegram, in s, by port.

    Events with a period are repeated on it. The value of a port without a period holds for ever; it is left out.
    """
    timing = scenario.timing
    schedule = Schedule.from_contract(timing.base_tick_ns, timing.port_period_ns, contract)
    return {port: SILENT_PERIODS * schedule.ticks(port) * schedule.base_tick_ns / 1e9 for port in schedule.periods_ns}


def silences(time_s: FloatArray, holds_s: float) -> npt.NDArray[np.int64]:
    """Places of the instants after which the next one comes later than ``holds_s``, shape (k,)."""
    # Instants are multiples of a tick: what is left is rounding.
    return np.flatnonzero(np.diff(time_s) > holds_s + _AFTER_S / 2)


def gap_after(rows: FloatArray, position: int = -1) -> FloatArray:
    """For each row the one that says that nothing is known from then on but time and position.

    :param rows: shape (n, columns), the time in s first.
    :param position: column of the position; -1: there is none.
    """
    gaps = np.full_like(rows, np.nan)
    gaps[:, 0] = rows[:, 0] + _AFTER_S
    if position >= 0:
        gaps[:, position] = rows[:, position]
    return gaps


class Sampler:
    """Many signals come from one port: the telegrams that were the newest are searched once.

    :param time_s: the instants in s, shape (n,).
    :param holds_s: how long the value of a port holds (:func:`holding_s`); None: until the next.
    """

    def __init__(self, trace: Trace, time_s: FloatArray, holds_s: Mapping[str, float] | None = None) -> None:
        self._trace = trace
        self._time_s = time_s
        self._holds_s = holds_s or {}
        #: Place of the telegram that holds at each instant, and whether there is one at all of them.
        self._places: dict[str, tuple[npt.NDArray[np.int64], bool]] = {}

    def of(self, port: str, values: FloatArray) -> FloatArray:
        """The last known one of the values of a port's telegrams at each instant, NaN where none holds; shape (n,)."""
        known = self._places.get(port)
        if known is None:
            told_s = self._trace.times_s(port)
            places = told_s.searchsorted(self._time_s, "right") - 1
            if port in self._holds_s and len(told_s):
                places[self._time_s - told_s[places] > self._holds_s[port] + _AFTER_S / 2] = -1
            known = self._places[port] = places, bool((places >= 0).all())
        places, always = known
        # -1 is the NaN at the end.
        return values[places] if always else np.append(values, np.nan)[places]

    def signal(self, port: str, signal: str) -> FloatArray:
        """As :meth:`of`, of a signal in its unit."""
        return self.of(port, self._trace.values(port, signal))
