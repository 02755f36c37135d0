"""A run while it is made, as messages for the pages."""

from __future__ import annotations

import json
import os
import time
from collections import deque
from typing import Any

import numpy as np

from railhil.bus.frame import Frame
from railhil.cli.watched import Watched
from railhil.dbc import house_contract
from railhil.live.bus_follower import Listener
from railhil.panel.declared import NO_LAYOUT, Layout, layout_of
from railhil.panel.frame_list import FrameList
from railhil.panel.heard_bus import WATCHED_FRAMES, HeardBus
from railhil.panel.history import History
from railhil.panel.kinds import kinds_of
from railhil.panel.live_events import LiveEvents
from railhil.panel.operator import Operator
from railhil.panel.receiver import Receiver
from railhil.panel.values import Rows
from railhil.panel.wire import APPEND, REPLACE, batch
from railhil.record.trace import FloatArray, Trace
from railhil.scenarios.model import Timing
from railhil.scenarios.system import System, system_named
from railhil.scenarios.unknown import UnknownScenario

#: Least wall time between two states (time, counters), and two lists of frames for pages that show them: every second
#: look.
STATE_S = 0.15
#: The same between two lists for pages that have scrolled elsewhere: every tenth look.
LIST_S = 0.95


class LiveRun:
    """Listens to a bus and says what is new.

    What it shows is that of the run that the plant tells; before that, of the scenario that the user names, if any.

    :param operator: the connection to the supervisor; None: there are no commands.
    """

    def __init__(self, watched: Watched, receiver: Receiver, operator: Operator | None = None) -> None:
        self._watched = watched
        self._named = watched.scenario
        self._operator = operator
        self.receiver = receiver
        #: Name of this process's runs, for viewers that must tell them apart.
        self.session = f"{os.getpid()}-{time.time_ns()}"
        self._state_s = self._list_s = self._frames_s = 0.0
        self._show()

    def _show(self) -> None:
        """Show the watched scenario from now on; None: only frames, because it is not known which system runs."""
        scenario, notes = self._watched.scenario, self._watched.notes
        system: System | None = None if scenario is None else system_named(scenario.system)
        self._scenario = scenario
        self.contract = contract = house_contract() if system is None else system.contract
        unknown = UnknownScenario("", "", Timing(base_tick_ns=contract.base_tick_ns))
        self.layout: Layout = NO_LAYOUT if scenario is None else layout_of(scenario, contract, notes)
        self._rows = None if scenario is None else Rows(scenario, self.layout, notes)
        self._events = None if scenario is None or system is None else LiveEvents(scenario, system, self.layout)
        self.heard = HeardBus(contract)
        self.listener = Listener(scenario or unknown, contract, self.heard)
        self._list = FrameList(contract)
        self._history = History(1 + len(self.layout.columns), self.layout.position)
        self._run = self.listener.run
        # The last row and its instant; no row while the curves have a gap.
        self._last: FloatArray | None = None
        self._last_s = -1.0
        #: Rows and telegrams of the last look; the trace begins with the newest telegram of each port before it.
        self.fresh_rows: FloatArray = np.empty((0, 1))
        self.fresh_trace = Trace(contract)
        self.scenario_name = "" if scenario is None else scenario.name

    def header(self) -> dict[str, Any]:
        """What a page is told first."""
        facts = {} if self._scenario is None else {"scenario": self._scenario.name, "system": self._scenario.system}
        name = self.scenario_name or "a run that is not known yet"
        return {
            "kind": "live",
            "runs": [{"name": name, "facts": facts}],
            "layout": self.layout.as_json(),
            "commands": self._operator is not None,
        }

    def past(self) -> list[str | bytes]:
        """Everything so far, for a page that has just come."""
        messages: list[str | bytes] = [batch(REPLACE, 0, self._history.rows)]
        messages.append(json.dumps({"events": [] if self._events is None else self._events.all, "replace": True}))
        messages += [json.dumps(self._state()), json.dumps(self._frames())]
        return messages

    def look(self) -> list[str | bytes]:
        """What is new on the bus."""
        self.fresh_rows = self.fresh_rows[:0]
        frames = self.receiver.look()
        messages: list[str | bytes] = []
        if self._operator is not None and self._named is not None:
            own = list(self._named.faults)
            self._watched.has_further_faults = self._operator.report.get("faults", own) != own
        if self._watched.take(frames):
            self._show()
            messages += [json.dumps({"header": self.header()}), *self.past()]
        if frames or self.receiver.lacks_before or self.receiver.lacks_within:
            messages += self._taken(frames)
        if self._operator is not None:
            messages += [json.dumps({"answer": answer}) for answer in self._operator.look()]
        now_s = time.monotonic()
        if now_s - self._state_s >= STATE_S:
            self._state_s = now_s
            messages.append(json.dumps(self._state()))
        if now_s - self._list_s >= LIST_S:
            self._list_s = now_s
            messages.append(json.dumps(self._frames()))
        return messages

    def frames(self) -> str:
        """See :meth:`railhil.panel.server.Source.frames`."""
        now_s = time.monotonic()
        if now_s - self._frames_s < STATE_S:
            return ""
        self._frames_s = now_s
        return json.dumps(self._frames())

    def command(self, command: dict[str, Any]) -> str:
        """Pass a command to the supervisor; returns why not, empty if it was."""
        if self._operator is None:
            return "no supervisor takes commands here: start the run with railhil run --panel"
        return self._operator.command(command)

    def kinds(self) -> list[dict[str, Any]]:
        """Kinds of faults that take values during the run."""
        report = {} if self._operator is None else self._operator.report
        return kinds_of(report.get("faults", ()))

    def watch(self, can_ids: set[int]) -> None:
        """Keep raw frames of these identifiers."""
        kept = self.heard.watched
        self.heard.watched = {one: kept.get(one, deque(maxlen=WATCHED_FRAMES)) for one in can_ids}

    def _taken(self, frames: list[Frame]) -> list[str | bytes]:
        listener, receiver, messages = self.listener, self.receiver, list[str | bytes]()
        if receiver.lacks_before or receiver.lacks_within:
            listener.hole()
        listener.take(frames)
        if receiver.lacks_within:
            listener.hole()
        if listener.run != self._run:
            self._run, self._last_s, self._last = listener.run, -1.0, None
            self._history.clear()
            messages.append(batch(REPLACE, 0, self._history.rows))
            if self._events is not None:
                self._events.restart()
            messages.append(json.dumps({"events": [], "replace": True}))
        trace, now_s = self.heard.next_trace(), listener.now_s
        if self._rows is None or self._events is None:
            return messages
        if now_s is None:
            return messages + self._gap(self._rows)
        rows = self._rows.of(trace, self._last_s, now_s)
        self.fresh_rows, self.fresh_trace = rows, trace
        if len(rows):
            drawn = self._rows.with_gaps(rows, self._last)
            self._last, self._last_s = rows[-1], float(rows[-1, 0])
            messages.append(self._drawn(drawn))
        if self._rows.is_over(self._last_s, now_s):
            messages += self._gap(self._rows)
        if found := self._events.of(trace):
            messages.append(json.dumps({"events": found}))
        return messages

    def _gap(self, rows: Rows) -> list[str | bytes]:
        """Nothing that is not heard stands still."""
        last, self._last = self._last, None
        return [] if last is None else [self._drawn(rows.gap_after(last[None]))]

    def _drawn(self, rows: FloatArray) -> bytes:
        self._history.add(rows)
        return batch(APPEND, 0, rows)

    def _notices(self) -> list[str]:
        """What must be said large."""
        found = [self._watched.warning]
        if dropped := self.receiver.dropped:
            found.append(f"{dropped} FRAMES DROPPED HERE: the gaps in the curves are not of the run")
        if self.heard.frame_count and not self.listener.knows_time:
            found.append("the time is not known yet: nothing is drawn before TIME_SYNC has told it")
        return [one for one in found if one]

    def _frames(self) -> dict[str, Any]:
        return {"frames": self._list.rows(self.listener, self.heard), "raw": self._list.watched(self.heard)}

    def _state(self) -> dict[str, Any]:
        listener, heard = self.listener, self.heard
        return {
            "state": {
                "time_s": listener.now_s,
                "run": self._watched.run,
                "notices": self._notices(),
                "bus": self.receiver.trouble,
                "load": heard.load,
                "frames": heard.frame_count,
                "polls": heard.polls,
                "missed": sum(heard.missed.values()),
                "dropped": self.receiver.dropped,
                "rate": listener.clock.rate,
                "operator": None if self._operator is None else self._operator.report,
            },
        }
