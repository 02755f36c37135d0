"""The station automaton of the controller: standstill, doors, dwell and departure, on whole numbers and without a law.

::

    RUN -standstill-> inside the window: HOLD -> UNLOCK -> OPENING -> OPEN -> WARN -> CLOSING -> READY -departure-> RUN
                      short, in reach:   JOG -> judged again          CLOSING -obstacle-> REOPEN -> CLOSING
                      beyond, or tried:  MISSED -10 s-> READY         UNLOCK -wrong side-> WRONG_SIDE -10 s-> READY
                      shorter:           halted; MISSED if the track side takes it for the stop, else the law drives on

Doors are ordered only if the train stands, its own estimate and the docking loop say that it is inside the window, and
the track side names this stop and the side that the timetable has. With STN_INFO or DOOR_STAT older than
``AGE_MAX_MS`` (:mod:`.station_telegrams`) nothing is ordered at a stop; in motion they do not matter.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import IntEnum
from typing import Final, NamedTuple

from railhil.bus.layout import FLAG_TRUE
from railhil.controller_node.line.rules import ServedStop, StationRules
from railhil.controller_node.line.station_telegrams import AGE_MAX_MS, StationTelegrams
from railhil.wire.line import AtoState, DoorOrder, DoorSide, DoorState, ModeOrder, SignalAspect

#: Time at speed 0 after which the train stands, and after which the holding brake is applied.
STANDING_MS, HOLDING_MS = 200, 300
#: Time for which the train waits for the docking loop before it jogs, and at a stop that it cannot serve.
DOCKING_MS, MISSED_MS = 2000, 10_000
#: Time in which a departure is accepted, and in which a jog moves.
ACCEPT_MS, JOG_MS = 1500, 20_000
#: A halt that lasts this long ends with a new curve to the stop.
HALT_MS: Final = 2000
#: The doors close this long before the departure, in addition to their own time: platform doors, telegrams (chosen).
CLOSE_SPARE_MS: Final = 500
#: Time from the end of a closing to its telegram, about.
LOCK_TOLD_MS: Final = 150
#: Above this speed the train has left (0.1 mm/s).
LEFT_01MMPS: Final = 5000
#: Difference of a time on the wire and that of the timetable that is only its resolution.
_RESOLUTION_MS: Final = 50

_OPEN_ORDERS: Final = {
    DoorSide.LEFT: DoorOrder.OPEN_LEFT,
    DoorSide.RIGHT: DoorOrder.OPEN_RIGHT,
    DoorSide.BOTH: DoorOrder.OPEN_BOTH,
}
_OPENED: Final = (DoorState.OPEN, DoorState.ISOLATED, DoorState.FAULT)
_REOPENING: Final = (DoorState.OBSTRUCTED, DoorState.OPENING, DoorState.OPEN)
_RUN: Final = AtoState.RUN
_MODES: Final = frozenset(int(one) for one in ModeOrder)


class Drive(IntEnum):
    """What computes the notch: nothing (it is 0), the law of the section, or the creep."""

    NONE = 0
    LAW = 1
    CREEP = 2


class Situation(NamedTuple):
    """What the automaton sees in one step.

    ``now_ms``: time of the run; ``own_ms``: of the node's own count, for ages. ``place_01mm``: own estimate of the
    position. ``begins``: a control period begins. ``is_sound``: the watch demands nothing.
    """

    now_ms: int
    own_ms: int
    speed_01mmps: int
    place_01mm: int
    begins: bool
    is_sound: bool


class Stations(StationTelegrams):
    """State of the train at its stops; see the module for the states.

    ``order``, ``holds``, ``is_ready``: DoorOrder, HoldBrake and DepartReady of DOOR_CMD. ``drive``: what computes the
    notch. Of this step: ``departed``, the law's section begins; ``resumed``, it begins anew from a halt; ``rejoined``,
    the node has come late to a moving train; ``crept``, a creep begins. ``stop``: number in the rules of the stop where
    the train stands, or which it has left. ``counters``: jogs, stops missed, orders that were not given because of the
    side, and departures that were not accepted.
    """

    def __init__(self, rules: StationRules) -> None:
        super().__init__()
        self.rules = rules
        self.state: AtoState = AtoState.INITIALISING
        self.order: DoorOrder = DoorOrder.NONE
        self.holds, self.is_ready = True, False
        self.drive: Drive = Drive.NONE
        self.departed = self.resumed = self.rejoined = self.crept = False
        self.stop = 0
        self.counters = {"jogs": 0, "missed_stops": 0, "wrong_sides": 0, "departures_refused": 0}
        # Times of the node's own count: entry of the state, standstill (-1: the train moves).
        self._entered_ms = 0
        self._stood_ms = -1
        self._has_moved = False
        self._jogs = 0
        self._has_doors = False
        self._has_closed = False
        self._steps: dict[AtoState, Callable[[Situation], None]] = {
            AtoState.INITIALISING: self._initialise,
            AtoState.RUN: self._run,
            AtoState.JOG: self._jog,
            AtoState.MISSED: self._wait_shut,
            AtoState.HOLD: self._hold,
            AtoState.UNLOCK: self._unlock,
            AtoState.WRONG_SIDE: self._refuse_side,
            AtoState.OPENING: self._opening,
            AtoState.OPEN: self._open,
            AtoState.WARN: self._warn,
            AtoState.CLOSING: self._closing,
            AtoState.REOPEN: self._closing,
            AtoState.DOOR_FAULT: self._closing,
            AtoState.READY: self._depart,
            AtoState.TURN_BACK: self._depart,
            AtoState.ENDED: self._end,
        }

    # -- readings ------------------------------------------------------------------------------------------------------

    @property
    def here(self) -> ServedStop:
        """The stop where the train stands, or which it has left."""
        return self.rules.stops[self.stop]

    @property
    def next(self) -> ServedStop:
        """The stop at which the train arrives next; at the terminal, the terminal."""
        return self.rules.stops[min(self.stop + 1, len(self.rules.stops) - 1)]

    @property
    def is_under_way(self) -> bool:
        """Whether the train has left :attr:`here` and has not arrived."""
        return self.state is AtoState.RUN or self.state is AtoState.JOG

    @property
    def station(self) -> int:
        """DoorStation of DOOR_CMD: the stop at which the train stands, or which it leaves; 0 under way."""
        return 0 if self.is_under_way and not self.is_ready else self.here.number

    def expected_departure_ms(self, now_ms: int) -> int:
        """Departure that is expected when the doors begin to close at ``now_ms``."""
        return max(self.due_departure_ms, now_ms + self.rules.close_ms + LOCK_TOLD_MS)

    @property
    def due_departure_ms(self) -> int:
        """Departure from the stop where the train stands, by the track side."""
        planned_ms, info = self.here.depart_ms, self.info
        if info is None or info.station_here != self.here.number:
            return planned_ms
        told_ms = info.due_departure_ds * 100
        return planned_ms if abs(told_ms - planned_ms) <= _RESOLUTION_MS else told_ms

    @property
    def mode_order(self) -> ModeOrder:
        """What the track side orders for the section that begins where the train stands; an order that has no meaning
        counts as none."""
        info = self.info
        if info is None or info.station_here != self.here.number or info.mode_order not in _MODES:
            return ModeOrder.TIMETABLE
        return ModeOrder(info.mode_order)

    # -- steps ---------------------------------------------------------------------------------------------------------

    def step(self, seen: Situation) -> None:
        """One step; in motion between stops it does nothing."""
        self.departed = self.resumed = self.rejoined = self.crept = False
        if seen.speed_01mmps:
            self._stood_ms = -1
            self._has_moved = True
            if self.state is _RUN:
                if self.is_ready and seen.speed_01mmps > LEFT_01MMPS:
                    self.is_ready = False
                return
        elif self._stood_ms < 0:
            self._stood_ms = seen.own_ms
        self._steps[self.state](seen)

    def _enter(self, state: AtoState, seen: Situation) -> None:
        self.state, self._entered_ms = state, seen.own_ms
        self.order = DoorOrder.NONE

    def _stands(self, seen: Situation) -> bool:
        return 0 <= self._stood_ms <= seen.own_ms - STANDING_MS

    def _lasts(self, seen: Situation) -> int:
        return seen.own_ms - self._entered_ms

    def _arrive(self, state: AtoState, seen: Situation) -> None:
        self.stop += 1
        self._enter(state, seen)
        self.holds, self.is_ready, self.drive = True, False, Drive.NONE
        self._has_doors = self._has_closed = False
        self.counters["missed_stops"] += state is AtoState.MISSED

    def _initialise(self, seen: Situation) -> None:
        """Find the train at a stop, or under way if the node came late."""
        info, doors = self.info, self.doors
        if info is None or doors is None or not self.is_fresh(seen.own_ms):
            return
        numbers = [stop.number for stop in self.rules.stops]
        if info.station_here == 0:
            self.stop = min(max(info.section - 1, 0), len(numbers) - 2)
            self._enter(AtoState.RUN, seen)
            self.holds, self.drive, self.rejoined, self._has_moved = False, Drive.LAW, True, True
        elif info.station_here in numbers:
            self.stop = numbers.index(info.station_here)
            if self.stop == 0 and doors.doors_locked == FLAG_TRUE:
                self._make_ready(seen)
            else:
                self._enter(AtoState.HOLD if doors.doors_locked == FLAG_TRUE else AtoState.OPEN, seen)
                self._has_doors = self.state is AtoState.OPEN

    def _run(self, seen: Situation) -> None:
        if self.drive is Drive.NONE:
            self._drive_on(seen)
        elif self._has_moved:
            if self._stands(seen):
                self._judge_stop(seen)
        elif self.is_ready and self._lasts(seen) > ACCEPT_MS and self._is_still_here(seen):
            self.counters["departures_refused"] += 1
            self._make_ready(seen)

    def _is_still_here(self, seen: Situation) -> bool:
        info = self.info
        return info is not None and self.is_fresh(seen.own_ms) and info.station_here == self.here.number

    def _judge_stop(self, seen: Situation) -> None:
        """Decide about a standstill on the way to the next stop."""
        rules, error_01mm = self.rules, seen.place_01mm - self.next.position_01mm
        may_jog = self._jogs < rules.attempts
        if abs(error_01mm) <= rules.window_01mm:
            self._arrive(AtoState.HOLD, seen)
        elif error_01mm > 0 or (error_01mm >= -rules.reach_01mm and not may_jog):
            self._arrive(AtoState.MISSED, seen)
        elif error_01mm >= -rules.reach_01mm:
            self._creep(seen)
        else:
            self._enter(AtoState.RUN, seen)
            self.holds, self.is_ready, self.drive = True, False, Drive.NONE

    def _drive_on(self, seen: Situation) -> None:
        """End a halt between stops."""
        info, short_01mm = self.info, self.next.position_01mm - seen.place_01mm
        if info is None or not self.is_fresh(seen.own_ms):
            return
        if info.station_here == self.next.number:
            self._arrive(AtoState.MISSED, seen)
        elif (
            short_01mm > self.rules.platform_01mm
            and self._lasts(seen) > HALT_MS
            and seen.is_sound
            and seen.begins
            and info.signal_next != SignalAspect.RED
        ):
            self._enter(AtoState.RUN, seen)
            self.holds, self.drive, self.resumed, self._has_moved = False, Drive.LAW, True, False

    def halt(self) -> None:
        """Go on halting: no curve leads to the stop."""
        self.holds, self.is_ready, self.drive = True, False, Drive.NONE

    def _creep(self, seen: Situation) -> None:
        self._enter(AtoState.JOG, seen)
        self._jogs += 1
        self.counters["jogs"] += 1
        self.holds, self.is_ready, self.drive, self.crept = False, False, Drive.CREEP, True
        self._has_moved = False

    def _jog(self, seen: Situation) -> None:
        if not seen.speed_01mmps and (self._stands(seen) if self._has_moved else self._lasts(seen) > JOG_MS):
            self._judge_stop(seen)

    def _hold(self, seen: Situation) -> None:
        if self._lasts(seen) >= HOLDING_MS:
            self._enter(AtoState.UNLOCK, seen)

    def _is_docked(self, seen: Situation) -> bool:
        """Whether docking loop and own estimate say that the train is inside the window, and it stands."""
        doors = self.doors
        is_inside = abs(seen.place_01mm - self.here.position_01mm) <= self.rules.window_01mm
        return is_inside and self._stands(seen) and doors is not None and doors.in_window == FLAG_TRUE

    def _unlock(self, seen: Situation) -> None:
        if self.here.side is DoorSide.NONE:
            self._enter(AtoState.OPEN, seen)
        elif not self.is_fresh(seen.own_ms):
            return
        elif self.is_wrong_side(self.here):
            if self._lasts(seen) > AGE_MAX_MS:
                self.counters["wrong_sides"] += 1
                self._enter(AtoState.WRONG_SIDE, seen)
        elif self._is_docked(seen):
            self._enter(AtoState.OPENING, seen)
            self._has_doors = True
            self._opening(seen)
        elif self._lasts(seen) > DOCKING_MS:
            self._approach(seen)

    def _approach(self, seen: Situation) -> None:
        """The docking loop does not see the train although it should be inside the window."""
        if self._jogs < self.rules.attempts and seen.place_01mm < self.here.position_01mm:
            self.stop -= 1
            self._creep(seen)
        elif self._lasts(seen) > MISSED_MS:
            self.counters["missed_stops"] += 1
            self._make_ready(seen)

    def _refuse_side(self, seen: Situation) -> None:
        if self.is_fresh(seen.own_ms) and not self.is_wrong_side(self.here):
            self._enter(AtoState.UNLOCK, seen)
        else:
            self._wait_shut(seen)

    def _wait_shut(self, seen: Situation) -> None:
        """Wait at a stop whose doors stay shut."""
        if self._lasts(seen) > MISSED_MS:
            self._make_ready(seen)

    def _make_ready(self, seen: Situation) -> None:
        here = self.here
        state = AtoState.ENDED if here.is_terminal else AtoState.TURN_BACK if here.turns_back else AtoState.READY
        self._enter(state, seen)
        self.holds, self.is_ready, self.drive = True, False, Drive.NONE

    def _are_open(self) -> bool:
        return all(state in _OPENED for state in self.side_states(self.here.side))

    def _opening(self, seen: Situation) -> None:
        may_order = self.is_fresh(seen.own_ms) and self._is_docked(seen) and not self.is_wrong_side(self.here)
        self.order = _OPEN_ORDERS[self.here.side] if may_order else DoorOrder.NONE
        is_late = self._lasts(seen) > 3 * self.rules.open_ms + MISSED_MS
        if is_late or (self.is_fresh(seen.own_ms) and self._are_open()):
            self._enter(AtoState.OPEN, seen)

    def _exchange_left_ms(self, seen: Situation) -> int:
        """Rest of the exchange of passengers: by the track side, and by the own count where no doors have opened."""
        doors = self.doors
        if self._has_doors and doors is not None and self._are_open():
            return doors.dwell_left_ds * 100
        return max(self.here.dwell_min_ms - self._lasts(seen), 0)

    def _open(self, seen: Situation) -> None:
        if self.here.is_terminal:
            if self._lasts(seen) > AGE_MAX_MS:
                self._enter(AtoState.ENDED, seen)
            return
        rules = self.rules
        begin_ms = self.due_departure_ms - CLOSE_SPARE_MS - rules.close_ms - rules.warn_ms
        if not self.is_fresh(seen.own_ms) or seen.now_ms < begin_ms or self._exchange_left_ms(seen):
            return
        if self._has_doors:
            self._enter(AtoState.WARN, seen)
        else:
            self._make_ready(seen)

    def _warn(self, seen: Situation) -> None:
        if self.is_fresh(seen.own_ms) and self._lasts(seen) >= self.rules.warn_ms:
            self._enter(AtoState.CLOSING, seen)
            self._closing(seen)

    def _closing(self, seen: Situation) -> None:
        """Order the doors closed; after an obstruction they open again by themselves, and close while it is ordered."""
        doors, may_order = self.doors, self.is_fresh(seen.own_ms) and self._stands(seen)
        self.order = DoorOrder.CLOSE if may_order else DoorOrder.NONE
        if doors is None or not may_order:
            return
        states = self.side_states(self.here.side)
        has_failed = DoorState.FAULT in states or doors.reopened > self.rules.reopen_max
        is_open = any(state in _REOPENING for state in states)
        self._has_closed = self._has_closed or DoorState.CLOSING in states
        if self.are_locked and not is_open:
            self._make_ready(seen)
        elif has_failed or self.state is AtoState.DOOR_FAULT:
            self.state = AtoState.DOOR_FAULT
        elif self._has_closed:
            self.state = AtoState.REOPEN if is_open else AtoState.CLOSING

    def _depart(self, seen: Situation) -> None:
        """Order the departure in the first control period in which everything permits it."""
        info = self.info
        if info is None or not seen.begins or not seen.is_sound or not self._stands(seen):
            return
        if not self.is_fresh(seen.own_ms) or not self.are_locked or not self._is_still_here(seen):
            return
        if info.depart_permit != FLAG_TRUE or seen.now_ms < self.due_departure_ms:
            return
        self._enter(AtoState.RUN, seen)
        self.holds, self.is_ready, self.drive, self.departed = False, True, Drive.LAW, True
        self._has_moved = False
        self._jogs = 0

    def _end(self, seen: Situation) -> None:
        """Nothing remains to be done."""
