"""Present values of a run of any system: speed, target, command, ladders and distance to go.

They come from the newest telegram of each port, without any work per tick or frame between two readings. Lateness of a
real-time run, for the panel, is measured at the arrivals of the ticks at the recorder.
"""

from __future__ import annotations

import os
from array import array
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from railhil.bus.frame import Frame
from railhil.bus.store import TrafficStore
from railhil.dbc import Contract
from railhil.judge.events.summary import level_shown
from railhil.judge.judging import judging_of
from railhil.judge.signals import table_of
from railhil.record.framelog import parsed_line
from railhil.record.sampling import holding_s
from railhil.record.trace import Trace
from railhil.report.display_columns import ShownColumn, shown_columns
from railhil.scenarios.model import AnyScenario

#: Parts of a log that are read: its beginning with the handshake, and its end with several telegrams of every cyclic
#: port.
_HEAD_BYTES, _TAIL_BYTES = 8192, 12288
#: Significant digits of a number without words.
_DIGITS = 4


class Newest:
    """The newest telegram of each port, with its simulation time."""

    def __init__(self, contract: Contract) -> None:
        self._contract = contract
        self.store = TrafficStore(contract.ports)
        self._times_ns: dict[str, int] = {}
        self._now_ns = 0

    @property
    def counters(self) -> Counter[str]:
        """Frames and telegrams that were refused, by cause."""
        return self.store.counters

    def take(self, time_ns: int, frame: Frame) -> str | None:
        """Take a frame; returns the port whose telegram it completed."""
        self._now_ns = time_ns
        port = self.store.feed(frame, time_ns)
        if port is not None:
            self._times_ns[port] = time_ns
        return port

    def data(self, port: str) -> bytes:
        """Process data of the newest telegram of a port, empty if there is none."""
        return self.store.raw(port) if port in self._times_ns else b""

    def silent_s(self, port: str) -> float:
        """Time since the last telegram of a port."""
        return (self._now_ns - self._times_ns.get(port, 0)) / 1e9

    def accepts(self, frame: Frame) -> bool:
        """Whether the check of the single frame accepts it."""
        return not self.store.check(frame).cause

    def trace(self, truth: str) -> Trace:
        """A record of these telegrams alone, none later than the newest one of the port ``truth``."""
        found = Trace(self._contract)
        end_ns = self._times_ns.get(truth, 0)
        for port, time_ns in self._times_ns.items():
            found.add(port, min(time_ns, end_ns), self.store.raw(port))
        return found


class LogTail:
    """The newest telegrams of a log that is being written. A reading takes the end of the file and nothing else.

    :param path: it need not exist yet.
    """

    def __init__(self, path: Path, contract: Contract) -> None:
        self._path, self._contract = path, contract
        self._head = b""

    def look(self) -> Newest:
        """The newest telegrams that have been written."""
        newest = Newest(self._contract)
        try:
            with self._path.open("rb") as stream:
                if not self._head:
                    head = stream.read(_HEAD_BYTES)
                    # The beginning is kept once it is complete.
                    self._head = head if len(head) == _HEAD_BYTES else b""
                size = stream.seek(0, os.SEEK_END)
                stream.seek(max(0, size - _TAIL_BYTES))
                tail = stream.read(_TAIL_BYTES)
        except OSError:
            # A run that cannot write its log ends by itself and gives the reason.
            return newest
        lines = self._head.split(b"\n")[:-1] if size > _TAIL_BYTES else []
        lines += tail.split(b"\n")[1 if size > _TAIL_BYTES else 0 : -1]
        for line in lines:
            newest.take(*parsed_line(line.decode("ascii")))
        return newest


#: Nearer to a named place than this a train is at it, m.
_AT_PLACE_M = 1.0


