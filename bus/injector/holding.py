"""Faults that lose, delay, repeat or reorder telegrams, and the later sending of the telegrams held back.

A published telegram is sent later by itself. A polled telegram can only take the place of a later answer: a poll on
this bus has one answer, so each telegram sent late means that a fresh one is lost.
"""

from __future__ import annotations

from railhil.bus.injector.telegram_frames import Telegram
from railhil.faults.activity import Activity
from railhil.faults.model import Random

#: Words of :class:`Holding`.
HOLDING = ("loss", "delay", "duplicate", "reorder", "slow")
LOST, LATER, AGAIN = "lost", "later", "again"


class Holding:
    """One fault of this kind at one port.

    :param polled: whether the telegram is an answer to a poll.
    """

    def __init__(self, activity: Activity, random: Random, polled: bool) -> None:
        self._activity = activity
        self._random = random
        self._polled = polled
        self._in_burst = False
        # Telegrams held back: instant from which each may leave, telegrams of the port that must pass before, telegram.
        self._held: list[tuple[int, int, Telegram]] = []

    def take(self, frames: Telegram, now_ns: int) -> tuple[list[Telegram], str]:
        """Take the port's next telegram; returns the telegrams that leave now, and the change to it (empty: none)."""
        fault, active = self._activity.fault, self._activity.active
        if not active and fault.after == "drop":
            self._held = []
        ready = any(due_ns <= now_ns and after == 0 for due_ns, after, _ in self._held)
        leaving, said = [frames], ""
        if self._polled and (self._held and not active if fault.what in ("delay", "slow") else ready):
            # A telegram held back takes the place of the fresh answer.
            leaving, said = [], LOST
        elif active:
            leaving, said = self._acted(frames, now_ns)
        self._held = [(due_ns, max(0, after - 1), held) for due_ns, after, held in self._held]
        if self._polled and not leaving:
            leaving = self.due(now_ns)[:1]
        elif not self._polled:
            leaving += self.due(now_ns)
        return leaving, said

    def due(self, now_ns: int) -> list[Telegram]:
        """The telegrams that may leave now, in the order of their instants; of an answer only the first."""
        if not self._activity.active and self._activity.fault.after == "drop":
            self._held = []
        held = self._held
        ready = [place for place, (due_ns, after, _) in enumerate(held) if due_ns <= now_ns and after == 0]
        ready.sort(key=lambda place: held[place][0])
        ready = ready[:1] if self._polled else ready
        self._held = [one for place, one in enumerate(held) if place not in ready]
        return [held[place][2] for place in ready]

    @property
    def waits(self) -> bool:
        """Whether telegrams are held back."""
        return bool(self._held)

    def end_process(self) -> None:
        """The process that has made the telegrams has ended: those that it would still have sent itself are gone."""
        if self._activity.fault.what == "slow":
            self._held = []

    def _acted(self, frames: Telegram, now_ns: int) -> tuple[list[Telegram], str]:
        fault, random = self._activity.fault, self._random
        match fault.what:
            case "loss":
                return ([], LOST) if self._loses() else ([frames], "")
            case "delay" | "slow":
                jitter_s = fault.parameter("jitter_s") * (2.0 * random.random() - 1.0) if fault.what == "delay" else 0.0
                delay_ns = round((fault.parameter("delay_s") + jitter_s) * 1e9)
                if delay_ns <= 0 and not self._held:
                    return [frames], ""
                self._held.append((now_ns + max(delay_ns, 0), 0, frames))
                return [], LATER
            case "duplicate":
                if random.random() >= fault.parameter("share"):
                    return [frames], ""
                copies = [frames] * int(fault.parameter("copies"))
                if not self._polled:
                    return [frames, *copies], AGAIN
                self._held += [(now_ns, 0, copy) for copy in copies]
                return [frames], AGAIN
        # The next telegrams overtake this one.
        if random.random() >= fault.parameter("share") or (self._polled and self._held):
            return [frames], ""
        # Itself counts as one.
        self._held.append((now_ns, int(fault.parameter("gap")) + 1, frames))
        return [], LATER

    def _loses(self) -> bool:
        """Gilbert-Elliott: within a burst a share is lost; without its parameters everything is one burst."""
        fault, change, loses = self._activity.fault, self._random.random(), self._random.random()
        enter, leave = fault.parameter("enter"), fault.parameter("leave")
        if enter > 0.0:
            self._in_burst = change >= leave if self._in_burst else change < enter
            if not self._in_burst:
                return False
        return loses < fault.parameter("share")


class Silence:
    """Nothing leaves while the bus is off, down or full: frames are lost or wait for the end.

    ``full`` keeps only the newest telegram of each port: nothing stale is sent afterwards.
    """

    def __init__(self, activity: Activity, polled: bool) -> None:
        self._activity = activity
        self._polled = polled
        self._held: list[Telegram] = []

    def take(self, frames: Telegram, now_ns: int) -> tuple[list[Telegram], str]:
        """See :meth:`Holding.take`."""
        fault = self._activity.fault
        if not self._activity.active:
            if self._polled and self._held:
                return [self._held.pop(0)], LOST
            return [frames], ""
        if fault.what == "full":
            self._held = [frames]
            return [], LATER
        if fault.after == "deliver":
            self._held.append(frames)
            return [], LATER
        return [], LOST

    def due(self, now_ns: int) -> list[Telegram]:
        """See :meth:`Holding.due`."""
        if self._activity.active:
            return []
        ready, self._held = (self._held[:1], self._held[1:]) if self._polled else (self._held, [])
        return ready

    @property
    def waits(self) -> bool:
        """See :attr:`Holding.waits`."""
        return bool(self._held)

    def end_process(self) -> None:
        """See :meth:`Holding.end_process`: the telegrams wait in the bus, and stay."""
