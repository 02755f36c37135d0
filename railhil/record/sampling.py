"""The last known values of signals at given instants, and how long they hold."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from railhil.bus.ident import Ident
from railhil.bus.schedule import Schedule
from railhil.dbc import Contract
from railhil.record.trace import FloatArray, Trace
from railhil.scenarios.model import AnyScenario

#: A port that is silent for more of its periods has no value (sink-time supervision).
SILENT_PERIODS: Final = 3
#: Time from the last row before a gap to the row that stands for the gap.
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
    # Instants are multiples of a tick: a smaller difference is rounding.
    return np.flatnonzero(np.diff(time_s) > holds_s + _AFTER_S / 2)


def gap_after(rows: FloatArray, position: int = -1) -> FloatArray:
    """For each row a row after which nothing is known but time and position.

    :param rows: shape (n, columns), the time in s first.
    :param position: column of the position; -1: there is none.
    """
    gaps = np.full_like(rows, np.nan)
    gaps[:, 0] = rows[:, 0] + _AFTER_S
    if position >= 0:
        gaps[:, position] = rows[:, position]
    return gaps


class DrawnTrace(Trace):
    """A record prepared for figures, so that no line crosses a gap of the record.

    A port that is silent for longer than its values hold has one more row there, just after the last telegram before
    the silence. Its values are unknown: :meth:`values` has NaN, and :meth:`raw` is masked. All other rows are the
    record's.
    """

    def __init__(self, trace: Trace, holds_s: Mapping[str, float]) -> None:
        super().__init__(trace.contract)
        self.idents, self.foreign, self.polls = trace.idents, trace.foreign, trace.polls
        self.refused, self.no_answers, self._missed = trace.refused, trace.no_answers, trace._missed
        self.reported, self.end_ns, self._awaited = trace.reported, trace.end_ns, trace._awaited
        self._record = trace
        self._holds_s = holds_s
        #: Places of the rows without values, by port.
        self._unknown: dict[str, npt.NDArray[np.int64]] = {}

    def unknown(self, port: str) -> npt.NDArray[np.int64]:
        """Places of the rows without values, shape (k,)."""
        if port not in self._unknown:
            time_s = self._record.times_s(port)
            ended_s = [self.end_s] if len(time_s) else []
            after = silences(np.append(time_s, ended_s), self._holds_s.get(port, np.inf))
            self._unknown[port] = after + 1 + np.arange(len(after))
        return self._unknown[port]

    def count(self, port: str) -> int:
        """Number of rows of a port."""
        return self._record.count(port) + len(self.unknown(port))

    def times_ns(self, port: str) -> array[int]:
        """Simulation time of each row of a port in ns, shape (n,)."""
        unknown = self.unknown(port)
        if not len(unknown):
            return self._record.times_ns(port)
        times_ns = self._rows(port, np.array(self._record.times_ns(port), dtype=np.int64))
        times_ns[unknown] += round(_AFTER_S * 1e9)
        return array("q", times_ns.tobytes())

    def order(self, port: str) -> npt.NDArray[np.int64]:
        """Place of each row of a port among all telegrams of the record, shape (n,)."""
        found: npt.NDArray[np.int64] = self._rows(port, self._record.order(port))
        return found

    def raw(self, port: str, signal: str) -> npt.NDArray[np.int64]:
        """Raw values of a signal, shape (n,), masked where nothing is known."""
        unknown, found = self.unknown(port), self._record.raw(port, signal)
        if not len(unknown):
            return found
        masked = np.ma.MaskedArray(self._rows(port, found))
        masked[unknown] = np.ma.masked
        return masked

    def values(self, port: str, signal: str) -> FloatArray:
        """Physical values of a signal, shape (n,), NaN where nothing is known."""
        found: FloatArray = self._rows(port, self._record.values(port, signal))
        found[self.unknown(port)] = np.nan
        return found

    def ident(self, telegram: type[Ident]) -> Ident | None:
        """First handshake telegram of a node."""
        return self._record.ident(telegram)

    def _rows(self, port: str, found: Any) -> Any:
        """The row before is repeated where nothing is known."""
        unknown = self.unknown(port)
        before = unknown - 1 - np.arange(len(unknown))
        return np.insert(found, before + 1, found[before])


def drawn_trace(scenario: AnyScenario, trace: Trace) -> Trace:
    """The record prepared for figures."""
    return trace if isinstance(trace, DrawnTrace) else DrawnTrace(trace, holding_s(scenario, trace.contract))


class Sampler:
    """Many signals come from one port, so its newest telegrams are searched once.

    :param time_s: the instants in s, shape (n,).
    :param holds_s: how long the value of a port holds (:func:`holding_s`); None: until the next.
    """

    def __init__(self, trace: Trace, time_s: FloatArray, holds_s: Mapping[str, float] | None = None) -> None:
        self._trace = trace
        self._time_s = time_s
        self._holds_s = holds_s or {}
        #: Place of the valid telegram at each instant, and whether there is one at all of them.
        self._places: dict[str, tuple[npt.NDArray[np.int64], bool]] = {}

    def of(self, port: str, values: FloatArray) -> FloatArray:
        """The last known value of a port's telegrams at each instant, NaN where none is valid; shape (n,)."""
        known = self._places.get(port)
        if known is None:
            told_s = self._trace.times_s(port)
            places = told_s.searchsorted(self._time_s, "right") - 1
            if port in self._holds_s and len(told_s):
                places[self._time_s - told_s[places] > self._holds_s[port] + _AFTER_S / 2] = -1
            known = self._places[port] = places, bool((places >= 0).all())
        places, always = known
        # Place -1 is the NaN at the end.
        return values[places] if always else np.append(values, np.nan)[places]

    def signal(self, port: str, signal: str) -> FloatArray:
        """As :meth:`of`, for a signal in its unit."""
        return self.of(port, self._trace.values(port, signal))