class Instruments:
    """The displayed values of a scenario's system.

    :param notes: the law's declaration of its notes; None: not known.
    """

    def __init__(self, scenario: AnyScenario, notes: Any = None) -> None:
        self._scenario, self._notes = scenario, notes
        self._judging = judging_of(scenario)
        self.shown = shown_columns(scenario, notes=notes)
        self._holds_s = holding_s(scenario, scenario.installed_system.contract)
        self._ends_at_m = self._judging.ends_at_m(scenario)
        named = (place for place in self._judging.places(scenario) if place.kind != "balise")
        self._places = sorted(named, key=lambda place: place.position)

    def values(self, newest: Newest) -> dict[str, float]:
        """Values of the columns that are known now, in their display units; empty before the first telegram of the
        truth."""
        judging, truth = self._judging, self._judging.truth
        header, rows = table_of(judging, self._scenario, newest.trace(truth), self._notes, self._holds_s)
        if not len(rows) or newest.silent_s(truth) > self._holds_s.get(truth, np.inf):
            return {}
        row = dict(zip(header, rows[-1].tolist(), strict=True))
        found = {"time_s": row["time_s"]}
        for column in self.shown.columns:
            if np.isfinite(value := row.get(column.name, np.nan)):
                found[column.name] = value * column.factor
        return found

    def to_go_m(self, values: Mapping[str, float]) -> float | None:
        """Distance to the planned end of the run; None if the system declares none."""
        position_m = values.get(self.shown.position)
        return None if self._ends_at_m is None or position_m is None else self._ends_at_m - position_m

    def place(self, values: Mapping[str, float]) -> str:
        """The named place at which the train is, or the next one and its distance; empty without any."""
        position_m = values.get(self.shown.position)
        ahead = [] if position_m is None else [one for one in self._places if one.position > position_m - _AT_PLACE_M]
        if not ahead or position_m is None:
            return ""
        away_m = ahead[0].position - position_m
        return f"at {ahead[0].name}" if away_m < _AT_PLACE_M else f"{ahead[0].name} in {away_m:.0f} m"

    def describe(self, column: ShownColumn, value: float) -> str:
        """A value in words, or as a number with its unit."""
        if column.words:
            return column.words.get(round(value), f"{value:g}").replace("_", " ")
        return f"{value:.{_DIGITS}g} {column.unit}".strip()

    def ladder(self, values: Mapping[str, float]) -> str:
        """The levels of the watches above normal, ``normal`` if there is none; empty for a system without watches."""
        found, known = [], False
        for watch in self._judging.watches:
            column = self.shown.named(f"{watch.name}_level")
            rank = values.get(f"{watch.name}_level")
            if column is None or rank is None:
                continue
            known = True
            if rank > 0:
                found.append(f"{watch.title} {level_shown(column.words.get(round(rank), str(rank)))}".strip())
        return ", ".join(found) if found else "normal" if known else ""

    def line(self, values: Mapping[str, float]) -> str:
        """Speed, target, command, ladder and distance to go in one line, without the values that the system does not
        have."""
        shown, parts = self.shown, []
        if speed := shown.named(shown.speed):
            parts.append(self._pair(values, speed))
        elif position := shown.named(shown.position):
            parts.append(self._number(values, position, 2))
        if command := shown.named(shown.command):
            value = self._number(values, command, 2)
            parts.append(f"{command.label.removesuffix(' command')} {value}" if value else "")
        if ladder := self.ladder(values):
            parts.append(ladder)
        parts.append(self.place(values))
        if (to_go_m := self.to_go_m(values)) is not None:
            parts.append(f"{to_go_m:.0f} m to go" if abs(to_go_m) >= 10.0 else f"{to_go_m:.2f} m to go")
        return ", ".join(filter(None, parts))

    def _pair(self, values: Mapping[str, float], speed: ShownColumn) -> str:
        target = values.get(self.shown.target)
        text = self._number(values, speed, 1)
        return text if target is None or not text else f"{text} (target {target:.1f})"

    @staticmethod
    def _number(values: Mapping[str, float], column: ShownColumn, digits: int) -> str:
        value = values.get(column.name)
        if value is None:
            return ""
        unit = "" if column.unit in column.label else column.unit
        return f"{value:.{digits}f} {unit}".strip()


#: Number of ticks for the 99 % value: the last seconds, so that the page shows the present state.
RECENT = 1000


class LiveLateness:
    """Lateness of arrivals behind deadlines that are a tick apart, the earliest arrival so far defining zero, as in
    :func:`railhil.judge.jitter.arrivals_of`.

    :param ticks, wall_ns: lists that the session continues to fill: number and monotonic wall time of each tick.
    """

    def __init__(self, ticks: array[int], wall_ns: array[int]) -> None:
        self._ticks = ticks
        self._wall_ns = wall_ns
        self._seen = 0
        self._tick_ns = 0.0
        # Wall time minus deadline, of the earliest and of the latest arrival.
        self._first_ns = self._last_ns = 0.0

    def report(self, tick_ns: float) -> dict[str, Any] | None:
        """``p99_ms`` of the last :data:`RECENT` ticks, ``worst_ms`` and ``cycles`` of the run; None: no tick yet.

        :param tick_ns: wall time between two ticks.
        """
        count = len(self._ticks)
        if not count:
            return None
        if tick_ns != self._tick_ns:
            # The plant has sent another pace, which changes all deadlines.
            self._tick_ns, self._seen = tick_ns, 0
        fresh = self._offsets(self._seen)
        known = [self._first_ns, self._last_ns] if self._seen else []
        self._first_ns, self._last_ns = min(known + fresh), max(known + fresh)
        self._seen = count
        recent = sorted(self._offsets(max(0, count - RECENT)))
        p99_ns = recent[min(len(recent) - 1, len(recent) * 99 // 100)]
        return {
            "p99_ms": (p99_ns - self._first_ns) / 1e6,
            "worst_ms": (self._last_ns - self._first_ns) / 1e6,
            "cycles": count,
        }

    def _offsets(self, begin: int) -> list[float]:
        ticks, wall_ns = self._ticks[begin:], self._wall_ns[begin:]
        return [wall - tick * self._tick_ns for tick, wall in zip(ticks, wall_ns, strict=False)]
