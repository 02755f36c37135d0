"""A track side and a train for the station automaton: telegrams that fit each other, a tick at a time."""

from __future__ import annotations

from functools import lru_cache
from typing import cast

from railhil.bus.layout import flag
from railhil.controller_node.line.rules import ServedStop, StationRules
from railhil.controller_node.line.stations import Situation, Stations
from railhil.scenarios.load import load_any
from railhil.systems.line.scenario.model import LineScenario
from railhil.wire.line import DoorOrder, DoorSide, DoorStat, DoorState, StnInfo

TICK_MS, PERIOD_MS = 20, 500
OPENS = {DoorOrder.OPEN_LEFT: DoorSide.LEFT, DoorOrder.OPEN_RIGHT: DoorSide.RIGHT, DoorOrder.OPEN_BOTH: DoorSide.BOTH}


@lru_cache
def four_stops() -> LineScenario:
    return cast("LineScenario", load_any("four_stops"))


def three_stops() -> StationRules:
    """A departure at 30 s, a stop at 1 km and the terminal at 2 km."""
    stops = (
        ServedStop(1, 0, DoorSide.LEFT, False, False, 20_000, 30_000),
        ServedStop(3, 10_000_000, DoorSide.LEFT, False, False, 20_000, 160_000),
        ServedStop(4, 20_000_000, DoorSide.RIGHT, True, False, 20_000, 0),
    )
    return StationRules(stops, 5000, 50_000, 1_180_000, 2, 2500, 3000, 2000, 3)


class World:
    """What the automaton sees, and what it orders.

    The test sets the public attributes; :meth:`run` steps the automaton, with a telegram of each kind in each tick.
    """

    def __init__(self, rules: StationRules | None = None) -> None:
        self.rules = rules or three_stops()
        self.stations = Stations(self.rules)
        self.now_ms = 0
        self.speed_01mmps = 0
        self.place_01mm = 0
        self.here = 1
        self.side = DoorSide.LEFT
        self.in_window = True
        self.door = DoorState.LOCKED
        self.permit, self.is_sound = True, True
        self.dwell_left_ds = 0
        self.reopened = 0
        self.signal = self.mode = 0
        self.tells_doors = self.tells_info = True
        self._life = 0

    @property
    def due_ds(self) -> int:
        return next((stop.depart_ms // 100 for stop in self.rules.stops if stop.number == self.here), 0)

    def tick(self) -> None:
        self._life = (self._life + 1) & 0xF
        locked, side = flag(self.door is DoorState.LOCKED), self.side
        if self.tells_doors:
            self.stations.take_doors(
                DoorStat(
                    left_state=self.door if side in (DoorSide.LEFT, DoorSide.BOTH) else 0,
                    right_state=self.door if side in (DoorSide.RIGHT, DoorSide.BOTH) else 0,
                    doors_locked=locked,
                    psd_locked=locked,
                    in_window=flag(self.in_window),
                    dwell_left_ds=self.dwell_left_ds,
                    reopened=self.reopened,
                    life=self._life,
                ),
                self.now_ms,
            )
        if self.tells_info:
            self.stations.take_info(
                StnInfo(
                    station_here=self.here,
                    depart_permit=flag(self.permit),
                    platform_side=side,
                    due_departure_ds=self.due_ds,
                    signal_next=self.signal,
                    mode_order=self.mode,
                    life=self._life,
                ),
                self.now_ms,
            )
        begins = self.now_ms % PERIOD_MS == 0
        self.stations.step(
            Situation(self.now_ms, self.now_ms, self.speed_01mmps, self.place_01mm, begins, self.is_sound)
        )
        self.now_ms += TICK_MS

    def run(self, time_ms: int) -> None:
        for _ in range(time_ms // TICK_MS):
            self.tick()

    def leave(self) -> None:
        """Depart from the first stop and drive."""
        self.run(30_500)
        self.here, self.speed_01mmps = 0, 100_000
        self.run(1000)

    def stand_at(self, place_01mm: int, here: int = 3) -> None:
        """Come to rest on the way to the second stop."""
        self.place_01mm, self.speed_01mmps, self.here = place_01mm, 0, here
