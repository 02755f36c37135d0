"""How well a realtime run has kept its time, measured where time is made: lateness of each tick, latency of each poll.

Kept in memory while the run goes on, written as a table when it has ended.
"""

from __future__ import annotations

from array import array
from pathlib import Path

from railhil.common.whole_file import whole_file

#: Event of a tick in the table; the others are the names of the ports polled.
TICK = "tick"
#: In place of a latency: no answer within the reply time-out, or one that was refused.
MISSED_NS = -1


class PlantTiming:
    """Events of one run in the order in which they happened; 17 bytes each."""

    def __init__(self) -> None:
        self._ticks: array[int] = array("q")
        self._events: array[int] = array("B")
        self._ns: array[int] = array("q")
        self._names = [TICK]

    def began(self, tick: int, lateness_ns: int) -> None:
        """A tick began, so long after its absolute deadline on the monotonic clock."""
        self._ticks.append(tick)
        self._events.append(0)
        self._ns.append(lateness_ns)

    def polled(self, tick: int, port: str, answer_ns: int) -> None:
        """A port was polled; from the poll to the answer it took ``answer_ns``, or :data:`MISSED_NS`."""
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
