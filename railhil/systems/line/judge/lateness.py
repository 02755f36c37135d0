"""Lateness at a stop: how much of a late departure each cause has made, and how late the next arrival may be.

A departure is late for what the run has met (late arrival, long exchange, slow or obstructed doors, red signal), or
because the controller has waited without need. Only the latter is the controller's; the former excuses the lateness of
the next arrival as far as the timetable's reserve cannot make it up (section 6 of the specification).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from railhil.systems.line.judge.doors import Exchange
from railhil.systems.line.scenario.model import LineScenario, Section
from railhil.systems.line.scenario.sections import ordered_time_s

#: Time by which the platform's doors open later than the train's, s (section 2), and time for the station automaton's
#: own steps at a stop (chosen): what is not longer is nobody's delay.
PSD_S: Final = 0.3
STEPS_S: Final = 1.0


@dataclass(frozen=True, slots=True)
class Instants:
    """What happened at a stop, in s of the run. None: it did not, or the stop has none (the first has no arrival).

    ``due_arrival_s``, ``due_departure_s``: timetable. ``stood_s``: last standstill before the doors opened.
    ``red_s``: time for which the departure was not permitted although the doors were locked.
    """

    due_arrival_s: float | None
    due_departure_s: float | None
    stood_s: float | None
    opened_s: float | None
    exchange: Exchange
    locked_s: float | None
    red_s: float
    departed_s: float | None

    @property
    def arrival_late_s(self) -> float | None:
        """Lateness of the arrival in s."""
        return less(self.stood_s, self.due_arrival_s)

    @property
    def departure_late_s(self) -> float | None:
        """Lateness of the departure in s."""
        return less(self.departed_s, self.due_departure_s)


@dataclass(frozen=True, slots=True)
class Delay:
    """Delay at a stop by its causes, in s, each at least 0: what took longer than the timetable has for it."""

    running: float = 0.0
    dwell: float = 0.0
    doors: float = 0.0
    signal: float = 0.0
    controller: float = 0.0

    @property
    def cause(self) -> str:
        """The cause with the largest delay; empty without any."""
        delays = {name: getattr(self, name) for name in ("running", "dwell", "doors", "signal", "controller")}
        largest = max(delays, key=delays.__getitem__)
        return largest if delays[largest] > 0.0 else ""


NO_DELAY: Final = Delay()


def nominal_exchange_s(scenario: LineScenario, dwell_min_s: float) -> float:
    """Time for the exchange of passengers in the timetable, s: the least dwell, which counts from the standstill to the
    departure, less the times of the doors."""
    doors = scenario.route.doors
    return max(0.0, dwell_min_s - doors.open_s - PSD_S - doors.warn_s - doors.close_s)


def delay_of(scenario: LineScenario, dwell_min_s: float, at: Instants) -> Delay:
    """The delay at a stop by its causes; none without a departure, or without a timetable.

    :param dwell_min_s: least dwell in the timetable.
    """
    doors, period_s = scenario.route.doors, scenario.timing.control_period_ns / 1e9
    due_s, departed_s, ended_s = at.due_departure_s, at.departed_s, at.exchange.ended_s
    if due_s is None or departed_s is None:
        return NO_DELAY
    running = max(0.0, at.arrival_late_s or 0.0)
    ready_s = max(due_s, at.locked_s or 0.0) + at.red_s
    waited_s = max(0.0, departed_s - ready_s - period_s)
    if at.stood_s is None or at.opened_s is None or ended_s is None:
        return Delay(running=running, signal=at.red_s, controller=waited_s)
    opening = max(0.0, at.opened_s - at.stood_s - doors.open_s - PSD_S - STEPS_S)
    closing = hesitated_s = 0.0
    if at.exchange.closing_s is not None and at.locked_s is not None:
        warned_s = max(ended_s, due_s - doors.warn_s - doors.close_s) + doors.warn_s
        hesitated_s = max(0.0, at.exchange.closing_s - warned_s - STEPS_S)
        closing = max(0.0, at.locked_s - at.exchange.closing_s - doors.close_s - PSD_S)
    return Delay(
        running=running,
        dwell=max(0.0, ended_s - at.opened_s - nominal_exchange_s(scenario, dwell_min_s)),
        doors=opening + closing,
        signal=at.red_s,
        controller=waited_s + hesitated_s,
    )


def recoverable_s(scenario: LineScenario, section: Section) -> float:
    """Time that the section's running can make up, in s: the timetable's less the shortest that the regulation allows.

    Without regulation there is none. With an order of the track side it is what the ordered profile makes up, which is
    negative if the profile takes longer than the timetable.
    """
    mode = scenario.stops[section.departure].mode
    if mode != "timetable":
        return section.running_time_s - ordered_time_s(scenario, section, mode)
    if scenario.route.regulation == "none":
        return 0.0
    fastest_s = section.fastest_s
    if scenario.route.regulation == "profiles":
        fastest_s *= 1.0 + scenario.route.profiles_percent[0] / 100.0
    return max(0.0, section.running_time_s - fastest_s)


def excused_s(scenario: LineScenario, section: Section, before: Instants, delay: Delay) -> float:
    """How late an arrival may be beyond the limit, in s: the lateness of the departure before it that is not the
    controller's, less what the section can make up.

    :param before, delay: of the departure before it.
    """
    late_s = before.departure_late_s or 0.0
    return max(0.0, late_s - delay.controller - recoverable_s(scenario, section))


def early_excused_s(scenario: LineScenario, section: Section) -> float:
    """How early an arrival may be beyond the limit, in s: what an ordered profile takes less than the timetable."""
    mode = scenario.stops[section.departure].mode
    return max(0.0, section.running_time_s - ordered_time_s(scenario, section, mode))


def less(instant_s: float | None, due_s: float | None) -> float | None:
    """How much later an instant is than another, s; None if one of them is not known."""
    return None if instant_s is None or due_s is None else instant_s - due_s
