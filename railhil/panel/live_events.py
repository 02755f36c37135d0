"""What happens while a run is made: milestones, levels of the watches, interlocks."""

from __future__ import annotations

from typing import Any

from railhil.bus.codes import Event
from railhil.bus.telegrams import RunEvent
from railhil.judge.judging import judging_of
from railhil.panel.declared import Layout
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import System

#: Kept for pages that come later.
EVENTS_MAX = 1000


class LiveEvents:
    """Events of one run after the other. One event is a dict: ``time_s``, ``kind``, ``source``, ``text``, ``rank``."""

    def __init__(self, scenario: AnyScenario, system: System, layout: Layout) -> None:
        self._scenario = scenario
        self._judging = judging_of(scenario)
        self._own = {number: name for name, number in system.events.items()}
        self._lamps = layout.lamps
        self.all: list[dict[str, Any]] = []
        self.restart()

    def restart(self) -> None:
        """Another run begins."""
        self.all = []
        self._number = 0
        self._levels: dict[str, tuple[int, int]] = {}
        self._states: dict[tuple[str, str], int] = {}

    def add(self, time_s: float, kind: str, source: str, text: str, rank: int = 0) -> dict[str, Any]:
        """Take an event from elsewhere."""
        event = {"time_s": time_s, "kind": kind, "source": source, "text": text, "rank": rank}
        self.all.append(event)
        del self.all[:-EVENTS_MAX]
        return event

    def of(self, trace: Trace) -> list[dict[str, Any]]:
        """Events in the telegrams of a trace that begins with the newest ones of the trace before."""
        found = [*self._milestones(trace), *self._watches(trace), *self._interlocks(trace)]
        return sorted(found, key=lambda event: float(event["time_s"]))

    def _milestones(self, trace: Trace) -> list[dict[str, Any]]:
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

    def _watches(self, trace: Trace) -> list[dict[str, Any]]:
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
                rank = watch.ladder.index(level) if level in watch.ladder and why not in watch.start else 0
                if rank and why:
                    text += f": {watch.said(self._scenario, word, why)}"
                found.append(self.add(time_s, "level", watch.name, text, rank))
        return found

    def _interlocks(self, trace: Trace) -> list[dict[str, Any]]:
        found = []
        for lamp in self._lamps:
            times_s = trace.times_s(lamp.port).tolist()
            for time_s, raw in zip(times_s, trace.raw(lamp.port, lamp.signal).tolist(), strict=True):
                if self._states.get((lamp.port, lamp.signal), lamp.normal) != raw:
                    self._states[lamp.port, lamp.signal] = raw
                    word = trace.word(lamp.port, lamp.signal, raw)
                    text = f"{lamp.label}: {'as usual again' if raw == lamp.normal else word}"
                    found.append(self.add(time_s, "interlock", lamp.port, text))
        return found
