"""Orders and faults of a live run as events: from SUP_CMD and the truth as they are on the bus, and from the run's list
of faults."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from railhil.bus.codes import Event, FaultOrder, SupCommand
from railhil.bus.telegrams import RunEvent, SupCmd
from railhil.judge.events.event import FAULT
from railhil.record.trace import Trace
from railhil.scenarios.system import System

if TYPE_CHECKING:
    from railhil.bus.injector.activities import Activities
    from railhil.faults.activity import Activity

#: Kind of the event of an order.
ORDER = "order"
_MANUAL = " @manual"


class LiveOrders:
    """Finds what was ordered, and which faults act.

    A fault begins and ends as at the nodes (:class:`railhil.faults.activity.Activity`), which decide by the same truth;
    here by its telegrams: where nothing tells the instant, up to one of their periods later. Only the record of the run
    tells when a fault with the number of a telegram begins, and when one with a count ends.

    :param faults: gives the faults of the run, as texts.
    :param add: takes an event (:meth:`railhil.panel.live.LiveEvents.add`).
    """

    def __init__(self, faults: Callable[[], Sequence[str]], add: Callable[..., dict[str, Any]], system: System) -> None:
        self._faults, self._add = faults, add
        self._truth, self._own_events = system.truth, {number: name for name, number in system.events.items()}
        self.restart()

    def restart(self) -> None:
        """Another run begins."""
        self._last: tuple[float, int] | None = None
        self._command = int(SupCommand.START)
        self._texts: list[str] = []
        self._activities: Activities | None = None
        #: The events of the faults that act, by number.
        self._acting: dict[int, dict[str, Any]] = {}
        self._shown: set[int] = set()
        #: Numbers of faults that are injected by hand and were not yet.
        self._by_hand: set[int] = set()
        self._truth_ns, self._event_number = -1, 0
        self._levels: dict[str, int] = {}
        #: Events since the last telegram of the truth.
        self._happened: list[str] = []
        #: Whether earlier events have changed.
        self.has_changed = False

    def find(self, trace: Trace) -> list[dict[str, Any]]:
        """The news in the telegrams of a trace that begins with the newest ones before."""
        self.has_changed = False
        self._know_faults()
        signals: dict[str, tuple[str, ...]] = {SupCmd.PORT: ("SupLife", "SupCommand", "FaultOrder", "FaultNumber")}
        truth, activities = self._truth, self._activities
        if truth is not None and activities is not None:
            motion = (truth.position, truth.speed, truth.acceleration, truth.traction)
            signals |= {RunEvent.PORT: ("EventNumber", "RunEvent"), truth.port: motion}
            signals |= {port: (level,) for port, level in truth.levels.items()}
        found = []
        for _, port, time_ns, values in sorted(one for of in signals.items() for one in _read(trace, *of)):
            if port == SupCmd.PORT:
                found += self._take(time_ns, *map(int, values))
            elif port == RunEvent.PORT:
                self._take_milestone(*map(int, values))
            elif truth is not None and port == truth.port:
                found += self._take_truth(time_ns, *values)
            elif values[0] != self._levels.get(port, 0):
                self._levels[port] = int(values[0])
                self._happened.append(trace.word(port, signals[port][0], int(values[0])))
        return found

    def lose(self) -> None:
        """Telegrams are missing: the end of a fault may be among them."""
        for number in list(self._acting):
            self._end(number, None)

    def _know_faults(self) -> None:
        """Take the run's list; before its start it grows, and later an operator changes values only."""
        texts = list(self._faults())
        if len(texts) <= len(self._texts):
            return
        # A run without faults does not load their language.
        from railhil.bus.injector.activities import Activities
        from railhil.faults.activity import MotionEvents
        from railhil.faults.language import parse

        self._texts, faults = texts, [parse(text) for text in texts]
        self._activities, self._motion = Activities(enumerate(faults, start=1)), MotionEvents()
        self._by_hand = {number for number, one in enumerate(faults, start=1) if one.trigger.kind == "manual"}

    def _take(self, time_ns: int, life: int, command: int, order: int, number: int) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = []
        time_s = time_ns / 1e9
        if (time_s, life) == self._last:
            return found
        self._last = time_s, life
        # After a stop nothing is ordered any more.
        if command != self._command != SupCommand.STOP:
            words: dict[int, str] = {SupCommand.NONE: "pause", SupCommand.START: "start again", SupCommand.STOP: "stop"}
            found.append(self._add(time_s, ORDER, "operator", words.get(command, f"command {command}")))
            self._command = command
        if order == FaultOrder.CLEAR:
            found.append(self._add(time_s, ORDER, "operator", f"cleared {self._describe(number)}"))
        if order in (FaultOrder.INJECT, FaultOrder.CLEAR) and self._activities is not None:
            self._by_hand.discard(number)
            self._activities.order([(number, order)])
        return found

    def _take_milestone(self, number: int, code: int) -> None:
        if number > self._event_number:
            self._event_number = number
            known = code in Event._value2member_map_
            self._happened.append(Event(code).name.lower() if known else self._own_events.get(code, ""))

    def _take_truth(
        self, time_ns: int, position_m: float, speed_mps: float, accel_mps2: float, traction_n: float
    ) -> list[dict[str, Any]]:
        activities, happened = self._activities, self._happened
        if activities is None or time_ns <= self._truth_ns:
            return []
        self._truth_ns, self._happened = time_ns, []
        activities.happened((*happened, *self._motion.seen(speed_mps, accel_mps2, traction_n)))
        if len(self._by_hand) == len(activities.all):
            return []
        for one in activities.all:
            if one.fault.trigger.kind == "time" and one.begun_ns is None:
                due_s = float(one.fault.trigger.value) + one.fault.trigger.delay_s
                one.look(min(round(due_s * 1e9), time_ns), position_m, speed_mps)
        activities.look(time_ns, position_m, speed_mps)
        for number in list(self._acting):
            if (ended_ns := activities.all[number - 1].ended_ns) is not None:
                self._end(number, ended_ns / 1e9)
        begun = [one for one in activities.all if one.begun_ns is not None and one.number not in self._shown]
        return [self._begin(one) for one in begun]

    def _describe(self, number: int) -> str:
        faults = self._faults()
        text = faults[number - 1] if 1 <= number <= len(faults) else "not known here"
        return f"fault {number}: {text.partition(' combine')[0].replace(_MANUAL, '')}"

    def _begin(self, one: Activity) -> dict[str, Any]:
        self._shown.add(one.number)
        text = self._texts[one.number - 1]
        event = self._add((one.begun_ns or 0) / 1e9, FAULT, text.partition(" ")[0], self._describe(one.number))
        if one.active and one.fault.count is None:
            event["is_open"] = True
            self._acting[one.number] = event
        return event

    def _end(self, number: int, end_s: float | None) -> None:
        event = self._acting.pop(number)
        event |= {"until_s": end_s, "is_open": False}
        self.has_changed = True


def _read(trace: Trace, port: str, names: Sequence[str]) -> Iterator[tuple[int, str, int, tuple[float, ...]]]:
    """The telegrams of a port: place in the record, port, time in ns, values of the named signals (empty: 0)."""
    columns = [trace.values(port, name).tolist() if name else [0.0] * trace.count(port) for name in names]
    times_ns = trace.times_ns(port).tolist()
    for order, time_ns, *values in zip(trace.order(port).tolist(), times_ns, *columns, strict=True):
        yield order, port, time_ns, tuple(values)
