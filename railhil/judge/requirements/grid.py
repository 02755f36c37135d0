"""The one time of a record's requirements: the base tick.

The grid has every tick from 0 to the last one of the record. A value holds from its telegram's instant until the next
telegram of its port that shows one; before the first one it is not known. One that is refused shows none.
The telegrams of a tick have come when it is looked at.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.bus.codes import Event
from railhil.bus.lifesign import Life
from railhil.bus.schedule import Schedule
from railhil.judge.events.summary import fault_events
from railhil.judge.events.telegrams import milestones
from railhil.judge.reception import judged, shown, taken
from railhil.record.trace import FloatArray

if TYPE_CHECKING:
    from railhil.judge.record import Record

Ticks: TypeAlias = npt.NDArray[np.int64]
#: Causes for which a telegram is refused whatever its content.
_STALE = (Life.DUPLICATE.value, Life.OUT_OF_ORDER.value)
#: Silence of a port, in its periods, after which its good telegrams are counted anew: one lost telegram is no end of a
#: row, as in the watches of the bench (chosen).
ROW_ENDS_PERIODS = 2


class Grid:
    """The values of one record at each tick, shape (count,); each is computed once."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self.trace = record.trace
        self.scenario: Any = record.scenario
        self.tick_ns: int = record.scenario.timing.base_tick_ns
        self.count: int = self.trace.end_ns // self.tick_ns + 1
        #: Values that others keep here, by whatever tells them apart.
        self.kept: dict[object, FloatArray] = {}
        self._places: dict[str, Ticks] = {}
        self._received: dict[str, tuple[Ticks, Ticks, Ticks]] = {}

    @cached_property
    def ticks_ns(self) -> Ticks:
        """Instant of each tick in ns."""
        return np.arange(self.count, dtype=np.int64) * self.tick_ns

    @cached_property
    def schedule(self) -> Schedule:
        """Periods of the ports."""
        return Schedule.from_contract(self.tick_ns, self.scenario.timing.port_period_ns, self.trace.contract)

    def tick_at(self, instant_s: float) -> int:
        """The first tick at or after an instant; -1 or less, or ``count`` or more, outside the record."""
        # Instants on the wire are whole 0.1 ms.
        return -(-round(instant_s * 1e9) // self.tick_ns)

    def held(self, port: str, values: FloatArray) -> FloatArray:
        """Values of a port's telegrams, shape (telegrams,), at each tick: that of the newest one that shows it
        (:func:`railhil.judge.reception.shown`); NaN before the first one."""
        places = self._places.get(port)
        if places is None:
            times_ns = np.array(self.trace.times_ns(port), dtype=np.int64)
            good = np.ones(len(times_ns), dtype=bool)
            for item in self.record.judging.received(self.scenario):
                if item.port == port:
                    good &= shown(self.scenario, self.trace, item)
            number = np.searchsorted(times_ns[good], self.ticks_ns, side="right")
            # Place -1 is the NaN at the end.
            places = self._places[port] = np.concatenate([[-1], np.flatnonzero(good)])[number]
        return np.append(values, np.nan)[places]

    def _told(self, port: str, values: FloatArray) -> FloatArray:
        """The same with the newest telegram of all, also one that is refused."""
        times_ns = np.array(self.trace.times_ns(port), dtype=np.int64)
        return np.append(values, np.nan)[np.searchsorted(times_ns, self.ticks_ns, side="right") - 1]

    def signal(self, port: str, signal: str) -> FloatArray:
        """A signal in its unit at each tick; NaN where it is not known, and if this record's contract lacks it.

        A check variable is one of all telegrams: those that it has refused are told by nothing else.
        """
        found = self.kept.get((port, signal))
        if found is None:
            checks = {name for item in self.record.judging.received(self.scenario) for name in item.checks}
            held = self._told if signal in checks else self.held
            known = self.trace.has(port, signal)
            found = held(port, self.trace.values(port, signal)) if known else np.full(self.count, np.nan)
            self.kept[port, signal] = found
        return found

    def _reception(self, port: str) -> tuple[Ticks, Ticks, Ticks]:
        """Instants in ns of the accepted telegrams of a port, of the refused ones, and of the refused ones with wrong
        content, each in order.

        A telegram is accepted if its receiver has heard it, and neither the traffic store nor the receiver refuses it
        (:func:`railhil.judge.reception.taken`, which the invariants use, too).
        """
        found = self._received.get(port)
        if found is None:
            times_ns = np.array(self.trace.times_ns(port), dtype=np.int64)
            good = np.ones(len(times_ns), dtype=bool)
            bad, wrong = np.zeros((2, len(times_ns)), dtype=bool)
            for item in self.record.judging.received(self.scenario):
                if item.port == port:
                    good &= taken(self.scenario, self.trace, item)
                    causes = dict(judged(self.scenario, self.trace, item))
                    bad[list(causes)] = True
                    wrong[[number for number, cause in causes.items() if cause not in _STALE]] = True
            unread = [time_ns for time_ns, source, _ in self.trace.refused if source == port]
            refused = np.sort(np.concatenate([times_ns[bad], np.array(unread, dtype=np.int64)]))
            found = self._received[port] = times_ns[good], refused, times_ns[wrong]
        return found

    def _newest(self, port: str) -> tuple[Ticks, Ticks]:
        """Number of accepted telegrams up to each tick, and the instant of the newest one in ns (0: none yet)."""
        accepted_ns = self._reception(port)[0]
        number = np.searchsorted(accepted_ns, self.ticks_ns, side="right")
        return number, np.concatenate([[0], accepted_ns])[number]

    def age_ms(self, port: str) -> FloatArray:
        """Time since the last accepted telegram of a port, in ms; before the first one since the start."""
        return np.asarray((self.ticks_ns - self._newest(port)[1]) / 1e6, dtype=np.float64)

    def good(self, port: str) -> FloatArray:
        """Number of telegrams of a port that were accepted in a row: after the last one with wrong content, and without
        a silence of more than :data:`ROW_ENDS_PERIODS` periods. As for the watches, a telegram that comes twice or too
        late, or that cannot be read, tells nothing: it ends no row."""
        accepted_ns, _, wrong_ns = self._reception(port)
        number, newest_ns = self._newest(port)
        silent_ns = np.iinfo(np.int64).max
        if port in self.schedule.periods_ns:
            silent_ns = ROW_ENDS_PERIODS * self.schedule.ticks(port) * self.tick_ns
        # A row begins with the first telegram after a silence or after a wrong telegram.
        begins = np.diff(accepted_ns, prepend=np.int64(0)) > silent_ns
        before = np.searchsorted(wrong_ns, accepted_ns, side="left")
        begins |= np.diff(before, prepend=np.int64(0)) > 0
        begun = np.concatenate([[0], np.maximum.accumulate(np.where(begins, np.arange(len(begins)), 0))])[number]
        ended = np.searchsorted(wrong_ns, self.ticks_ns, side="right") > np.concatenate([[0], before])[number]
        ended |= self.ticks_ns - newest_ns > silent_ns
        return np.where(ended, 0.0, np.asarray(number - begun, dtype=np.float64))

    def bad(self, port: str) -> FloatArray:
        """Number of telegrams of a port that were refused after its last accepted one."""
        refused_ns = self._reception(port)[1]
        number, newest_ns = self._newest(port)
        before = np.searchsorted(refused_ns, newest_ns, side="right") * (number > 0)
        return np.asarray(np.searchsorted(refused_ns, self.ticks_ns, side="right") - before, dtype=np.float64)

    @cached_property
    def _milestones(self) -> Mapping[str, list[int]]:
        found: dict[str, list[int]] = {}
        for event in milestones(self.trace, self.scenario.installed_system.events):
            found.setdefault(event.cause, []).append(self.tick_at(event.time_s))
        for event in fault_events(self.record.certificate.get("injected", ()), self.trace.end_s):
            found.setdefault("fault", []).append(self.tick_at(event.time_s))
            if event.until_s is not None and event.until_s < self.trace.end_s:
                found.setdefault("fault_end", []).append(self.tick_at(event.until_s))
        return found

    def occurs(self, event: str) -> npt.NDArray[np.bool_]:
        """The ticks with an event, at or just after its instant."""
        found = np.zeros(self.count, dtype=bool)
        for tick in self._milestones.get(event, ()):
            # The last milestone may be stamped after the last whole tick.
            if tick >= 0:
                found[min(tick, self.count - 1)] = True
        return found


def event_names(scenario: Any) -> list[str]:
    """The events that a record of this scenario may have, without the levels of its watches."""
    own = scenario.installed_system.events
    return [*(kind.name.lower() for kind in Event if kind), *own, "fault", "fault_end"]
