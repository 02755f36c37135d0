"""The faults of one plant: when each of them is active, its random numbers, and the log of its changes."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from railhil.bus.injector.activities import Activities
from railhil.faults.activity import Activity
from railhil.faults.model import Fault, Random
from railhil.faults.words import CLEAR
from railhil.scenarios import streams


class Injections:
    """Faults of one plant in one run, in the order of their numbers.

    :param faults: the run's faults inside the plant, each with its number in the run's list, distributions drawn.
    :param chain: of the run's noise; empty: that of its seed.
    """

    def __init__(self, faults: Sequence[tuple[int, Fault]], seed: int, tick_ns: int, chain: streams.Chain = ()) -> None:
        self._all = Activities(faults)
        self._takers: list[Callable[[], None]] = []
        self.activities = self._all.all
        self.log = self._all.log
        self._seed = seed
        self._chain = chain
        self._tick_ns = tick_ns
        self._active: list[bool] = []
        self._acting: dict[int, bool] = {}

    def attach(self, take: Callable[[], None]) -> None:
        """Have a part of the plant take its faults from the list, now and whenever the list changes."""
        self._takers.append(take)
        take()

    def remember(self) -> None:
        """Prepare for :meth:`adopt`, before the first tick."""
        self._all.remember()

    def adopt(self, faults: Sequence[tuple[int, Fault]]) -> None:
        """Have other faults from the next tick on (:meth:`railhil.bus.injector.activities.Activities.adopt`).

        :raises InputError: a fault has begun that is not in both lists.
        """
        self._all.adopt(faults)
        self._active = [one.active for one in self.activities]
        for take in self._takers:
            take()

    def at(self, level: str, *names: str, unit: int = 0) -> list[Activity]:
        """The faults of a level, and of these places if any are named, without the words that end others.

        :param unit: only the faults of this unit of the train, from 1; 0: of any unit.
        """
        places = [(one, one.fault.place) for one in self.activities if one.fault.what != CLEAR]
        found = [one for one, place in places if place.level == level and (not names or place.name in names)]
        return [one for one in found if not unit or not one.fault.units or unit in one.fault.units]

    def samples(self, activity: Activity) -> Random:
        """The random numbers that a fault uses while it is active."""
        return streams.fault_samples(self._seed, activity.number, activity.fault.seed, self._chain)

    def look(self, tick: int, position_m: float, speed_mps: float) -> bool:
        """Find the faults that are active at a tick, by the truth at its instant; True if any began or ended."""
        self._all.look(tick * self._tick_ns, position_m, speed_mps)
        # Compared with the last tick: a fault may also have ended by its count or an order since then.
        before, self._active = self._active, [one.active for one in self.activities]
        return self._active != before

    def happened(self, event: str) -> None:
        """Take an event of the run at the present tick, in lower case; a fault that waits for it begins with the next
        tick."""
        self._all.happened((event,))

    def order(self, number: int, order: int) -> None:
        """Take an order by hand (:class:`railhil.bus.codes.FaultOrder`) for the fault of that number; numbers of faults
        elsewhere are ignored."""
        self._all.order_now(number, order)

    def hit(self, activity: Activity, before: str, after: str) -> None:
        """Note that a fault has changed one sample or command at the present tick."""
        self._all.note(activity, before, after)

    def effect(self, activity: Activity, acts: bool, before: str, after: str) -> None:
        """Note whether a lasting fault changes anything at the present tick; each beginning of a change is a hit."""
        if acts and not self._acting.get(activity.number, False):
            self.hit(activity, before, after)
        self._acting[activity.number] = acts


#: Place of the fault, level ``train``.
SAFETY_LOOP = "safety_loop"


class SafetyLoop:
    """The safety loop of a train that has no interlocks on its bus. An open loop applies the emergency brake for good.

    Closing it again does not release the brake of the run.
    """

    def __init__(self, injections: Injections) -> None:
        self._injections = injections
        #: The loop is, or has been, open.
        self.opened = False
        injections.attach(self._take)

    def _take(self) -> None:
        self._faults = self._injections.at("train", SAFETY_LOOP)

    def look(self) -> None:
        """Take the faults that have begun or ended."""
        for one in self._faults:
            self._injections.effect(one, one.active, "closed", "open")
            self.opened = self.opened or one.active
