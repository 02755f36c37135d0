"""Events for the pages: those of a record, and those of a run while it is made (milestones, levels of the watches,
interlocks, orders, faults)."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from railhil.bus.codes import Event
from railhil.bus.telegrams import RunEvent
from railhil.judge.events.event import FAULT, LEVEL, MISSED_POLL, START, RecordedEvent
from railhil.judge.events.summary import fault_events
from railhil.judge.judging import judging_of
from railhil.panel.layout import Layout
from railhil.panel.live_orders import LiveOrders
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import System

#: Messages kept for pages that connect later.
EVENTS_MAX = 1000
#: Message of a run without events.
NO_EVENTS = {"events": [], "replace": True}


class LiveEvents:
    """Events of one run after the other. One event is a dict: ``time_s``, ``kind``, ``source``, ``text``, ``rank``.

    :param faults: gives the faults of the run, as texts.
    """

    def __init__(
        self, scenario: AnyScenario, system: System, layout: Layout, faults: Callable[[], Sequence[str]]
    ) -> None:
        self._scenario = scenario
        self._judging = judging_of(scenario)
        self._own = {number: name for name, number in system.events.items()}
        self._lamps = layout.lamps
        self.all: list[dict[str, Any]] = []
        self._orders = LiveOrders(faults, self.add, system)
        self.restart()

    def restart(self) -> None:
        """Another run begins."""
        self.all = []
        self._number = 0
        self._levels: dict[str, tuple[int, int]] = {}
        self._states: dict[tuple[str, str], int] = {}
        self._orders.restart()

    def add(self, time_s: float, kind: str, source: str, text: str, rank: int = 0) -> dict[str, Any]:
        """Take an event from elsewhere."""
        event = {"time_s": time_s, "kind": kind, "source": source, "text": text, "rank": rank}
        self.all.append(event)
        del self.all[:-EVENTS_MAX]
        return event

    def find(self, trace: Trace, now_s: float) -> str:
        """A message with the events until an instant; empty: there are none.

        :param trace: begins with the newest telegrams of the trace before.
        """
        found = [*self._find_milestones(trace), *self._find_levels(trace), *self._find_interlocks(trace)]
        found += self._orders.find(trace)
        if self._orders.has_changed:
            return self.describe()
        return json.dumps({"events": sorted(found, key=_time_s)}) if found else ""

    def describe(self) -> str:
        """A message with all events."""
        return json.dumps({"events": sorted(self.all, key=_time_s), "replace": True})

    def lose(self) -> None:
        """Telegrams are missing."""
        self._orders.lose()

    def take_record(self, injected: Sequence[Mapping[str, Any]], end_s: float) -> None:
        """The run has ended: its record tells when its faults acted.

        :param injected: of its certificate.
        """
        self.all = [event for event in self.all if event["kind"] != FAULT]
        self.all += [describe_event(event) for event in fault_events(injected, end_s)]

    def _find_milestones(self, trace: Trace) -> list[dict[str, Any]]:
        found = []
        numbers = trace.raw(RunEvent.PORT, "EventNumber").tolist()
        codes = trace.raw(RunEvent.PORT, "RunEvent").tolist()
        times_s = trace.values(RunEvent.PORT, "EventTime").tolist()
        for number, code, time_s in zip(numbers, codes, times_s, strict=True):
            if number > self._number:
                self._number = number
                known = Event(code).name.lower() if code in Event._value2member_map_ else self._own.get(code, str(code))
                found.append(self.add(time_s, "milestone", "plant", known.replace("_", " ")))
        return found

    def _find_levels(self, trace: Trace) -> list[dict[str, Any]]:
        found = []
        for watch in self._judging.watches:
            if not trace.has(watch.port, watch.level):
                continue
            levels = trace.raw(watch.port, watch.level).tolist()
            has_cause = trace.has(watch.port, watch.cause)
            causes = trace.raw(watch.port, watch.cause).tolist() if has_cause else [0] * len(levels)
            for time_s, level, cause in zip(trace.times_s(watch.port).tolist(), levels, causes, strict=True):
                if self._levels.get(watch.name, (watch.ladder[0], 0)) == (level, cause):
                    continue
                self._levels[watch.name] = (level, cause)
                word = trace.word(watch.port, watch.level, level)
                why = trace.word(watch.port, watch.cause, cause) if has_cause else ""
                text = word.replace("_", " ")
                is_reaction = level in watch.ladder and not watch.is_normal(level) and why not in watch.start
                rank = watch.ladder.index(level) if is_reaction else 0
                if rank and why:
                    text += f": {watch.said(self._scenario, word, why)}"
                found.append(self.add(time_s, "level", watch.name, text, rank))
        return found

    def _find_interlocks(self, trace: Trace) -> list[dict[str, Any]]:
        found = []
        for lamp in self._lamps:
            times_ns = trace.times_ns(lamp.port)
            for time_ns, raw in zip(times_ns, trace.raw(lamp.port, lamp.signal).tolist(), strict=True):
                if self._states.get((lamp.port, lamp.signal), lamp.normal) != raw:
                    self._states[lamp.port, lamp.signal] = raw
                    word = trace.word(lamp.port, lamp.signal, raw)
                    text = f"{lamp.label}: {'as usual again' if raw == lamp.normal else word}"
                    found.append(self.add(time_ns / 1e9, "interlock", lamp.port, text))
        return found


def _time_s(event: Mapping[str, Any]) -> float:
    return float(event["time_s"])


def describe_event(event: RecordedEvent, run: str = "") -> dict[str, Any]:
    """An event of a record for the pages, of which ``run`` says whose it is (empty: there is one run)."""
    words = [event.level, event.detail or event.cause]
    is_fault = event.kind == FAULT
    # A fault is a text of the fault language, which tells its hits itself.
    text = event.detail if is_fault else ": ".join(word.replace("_", " ") for word in words if word)
    if event.kind == MISSED_POLL:
        text = f"missed poll: {text}"
    times = f" ({event.count} times)" if event.count > 1 and not is_fault else ""
    return {
        "time_s": event.time_s,
        "until_s": event.until_s if event.kind in (LEVEL, FAULT) else None,
        "kind": "start" if event.kind == START else event.kind,
        "source": run + event.source,
        "text": text + times,
        "rank": event.rank,
    }
