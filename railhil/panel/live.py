"""A run while it is made, as messages for the pages: its rows, its events, the state of bus and operator."""

from __future__ import annotations

import json
import os
import time
from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from railhil.bus.frame import Frame
from railhil.cli.run_identity import RunIdentity
from railhil.dbc import house_contract
from railhil.live.bus_follower import Listener
from railhil.panel.bus_statistics import WATCHED_FRAMES, BusStatistics, FrameList
from railhil.panel.events import NO_EVENTS, LiveEvents
from railhil.panel.history import History
from railhil.panel.layout import NO_LAYOUT, Layout, Rows, make_layout
from railhil.panel.operator import Operator, list_fault_kinds
from railhil.panel.receiver import Receiver
from railhil.panel.wire import APPEND, REPLACE, encode_batch
from railhil.record.documents import read_certificate
from railhil.record.trace import FloatArray, Trace
from railhil.scenarios.model import AnyScenario, Timing
from railhil.scenarios.scenario_documents import nominal_sha256
from railhil.scenarios.system import System, UnknownScenario

if TYPE_CHECKING:
    from railhil.panel.branches import Branches
    from railhil.panel.requirements import LiveRequirements

#: Least wall time between two lists of frames for pages that have scrolled elsewhere; the others get it at every look.
LIST_S = 0.95


