"""Orders and faults of a live run as events: from SUP_CMD as it is on the bus, and from the run's list of faults."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

from railhil.bus.codes import FaultOrder, SupCommand
from railhil.bus.telegrams import SupCmd
from railhil.judge.events.event import FAULT
from railhil.record.trace import Trace

#: Kind of the event of an order.
ORDER = "order"
_MANUAL = " @manual"


class LiveOrders:
    """Finds what was ordered, and which faults act.

    A fault that is injected by hand acts from the instant after its SUP_CMD on, one with an instant from there on,
    until its duration is over or it is cleared. Of a fault with another condition, or with a count, only the record of
    the run tells when it acts.

    :param faults: gives the faults of the run, as texts.
    :param add: takes an event (:meth:`railhil.panel.live.LiveEvents.add`).
    :param tick_s: from one instant to the next.
    """

    def __init__(self, faults: Callable[[], Sequence[str]], add: Callable[..., dict[str, Any]], tick_s: float) -> None:
        self._faults, self._add, self._tick_s = faults, add, tick_s
        self.restart()

    def restart(self) -> None:
        """Another run begins."""
        self._last: tuple[float, int] | None = None
        self._command = int(SupCommand.START)
        #: The events of the faults that act, by number, and the instants at which they end by themselves.
        self._acting: dict[int, tuple[dict[str, Any], float]] = {}
        #: Faults with an instant that has not come: number, begin and end.
        self._timed: list[tuple[int, float, float]] | None = None
        #: Whether earlier events have changed.
        self.has_changed = False

    def find(self, trace: Trace, now_s: float) -> list[dict[str, Any]]:
        """The news until an instant, in the telegrams of a trace that begins with the newest ones before."""
        self.has_changed = False
        found = []
        names = ("SupLife", "SupCommand", "FaultOrder", "FaultNumber")
        columns = [trace.raw(SupCmd.PORT, name).tolist() for name in names]
        for time_s, life, command, order, number in zip(trace.times_s(SupCmd.PORT).tolist(), *columns, strict=True):
            if (time_s, life) != self._last:
                self._last = time_s, life
                found += self._take(time_s, command, order, number)
        found += self._begin_timed(now_s)
        for number, (_, end_s) in list(self._acting.items()):
            if end_s <= now_s:
                self._end(number, end_s)
        return found

    def lose(self) -> None:
        """Telegrams are missing: the end of a fault may be among them."""
        for number in list(self._acting):
            self._end(number, None)

    def _take(self, time_s: float, command: int, order: int, number: int) -> list[dict[str, Any]]:
        found = []
        # After a stop nothing is ordered any more.
        if command != self._command != SupCommand.STOP:
            words: dict[int, str] = {SupCommand.NONE: "pause", SupCommand.START: "start again", SupCommand.STOP: "stop"}
            found.append(self._add(time_s, ORDER, "operator", words.get(command, f"command {command}")))
            self._command = command
        if order == FaultOrder.INJECT:
            found.append(self._begin(number, time_s + self._tick_s, None))
        elif order == FaultOrder.CLEAR:
            found.append(self._add(time_s, ORDER, "operator", f"cleared {self._describe(number)}"))
            self._end(number, time_s + self._tick_s)
        return found

    def _describe(self, number: int) -> str:
        faults = self._faults()
        text = faults[number - 1] if 1 <= number <= len(faults) else "not known here"
        return f"fault {number}: {text.partition(' combine')[0].replace(_MANUAL, '')}"

    def _begin(self, number: int, time_s: float, end_s: float | None) -> dict[str, Any]:
        faults = self._faults()
        text = faults[number - 1] if 1 <= number <= len(faults) else ""
        event = self._add(time_s, FAULT, text.partition(" ")[0] or "fault", self._describe(number))
        if end_s is None:
            end_s = time_s + _lasts_s(text)
        if end_s > time_s:
            event["is_open"] = True
            self._acting[number] = event, end_s
        return event

    def _end(self, number: int, end_s: float | None) -> None:
        if number in self._acting:
            event, _ = self._acting.pop(number)
            event |= {"until_s": end_s, "is_open": False}
            self.has_changed = True

    def _begin_timed(self, now_s: float) -> list[dict[str, Any]]:
        if self._timed is None:
            self._timed = [
                (number, begin_s, begin_s + _lasts_s(text))
                for number, text in enumerate(self._faults(), start=1)
                if (begin_s := _begins_s(text)) is not None
            ]
        due = [one for one in self._timed if one[1] <= now_s]
        self._timed = [one for one in self._timed if one[1] > now_s]
        return [self._begin(*one) for one in due]


def _begins_s(text: str) -> float | None:
    """The instant at which a fault begins, in s; None: something else makes it begin."""
    if _MANUAL in text:
        return None
    # A run without faults does not load their language.
    from railhil.faults.language import parse

    trigger = parse(text).trigger
    return float(trigger.value) if trigger.kind == "time" and isinstance(trigger.value, int | float) else None


def _lasts_s(text: str) -> float:
    """How long a fault acts unless it is cleared, in s; 0: it is not known."""
    if not text:
        return 0.0
    from railhil.faults.language import parse

    fault = parse(text)
    if fault.count is not None or fault.until:
        return 0.0
    return inf if fault.duration_s is None else fault.duration_s
