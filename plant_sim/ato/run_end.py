"""The end of a train's run."""

from __future__ import annotations

from typing import Final

from railhil.bus.codes import Event
from railhil.plant_sim.ato.plant import Plant
from railhil.systems.ato.scenario.model import Scenario

#: Recording continues for this long after the stop, so that it shows the standstill.
AFTER_STOP_S: Final = 1.0
#: Longest time to wait for a train to stop after its controller was lost.
BRAKING_MAX_NS: Final = 300_000_000_000


class RunEnd:
    """Determines when a train's run is over: some time after the train has stopped, or after the timetable's end if it
    has not.

    A train whose controller is lost may still be braking at the end of the timetable; once it stands, it will not move
    again.

    :param plant: its standstill counts in that case; None if the controller cannot be lost.
    """

    def __init__(self, scenario: Scenario, plant: Plant | None = None) -> None:
        plan, tick_ns = scenario.plan, scenario.timing.base_tick_ns
        #: Last tick at which a stop is awaited.
        self.last_tick = round((plan.running_time_s + plan.overtime_max_s) * 1e9 / tick_ns)
        self.after_stop_ticks = max(1, round(AFTER_STOP_S * 1e9 / tick_ns))
        #: No run with a live controller ends before this tick.
        self.due_tick = self.last_tick + 1
        self._braking_ticks = BRAKING_MAX_NS // tick_ns
        self._has_stopped = False
        self._plant = plant

    def happened(self, kind: str, tick: int) -> None:
        """Note a stop before this tick; only the first stop counts."""
        if kind == "stopped" and not self._has_stopped:
            self._has_stopped, self.due_tick = True, tick + self.after_stop_ticks

    def reached(self, tick: int, controller_lost: bool) -> Event | None:
        """The event that ends the run at this tick, None if the run continues."""
        if self._has_stopped:
            return Event.ENDED_COMPLETE if tick >= self.due_tick else None
        over = tick >= self.due_tick
        if controller_lost:
            over = (
                self._plant is None or self._plant.true_speed_01mmps == 0 or tick > self.last_tick + self._braking_ticks
            )
        return Event.ENDED_NOT_STOPPED if over else None
