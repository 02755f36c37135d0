"""Commands of SUP_CMD besides "start": ordered by a person at the panel or by the run's own list.

In lockstep a pause is a SUP_CMD with command "none": the plant then stands still and polls SUP_CMD again until it says
"start". Simulation time does not depend on the wall clock there, so a slower pace is an answer that is sent later.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, Protocol

from railhil.bus.codes import FaultOrder, SupCommand
from railhil.record.prepared_faults import GivenValues, prepared_for
from railhil.scenarios.operator_commands import OperatorCommand, parse_commands

#: Wall time for which an answer is held back during a pause; each of them is in the record.
PAUSE_S = 1.0
#: Wall time between two reports to the panel.
_TELL_S = 0.1
#: Wall time between two measurements of the lateness.
_LATENESS_S = 1.0
#: Longest wait without a check for signals.
_LOOK_S = 0.05
#: Paces that can be asked for, simulated seconds per second; 0: as fast as possible.
PACE_MIN, PACE_MAX = 0.1, 1000.0
#: Longest duration of a fault that can be asked for; a fault without duration lasts until it is cleared.
DURATION_MAX_S = 86_400.0
_FAULT_ORDERS = {"inject": FaultOrder.INJECT, "clear": FaultOrder.CLEAR, "value": FaultOrder.VALUE}
REALTIME_PACE = "a run in real time has its pace from its start on"
REALTIME_PAUSE = "in real time nothing can stand still: pause a run in lockstep"


def check_pace(pace: object) -> str:
    """Reason why something is no pace; empty: it is one."""
    if isinstance(pace, (int, float)) and (pace == 0 or PACE_MIN <= pace <= PACE_MAX):
        return ""
    return f"pace: found {pace}, allowed 0 (as fast as possible) or {PACE_MIN:g} to {PACE_MAX:g}"


def _duration_s(faults: Sequence[str], number: int) -> float | None:
    """The duration in the text of a fault, in s; None: it has none."""
    if not 1 <= number <= len(faults) or " for " not in faults[number - 1]:
        return None
    # The language is loaded only when it is used.
    from railhil.faults.language import parse

    return parse(faults[number - 1]).duration_s


class Panel(Protocol):
    """The connection to a panel."""

    def take(self, timeout_s: float) -> list[dict[str, Any]]:
        """Commands that have arrived, after at most this time."""

    def tell(self, report: dict[str, Any]) -> None:
        """Report to the panel."""


class OperatorCommands:
    """Orders of one run.

    :param planned: orders that are sent again, as in a certificate.
    :param panel: a person gives orders there; None: there is no panel. :param lockstep: time can stand still.
    :param faults: of the run, as texts. :param pace: simulated seconds per second, 0: as fast as possible.
    """

    def __init__(
        self,
        planned: Sequence[str],
        panel: Panel | None,
        lockstep: bool,
        faults: Sequence[str] = (),
        pace: float = 0.0,
    ) -> None:
        self._planned = parse_commands(planned)
        self._panel = panel
        self._lockstep = lockstep
        self._faults = list(faults)
        self._waiting: deque[tuple[str, int]] = deque()
        self._given = GivenValues()
        #: Durations asked for, by the number of a fault; then the simulation times at which it is cleared.
        self._lasts_s: dict[int, float] = {}
        self._ends_s: dict[int, float] = {}
        #: Simulation times at which the nodes end a fault by themselves.
        self._own_ends_s: dict[int, float] = {}
        #: Numbers of faults that were injected, and of the faults that can still be cleared.
        self._injected: set[int] = set()
        self._active: set[int] = set()
        self._paused = False
        #: Nothing is ordered after Stop: the plant ends with it.
        self._stopped = False
        #: From which instants the pace counts; None: from the first SUP_CMD.
        self._pace = pace
        self._pace_from: tuple[float, float] | None = None
        self._told_s = 0.0
        #: All orders, as texts.
        self.sent: list[str] = []
        #: Lateness of a real-time run (:class:`railhil.live.live_values.LiveLateness`); None: not measured.
        self.lateness: Callable[[], dict[str, Any] | None] = lambda: None
        self._lateness_s = 0.0
        self._late: dict[str, Any] | None = None
        #: Called while it waits; an exception from it ends the wait.
        self.while_waiting: Callable[[], None] = lambda: None

    def answer(self, number: int, sim_time_s: float) -> tuple[SupCommand, int, FaultOrder]:
        """Content of the SUP_CMD of this number: command, number of a fault or octet, and the order.

        :param sim_time_s: the present simulation time.
        """
        if self._panel is not None:
            self._serve(self._panel, sim_time_s)
            self._end_faults(sim_time_s)
        order = None if self._stopped else self._planned.get(number) or self._next(number)
        if order is None:
            return SupCommand.START, 0, FaultOrder.NONE
        self.sent.append(order.text)
        if order.word == "stop":
            self._stopped = True
            return SupCommand.STOP, 0, FaultOrder.NONE
        if order.word == "pause":
            return SupCommand.NONE, 0, FaultOrder.NONE
        if order.word == "inject":
            # A fault injected by the run's own list can also be cleared on the page.
            self._injected.add(order.number)
            self._active.add(order.number)
            if order.number in self._lasts_s:
                self._ends_s[order.number] = sim_time_s + self._lasts_s.pop(order.number)
            if self._panel is not None and (own_s := _duration_s(self._faults, order.number)) is not None:
                self._own_ends_s[order.number] = sim_time_s + own_s
        return SupCommand.START, order.number, _FAULT_ORDERS[order.word]

    def _next(self, number: int) -> OperatorCommand | None:
        if self._waiting:
            word, fault = self._waiting.popleft()
            self._given.interrupted()
            return OperatorCommand(number, word, fault)
        return OperatorCommand(number, "pause") if self._paused else self._given.next(number)

    def _end_faults(self, sim_time_s: float) -> None:
        """Clear the faults whose duration is over: with the first SUP_CMD at or after its end."""
        for number in [one for one, end_s in self._own_ends_s.items() if sim_time_s >= end_s]:
            del self._own_ends_s[number]
            self._active.discard(number)
        for number in [one for one, end_s in self._ends_s.items() if sim_time_s >= end_s]:
            del self._ends_s[number]
            if number in self._active:
                self._clear(number)

    def _clear(self, number: int) -> None:
        self._active.discard(number)
        self._given.drop(number)
        self._waiting.append(("clear", number))

    def _serve(self, panel: Panel, sim_time_s: float) -> None:
        """Take the panel's commands; hold the answer back for a pause or a slower pace."""
        was_paused = self._paused
        self._take(panel, sim_time_s, 0.0)
        now_s = time.monotonic()
        # The first "none" of a pause is sent at once.
        held_s = now_s + PAUSE_S * was_paused if self._paused else self._due_s(sim_time_s)
        self._report(panel, sim_time_s, now_s)
        while (rest_s := held_s - time.monotonic()) > 0 and not self._waiting:
            was = (self._paused, self._pace)
            self._take(panel, sim_time_s, min(rest_s, _LOOK_S))
            self.while_waiting()
            self._report(panel, sim_time_s, time.monotonic())
            if (self._paused, self._pace) != was:
                # The end of a pause, or another pace, holds at once.
                held_s = time.monotonic() if self._paused or was[0] else self._due_s(sim_time_s)

    def _due_s(self, sim_time_s: float) -> float:
        if not self._pace:
            return 0.0
        if self._pace_from is None:
            self._pace_from = sim_time_s, time.monotonic()
        from_sim_s, from_wall_s = self._pace_from
        return from_wall_s + (sim_time_s - from_sim_s) / self._pace

    def _take(self, panel: Panel, sim_time_s: float, timeout_s: float) -> None:
        for command in panel.take(timeout_s):
            why = self._obey(command, sim_time_s)
            panel.tell({"answer": command.get("id"), "refused": why})

    def _obey(self, command: dict[str, Any], sim_time_s: float) -> str:
        """Carry out one command; returns the reason if it is refused."""
        if self._stopped or ("stop", 0) in self._waiting:
            return "the run has been stopped"
        what, number, pace = command.get("do"), command.get("fault"), command.get("pace")
        if what in ("inject", "clear"):
            if not isinstance(number, int) or not 1 <= number <= len(self._faults):
                return f"the run has no fault {number}"
            if "manual" not in self._faults[number - 1]:
                return f"fault {number} is not triggered by hand (@manual)"
            if what == "inject":
                return self._inject(number, b"", command.get("for_s"))
            if number not in self._active:
                return f"fault {number} is {'over' if number in self._injected else 'not injected'}"
            self._clear(number)
            return ""
        if what == "fault":
            return self._inject_text(str(command.get("text", "")))
        if what == "stop":
            # Faults that were to be cleared later end with the run.
            self._ends_s.clear()
            self._waiting.append(("stop", 0))
            self._paused = False
            return ""
        if what in ("pause", "start"):
            if not self._lockstep:
                return REALTIME_PAUSE if what == "pause" else "it is running"
            self._paused = what == "pause"
            self._pace_from = sim_time_s, time.monotonic()
            return ""
        if what == "pace":
            if not self._lockstep:
                return REALTIME_PACE
            if why := check_pace(pace):
                return why
            self._pace, self._pace_from = float(pace or 0), (sim_time_s, time.monotonic())
            return ""
        return f"no such command: {what}"

    def _inject(self, number: int, octets: bytes, for_s: object) -> str:
        """Inject a fault of the run with these values, for a duration if one is given; returns the reason if it is
        refused."""
        if number in self._injected:
            return f"fault {number} has been injected: a fault is injected once"
        if for_s is not None:
            if isinstance(for_s, bool) or not isinstance(for_s, (int, float)) or not 0 < for_s <= DURATION_MAX_S:
                return f"duration: found {for_s}, allowed above 0 s to {DURATION_MAX_S:g} s"
            self._lasts_s[number] = float(for_s)
        self._injected.add(number)
        self._active.add(number)
        if octets:
            self._given.add(number, octets)
        else:
            self._waiting.append(("inject", number))
        return ""

    def _inject_text(self, text: str) -> str:
        """Inject the prepared fault of a text (``TRN_SPEED loss 5% for 3s``) now; returns the reason if it is
        refused."""
        found = prepared_for(text, self._faults, self._injected)
        if isinstance(found, str):
            return found
        number, octets, duration_s, made = found
        if not (why := self._inject(number, octets, duration_s)):
            self._faults[number - 1] = made
        return why

    def _report(self, panel: Panel, sim_time_s: float, now_s: float) -> None:
        if now_s - self._told_s < _TELL_S:
            return
        self._told_s = now_s
        if now_s - self._lateness_s >= _LATENESS_S:
            self._lateness_s, self._late = now_s, self.lateness()
        panel.tell(
            {
                "phase": "paused" if self._paused else "running",
                "time_s": sim_time_s,
                "pace": self._pace,
                "lockstep": self._lockstep,
                "lateness": self._late,
                "faults": self._faults,
                "injected": sorted(self._injected),
                "active": sorted(self._active),
                "sending": self._given.faults,
                # Where both are known the earlier one holds.
                "ends_s": {
                    one: min(ends[one] for ends in (self._ends_s, self._own_ends_s) if one in ends)
                    for one in self._active & {*self._ends_s, *self._own_ends_s}
                },
                "orders": len(self.sent),
            }
        )
