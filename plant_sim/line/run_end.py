"""When the run over a line is over."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from railhil.bus.codes import Event
from railhil.plant_sim.ato.train import RunEnd
from railhil.systems.line.scenario.model import LineScenario

if TYPE_CHECKING:
    from railhil.plant_sim.line.train import LineTrain

#: The run ends when the doors have been open this long at the terminal.
OPEN_S: Final = 1.0
#: It also ends when the train has stood this long at the terminal without opening its doors.
MISSED_S: Final = 10.0


class LineRunEnd(RunEnd):
    """The run ends at the terminal stop, or after the timetable's end, see :class:`RunEnd`."""

    def __init__(self, scenario: LineScenario, train: LineTrain) -> None:
        super().__init__(scenario, train)
        tick_ns = scenario.timing.base_tick_ns
        self._train = train
        self._open_ticks, self._missed_ticks = (round(span_s * 1e9 / tick_ns) for span_s in (OPEN_S, MISSED_S))
        self._complete_tick: int | None = None
        self._is_at_terminal = False

    def happened(self, kind: str, tick: int) -> None:
        """Note the arrival at the terminal, and its open doors."""
        if kind == "arrived" and self._train.journey.is_at_terminal:
            self._is_at_terminal = True
            self.due_tick = min(self.due_tick, tick + self._missed_ticks)
        elif kind == "doors_open" and self._is_at_terminal and self._complete_tick is None:
            self._complete_tick = self.due_tick = tick + self._open_ticks

    def reached(self, tick: int, controller_lost: bool) -> Event | None:
        """The event that ends the run at this tick, None if the run continues."""
        if self._complete_tick is not None:
            return Event.ENDED_COMPLETE if tick >= self._complete_tick else None
        if self._is_at_terminal and not controller_lost and tick <= self.last_tick:
            train = self._train
            stood = tick - train.stood_from_tick
            if train.station_here is not None and train.doors.are_locked and stood >= self._missed_ticks:
                return Event.ENDED_COMPLETE
            return None
        if not controller_lost and tick <= self.last_tick:
            return None
        return super().reached(tick, controller_lost)
