"""A run while it is made, as messages for the pages."""

from __future__ import annotations

import json
import os
import time
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from railhil.panel.declared import Layout, layout_of
from railhil.panel.frame_list import FrameList
from railhil.panel.history import History
from railhil.panel.kinds import kinds_of
from railhil.panel.listener import WATCHED_FRAMES, Listener
from railhil.panel.live_events import LiveEvents
from railhil.panel.operator import Operator
from railhil.panel.receiver import Receiver
from railhil.panel.values import Rows
from railhil.panel.wire import APPEND, REPLACE, batch
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.system import system_named
from railhil.supervisor.trace import FloatArray, Trace

#: Least wall time between two states (time, counters), and two lists of frames for pages that show them: every second
#: look.
STATE_S = 0.15
#: The same between two lists for pages that have scrolled elsewhere: every tenth look.
LIST_S = 0.95


class LiveRun:
    """Listens to a bus and says what is new.

    :param notes: the law's declaration of its notes; None: not known.
    :param operator: the connection to the supervisor; None: there are no commands.
    """

    def __init__(
        self,
        scenario: AnyScenario,
        receiver: Receiver,
        title: str,
        notes: Sequence[Mapping[str, Any]] | None = None,
        operator: Operator | None = None,
    ) -> None:
        system = system_named(scenario.system)
        self._scenario = scenario
        self._operator = operator
        self.receiver = receiver
        self.layout: Layout = layout_of(scenario, system.contract, notes)
        self._rows = Rows(scenario, self.layout, notes)
        self.listener = Listener(scenario, system.contract)
        self._list = FrameList(system.contract)
        self._events = LiveEvents(scenario, system, self.layout)
        self._history = History(1 + len(self.layout.columns))
        self._run = self.listener.run
        self._last_s = -1.0
        #: Rows and telegrams of the last look; the trace begins with the newest telegram of each port before it.
        self.fresh_rows: FloatArray = np.empty((0, 1))
        self.fresh_trace = Trace(system.contract)
        self.contract = system.contract
        self.scenario_name = scenario.name
        #: Name of this process's runs, for viewers that must tell them apart.
        self.session = f"{os.getpid()}-{time.time_ns()}"
        self._state_s = self._list_s = self._frames_s = 0.0
        self._title = title

    def header(self) -> dict[str, Any]:
        """What a page is told first."""
        return {
            "kind": "live",
            "runs": [
                {"name": self._title, "facts": {"scenario": self._scenario.name, "system": self._scenario.system}}
            ],
            "layout": self.layout.as_json(),
        }

    def past(self) -> list[str | bytes]:
        """Everything so far, for a page that has just come."""
        messages: list[str | bytes] = [batch(REPLACE, 0, self._history.rows)]
        messages.append(json.dumps({"events": self._events.all, "replace": True}))
        messages += [json.dumps(self._state()), json.dumps(self._frames())]
        return messages

    def look(self) -> list[str | bytes]:
        """What is new on the bus."""
        self.fresh_rows = self.fresh_rows[:0]
        frames = self.receiver.look()
        messages: list[str | bytes] = []
        if frames:
            self.listener.take(frames)
            messages += self._fast()
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
        kept = self.listener.watched
        self.listener.watched = {one: kept.get(one, deque(maxlen=WATCHED_FRAMES)) for one in can_ids}

    def _fast(self) -> list[str | bytes]:
        listener, messages = self.listener, list[str | bytes]()
        if listener.run != self._run:
            self._run, self._last_s = listener.run, -1.0
            self._history.clear()
            self._events.restart()
            messages.append(batch(REPLACE, 0, self._history.rows))
            messages.append(json.dumps({"events": [], "replace": True}))
        trace = listener.next_trace()
        if not listener.knows_time:
            return messages
        rows = self._rows.of(trace, self._last_s, listener.now_s)
        self.fresh_rows, self.fresh_trace = rows, trace
        if len(rows):
            self._last_s = float(rows[-1, 0])
            self._history.add(rows)
            messages.append(batch(APPEND, 0, rows))
        if found := self._events.of(trace):
            messages.append(json.dumps({"events": found}))
        return messages

    def _frames(self) -> dict[str, Any]:
        return {"frames": self._list.rows(self.listener), "raw": self._list.watched(self.listener)}

    def _is_other_scenario(self) -> bool:
        """Whether the plant has told another scenario; one with faults that the operator has added is not another."""
        told = self.listener.told_scenario
        if told in (None, int(self._scenario.sha256[:8], 16)):
            return False
        # A hash with other faults is another one, and says nothing more.
        report = {} if self._operator is None else self._operator.report
        own = list(self._scenario.faults)
        return bool(report.get("faults", own) == own)

    def _state(self) -> dict[str, Any]:
        listener = self.listener
        return {
            "state": {
                "time_s": listener.now_s,
                "bus": self.receiver.trouble,
                "load": listener.load,
                "frames": listener.frame_count,
                "polls": listener.polls,
                "missed": sum(listener.missed.values()),
                "dropped": self.receiver.dropped,
                "rate": listener.clock.rate,
                "operator": None if self._operator is None else self._operator.report,
                "other_scenario": self._is_other_scenario(),
            },
        }
