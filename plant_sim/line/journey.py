"""Where the train is in its timetable: section, leg, stop, exchange of passengers, signals, movement authority."""

from __future__ import annotations

from typing import Final

from railhil.plant_sim.atp.readings import Authority
from railhil.plant_sim.line.doors import PSD_DELAY_S
from railhil.plant_sim.line.pass_mark import PassMark
from railhil.systems.line.scenario.dwell import DrawnDwell
from railhil.systems.line.scenario.model import LineScenario, RouteSignal, StationStop
from railhil.wire.line import SignalAspect

#: A train that has stood this long short of its stop, but in part at the platform, counts as arrived.
SHORT_STANDING_S: Final = 10.0
#: End of the authority's safe distance behind a red signal.
SIGNAL_OVERLAP_M: Final = 20.0


class Journey:
    """The run over the stops of a line.

    Numbers of stops, sections and legs count from 0; section -1 is before the first departure.

    :ivar section: it and everything that belongs to it changes when a departure is accepted.
    :ivar arrival: number of the stop at which the section ends.
    :ivar has_arrived: the train has stood there since the departure.
    :ivar has_opened: its doors have been open there.
    :ivar held_red: numbers of the signals that a fault holds red, from 1; 0: all, and the exits of the stops.
    :ivar next_stop: number of the next stop, served or not, that the train has not reached; None: there is none.
    """

    def __init__(self, scenario: LineScenario, dwells: tuple[DrawnDwell, ...]) -> None:
        self._scenario = scenario
        self._dwells = dwells
        self._tick_s = scenario.timing.base_tick_ns * 1e-9
        self.stops = scenario.stops
        self.section = -1
        self.leg = scenario.stops[0].leg
        self.arrival = 0
        self.has_arrived = True
        self.has_opened = False
        self.next_stop: int | None = 1
        self.held_red: set[int] = set()
        self.departure_tick = 0
        self._begin_m = self._exit_m = self.stops[0].position_m
        self._extra_s = 0.0
        self._numbers = {signal: number for number, signal in enumerate(scenario.signals, 1)}
        #: When the exchange of passengers is over; None: the doors have not been open.
        self._exchanged_tick: int | None = None
        #: To the section's end.
        self._authority: Authority | None = None
        #: Signals of the section that the front has passed while they were clear, and platforms while they were locked.
        self._passed_clear: set[RouteSignal | StationStop] = set()

    # -- the section --------------------------------------------------------------------------------------------------

    @property
    def stop(self) -> StationStop:
        """The stop at which the section ends."""
        return self.stops[self.arrival]

    @property
    def is_at_terminal(self) -> bool:
        """Whether no section follows."""
        return self.section + 1 >= len(self._scenario.sections)

    def depart(self, tick: int) -> bool:
        """Begin the next section.

        :returns: whether it belongs to another leg.
        """
        self.section += 1
        section = self._scenario.sections[self.section]
        self.next_stop = section.departure + 1
        left = self.stops[section.departure]
        self._begin_m, self._exit_m = left.position_m, left.position_m + left.eoa_overlap_m
        self.arrival = section.arrival
        self.has_arrived = self.has_opened = False
        self._exchanged_tick = self._authority = None
        self._passed_clear.clear()
        self.departure_tick = tick
        self._extra_s = 0.0
        before, self.leg = self.leg, section.leg
        return before != self.leg

    def passed_marks(self) -> list[PassMark]:
        """The stops of the leg that the train passes."""
        return [
            PassMark(number, stop.position_m, stop.position_m)
            for number, stop in enumerate(self.stops)
            if stop.leg == self.leg and stop.service == "pass"
        ]

    def pass_stop(self, number: int) -> None:
        """Note that the front has passed a stop that is not served."""
        self.next_stop = number + 1

    # -- at the stop --------------------------------------------------------------------------------------------------

    def stand(self, position_m: float) -> bool:
        """Note a standstill; True at the first one within reach of the stop, or behind it."""
        if self.has_arrived or position_m < self.stop.position_m - self._scenario.route.jog.reach_m:
            return False
        self._arrive()
        return True

    def stand_short(self, position_m: float, tick: int, stood_ticks: int) -> bool:
        """Note how long the train has stood; True when it counts as arrived although it is not within reach."""
        if (
            self.has_arrived
            or stood_ticks * self._tick_s < SHORT_STANDING_S
            or position_m < self.stop.position_m - self._scenario.train.length_m
            or self.red_signal(position_m, tick * self._tick_s) is not None
        ):
            return False
        self._arrive()
        return True

    def _arrive(self) -> None:
        self.has_arrived = True
        self.next_stop = None if self.is_at_terminal else self.arrival + 1

    @property
    def exchange_s(self) -> float:
        """How long passengers board and alight at this stop, from open doors on. Nobody does at the first stop.

        The least dwell counts from the standstill to the departure, so the times of the doors are part of it.
        """
        if self.section < 0:
            return 0.0
        doors, drawn = self._scenario.route.doors, self._dwells[self.arrival]
        moving_s = doors.open_s + PSD_DELAY_S + doors.warn_s + doors.close_s
        return max(0.0, self.stop.dwell_min_s - moving_s) + drawn.disturbance_s + drawn.hold_s + self._extra_s

    def hold(self, extra_s: float, tick: int) -> bool:
        """Prolong the exchange (a fault); False: the train has not arrived, or the exchange is over."""
        if not self.has_arrived or self.section < 0:
            return False
        if self._exchanged_tick is None:
            self._extra_s += extra_s
            return True
        if tick >= self._exchanged_tick:
            return False
        self._exchanged_tick += round(extra_s / self._tick_s)
        return True

    def open(self, tick: int) -> None:
        """Note that all doors are open: the exchange begins, unless it has begun before."""
        if not self.has_opened:
            self.has_opened = True
            self._exchanged_tick = tick + round(self.exchange_s / self._tick_s)

    def dwell_left_s(self, tick: int) -> float:
        """Rest of the exchange: all of it before the doors are open, 0 under way."""
        if not self.has_arrived:
            return 0.0
        if self._exchanged_tick is None:
            return self.exchange_s
        return max(0, self._exchanged_tick - tick) * self._tick_s

    def permits(self, position_m: float, tick: int) -> bool:
        """Whether the track side permits the departure: exchange over, and no red signal up to the section's end."""
        if not self.has_arrived or self.is_at_terminal:
            return False
        if self._exchanged_tick is not None and tick < self._exchanged_tick:
            return False
        return not self.is_exit_red(position_m) and self.red_signal(position_m, tick * self._tick_s) is None

    # -- signals ------------------------------------------------------------------------------------------------------

    def next_signal(self, position_m: float) -> RouteSignal | None:
        """The next signal of the leg ahead of the train; at a turn-back that of the next leg."""
        leg = self._leg_ahead
        ahead = [one for one in self._scenario.signals if one.leg == leg and one.position_m >= position_m]
        return min(ahead, key=lambda one: one.position_m, default=None)

    def signal_aspect(self, position_m: float, tick: int) -> int:
        """What the next signal shows."""
        signal = self.next_signal(position_m)
        if self.is_exit_red(position_m):
            return SignalAspect.RED
        if signal is None:
            return SignalAspect.NONE
        return SignalAspect.RED if self._is_red(signal, tick * self._tick_s) else SignalAspect.CLEAR

    def _is_red(self, signal: RouteSignal, now_s: float) -> bool:
        held = self.held_red
        return now_s < signal.clear_s or (bool(held) and not held.isdisjoint((0, self._numbers[signal])))

    def is_exit_red(self, position_m: float) -> bool:
        """Whether a fault holds the exit of the stop red at which the train stands, or which it leaves.

        The exit is where the authority ended at the stop.
        """
        is_before = position_m < self._exit_m or (self.has_arrived and not self.is_at_terminal)
        return is_before and 0 in self.held_red

    def is_held_red(self, position_m: float, tick: int) -> bool:
        """Whether a fault holds a signal red that now concerns the train."""
        red = self.red_signal(position_m, tick * self._tick_s)
        return self.is_exit_red(position_m) or (red is not None and tick * self._tick_s >= red.clear_s)

    def red_signal(self, position_m: float, now_s: float) -> RouteSignal | None:
        """The first red signal ahead, up to the end of the section that the train is in or would depart into."""
        end = self.arrival
        if self.has_arrived and not self.is_at_terminal:
            end = self._scenario.sections[self.section + 1].arrival
        leg, to_m = self._leg_ahead, self.stops[end].position_m
        red = [
            one
            for one in self._scenario.signals
            if one.leg == leg and position_m <= one.position_m <= to_m and self._is_red(one, now_s)
        ]
        return min(red, key=lambda one: one.position_m, default=None)

    @property
    def _leg_ahead(self) -> int:
        if self.has_arrived and not self.is_at_terminal:
            return self._scenario.sections[self.section + 1].leg
        return self.leg

    @property
    def passed_platforms(self) -> tuple[StationStop, ...]:
        """The stops with platform doors that the train passes in this section."""
        between = (
            self.stops[self._scenario.sections[self.section].departure + 1 : self.arrival] if self.section >= 0 else ()
        )
        return tuple(stop for stop in between if stop.psd)

    def awaits_platform(self, position_m: float) -> bool:
        """Whether platform doors on the way count: their platform is ahead, or was not locked when the front came."""
        return any(
            platform not in self._passed_clear and position_m <= platform.position_m
            for platform in self.passed_platforms
        )

    def authority(self, position_m: float, tick: int, are_platforms_locked: bool = True) -> Authority:
        """The authority that the track side gives: to the section's end, or to a red signal before it.

        A signal that the front has passed while it was clear no longer counts; one that was passed red does. A platform
        on the way whose doors are not locked is a red signal a train's length before its stopping point.

        :param are_platforms_locked: whether the doors of the platforms on the way are closed and locked.
        """
        stop = self.stop
        if self._authority is None:
            self._authority = Authority(stop.position_m + stop.eoa_overlap_m, stop.position_m + stop.svl_overlap_m)
        platforms = self.passed_platforms
        if not self._scenario.signals and not platforms:
            return self._authority
        now_s, red_m = tick * self._tick_s, [self._authority.eoa_m]
        for platform in platforms:
            begin_m = platform.position_m - self._scenario.train.length_m
            if platform in self._passed_clear:
                continue
            if not are_platforms_locked:
                red_m.append(begin_m)
            elif begin_m < position_m:
                self._passed_clear.add(platform)
        for one in self._scenario.signals:
            if one.leg != self.leg or not self._begin_m < one.position_m < self._authority.eoa_m:
                continue
            if one in self._passed_clear:
                continue
            if self._is_red(one, now_s):
                red_m.append(one.position_m)
            elif one.position_m < position_m:
                self._passed_clear.add(one)
        end_m = min(red_m)
        if end_m < self._authority.eoa_m:
            return Authority(end_m, end_m + SIGNAL_OVERLAP_M, True)
        return self._authority