class LiveRun:
    """Listens to a bus and reports the news.

    It shows the run that the plant announces, and before that the scenario that the user names, if any.

    :param operator: the connection to the supervisor; None: there are no commands.
    :param requirements: judges the run by sentences; None: there are none.
    :param branches: of the folder into which the run is recorded; None: not known.
    """

    def __init__(
        self,
        watched: RunIdentity,
        receiver: Receiver,
        operator: Operator | None = None,
        requirements: LiveRequirements | None = None,
        branches: Branches | None = None,
    ) -> None:
        self._watched = watched
        self._named = watched.scenario
        # Further faults of the run make no other scenario of it.
        self._nominal = "" if operator is None or self._named is None else nominal_sha256(self._named)
        self._operator = operator
        self._requirements = requirements
        self.branches = branches
        self.receiver = receiver
        #: Name of this process's runs, for viewers that must tell them apart.
        self.session = f"{os.getpid()}-{time.time_ns()}"
        self._list_s = 0.0
        #: Folder of the run whose record was taken.
        self._ended = ""
        self._show()

    def _show(self) -> None:
        """Show the watched scenario from now on; None: only frames, because the system is unknown."""
        scenario, notes = self._watched.scenario, self._watched.notes
        system: System | None = None if scenario is None else scenario.installed_system
        self._scenario = scenario
        self.contract = contract = house_contract() if system is None else system.contract
        unknown = UnknownScenario("", "", Timing(base_tick_ns=contract.base_tick_ns))
        self.layout: Layout = NO_LAYOUT if scenario is None else make_layout(scenario, contract, notes)
        self._rows = None if scenario is None else Rows(scenario, self.layout, notes)
        self._events = None if scenario is None or system is None else self._make_events(scenario, system)
        self.heard = BusStatistics(contract)
        self.listener = Listener(scenario or unknown, contract, self.heard)
        self._list = FrameList(contract)
        if self._requirements is not None:
            self._requirements.show(scenario, notes)
        self._history = History(1 + len(self.layout.columns), self.layout.position)
        self._run = self.listener.run
        # The last row and its instant; no row while the curves have a gap.
        self._last: FloatArray | None = None
        self._last_s = -1.0
        #: Rows and telegrams of the last reading; the trace begins with the newest earlier telegram of each port.
        self.fresh_rows: FloatArray = np.empty((0, 1))
        self.fresh_trace = Trace(contract)
        self.scenario_name = "" if scenario is None else scenario.name

    def describe(self) -> dict[str, Any]:
        """The first message to a page."""
        facts = {} if self._scenario is None else {"scenario": self._scenario.name, "system": self._scenario.system}
        name = self.scenario_name or "a run that is not known yet"
        return {
            "kind": "live",
            "runs": [{"name": name, "facts": facts}],
            "layout": self.layout.as_json(),
            "commands": self._operator is not None,
            "branches": self.branches is not None,
        }

    def read_past(self) -> list[str | bytes]:
        """All data so far, for a page that has just connected."""
        messages: list[str | bytes] = [encode_batch(REPLACE, 0, self._history.rows)]
        messages.append(json.dumps(NO_EVENTS) if self._events is None else self._events.describe())
        messages += [json.dumps(self._make_state()), json.dumps(self._make_frame_list())]
        messages += [] if self._requirements is None else [self._requirements.describe()]
        return messages + ([] if self.branches is None else [self.branches.describe()])

    def look(self) -> list[str | bytes]:
        """The news of the bus."""
        self.fresh_rows = self.fresh_rows[:0]
        frames = self.receiver.look()
        messages: list[str | bytes] = []
        if self._operator is not None and self._named is not None:
            report, named = self._operator.report, self._named
            further = report.get("faults", list(named.faults)) != list(named.faults)
            self._watched.has_further_faults = further and report.get("scenario", self._nominal) == self._nominal
        if self._watched.take(frames):
            self._show()
            messages += [json.dumps({"header": self.describe()}), *self.read_past()]
        if frames or self.receiver.lacks_before or self.receiver.lacks_within:
            messages += self._take(frames)
        if self._requirements is not None:
            self._requirements.take(frames, self.receiver.lacks_before or self.receiver.lacks_within)
            messages += filter(None, [self._requirements.look()])
        messages += [] if self.branches is None else self.branches.look()
        if self._operator is not None:
            messages += [json.dumps({"answer": answer}) for answer in self._operator.look()]
            messages += self._take_end(self._operator)
        messages.append(json.dumps(self._make_state()))
        now_s = time.monotonic()
        if now_s - self._list_s >= LIST_S:
            self._list_s = now_s
            messages.append(json.dumps(self._make_frame_list()))
        return messages

    def list_frames(self) -> str:
        """See :meth:`railhil.panel.server.PageSource.list_frames`."""
        return json.dumps(self._make_frame_list())

    def execute(self, command: dict[str, Any]) -> str:
        """Pass a command to the supervisor; returns the reason if it was not passed, else empty."""
        if self.branches is not None and command.get("do") == "branch":
            return self.branches.begin(command)
        if self._operator is None:
            return "no supervisor takes commands here: start the run with railhil run --panel"
        return self._operator.execute(command)

    def list_kinds(self) -> list[dict[str, Any]]:
        """Kinds of faults that take values during the run."""
        return list_fault_kinds([] if self._operator is None else self._list_faults())

    def _make_events(self, scenario: AnyScenario, system: System) -> LiveEvents:
        return LiveEvents(scenario, system, self.layout, self._list_faults)

    def _list_faults(self) -> Sequence[str]:
        """The faults of the run, with the values that an operator has given."""
        own = () if self._scenario is None else self._scenario.faults
        return own if self._operator is None else list(self._operator.report.get("faults", own))

    def _take_end(self, operator: Operator) -> list[str | bytes]:
        """At the end of the run: its events as its record has them."""
        folder = operator.report.get("folder")
        certificate = read_certificate(Path(folder)) if folder and folder != self._ended else None
        if certificate is None or self._events is None:
            return []
        self._ended = str(folder)
        self._events.take_record(certificate.get("injected") or (), max(self._last_s, 0.0))
        return [self._events.describe()]

    @property
    def report(self) -> Path | None:
        """The report of the run that has ended; None: there is none."""
        found = "" if self._operator is None else self._operator.report.get("report")
        return Path(found) if found else None

    def watch(self, can_ids: set[int]) -> None:
        """Keep raw frames of these identifiers."""
        kept = self.heard.watched
        self.heard.watched = {one: kept.get(one, deque(maxlen=WATCHED_FRAMES)) for one in can_ids}

    def _take(self, frames: list[Frame]) -> list[str | bytes]:
        listener, receiver, messages = self.listener, self.receiver, list[str | bytes]()
        if receiver.lacks_before or receiver.lacks_within:
            listener.note_loss()
        listener.take(frames)
        if receiver.lacks_within:
            listener.note_loss()
        if self._events is not None and (receiver.lacks_before or receiver.lacks_within):
            self._events.lose()
        if listener.run != self._run:
            if self._operator is not None:
                self._operator.forget_end()
            self._run, self._last_s, self._last = listener.run, -1.0, None
            self._history.clear()
            messages.append(encode_batch(REPLACE, 0, self._history.rows))
            if self._events is not None:
                self._events.restart()
            messages.append(json.dumps(NO_EVENTS))
        trace, now_s = self.heard.next_trace(), listener.now_s
        if self._rows is None or self._events is None:
            return messages
        if now_s is None:
            return messages + self._end_curves(self._rows)
        rows = self._rows.make(trace, self._last_s, now_s)
        self.fresh_rows, self.fresh_trace = rows, trace
        if len(rows):
            drawn = self._rows.insert_gaps(rows, self._last)
            self._last, self._last_s = rows[-1], float(rows[-1, 0])
            messages.append(self._draw(drawn))
        if self._rows.is_over(self._last_s, now_s):
            messages += self._end_curves(self._rows)
        return messages + [one for one in (self._events.find(trace, now_s),) if one]

    def _end_curves(self, rows: Rows) -> list[str | bytes]:
        """A value that is no longer received must not look constant."""
        last, self._last = self._last, None
        return [] if last is None else [self._draw(rows.gap_after(last[None]))]

    def _draw(self, rows: FloatArray) -> bytes:
        self._history.add(rows)
        return encode_batch(APPEND, 0, rows)

    def _list_notices(self) -> list[str]:
        """Warnings that the page must show large."""
        found = [self._watched.warning]
        if dropped := self.receiver.dropped:
            found.append(f"{dropped} FRAMES DROPPED HERE: the gaps in the curves are not of the run")
        if self.heard.frame_count and not self.listener.knows_time:
            found.append("the time is not known yet: nothing is drawn before TIME_SYNC has told it")
        return [one for one in found if one]

    def _make_frame_list(self) -> dict[str, Any]:
        return {"frames": self._list.list_rows(self.listener, self.heard), "raw": self._list.list_watched(self.heard)}

    def _make_state(self) -> dict[str, Any]:
        listener, heard = self.listener, self.heard
        return {
            "state": {
                "time_s": listener.now_s,
                "run": self._watched.run,
                "notices": self._list_notices(),
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
