"""Timing of a real-time run, measured in the plant, which sets the pace: lateness of each tick, latency of each poll.

Kept in memory during the run, and written as a table at its end.
"""

from __future__ import annotations

from array import array
from pathlib import Path

from railhil.common.user_files import whole_file

#: Name of a tick's event in the table; other events are named by the port polled.
TICK = "tick"
#: Value in place of a latency: no answer within the reply time-out, or a refused one.
MISSED_NS = -1


class PlantTiming:
    """Events of one run in the order in which they happened; 17 bytes each."""

    def __init__(self) -> None:
        self._ticks: array[int] = array("q")
        self._events: array[int] = array("B")
        self._ns: array[int] = array("q")
        self._names = [TICK]

    def began(self, tick: int, lateness_ns: int) -> None:
        """Note that a tick began with this lateness after its absolute deadline on the monotonic clock."""
        self._ticks.append(tick)
        self._events.append(0)
        self._ns.append(lateness_ns)

    def polled(self, tick: int, port: str, answer_ns: int) -> None:
        """Note a poll of a port, with the time from poll to answer, ``answer_ns``, or :data:`MISSED_NS`."""
        if port not in self._names:
            self._names.append(port)
        self._ticks.append(tick)
        self._events.append(self._names.index(port))
        self._ns.append(answer_ns)

    def write(self, path: Path) -> None:
        """Write ``tick,event,ns``, one row per event.

        :raises OSError: the file cannot be written.
        """
        rows = zip(self._ticks, self._events, self._ns, strict=True)
        text = "".join(f"{tick},{self._names[event]},{ns}\n" for tick, event, ns in rows)
        with whole_file(path) as draft:
            draft.write_text(f"tick,event,ns\n{text}", encoding="ascii")
