"""For plants of systems that plug in: a milestone, and a run that is over after a given time."""

from __future__ import annotations

from dataclasses import dataclass

from railhil.bus.telegrams import Event


@dataclass(frozen=True, slots=True)
class Milestone:
    """A milestone of the run, see :class:`railhil.plant_sim.any_plant.Happened`."""

    kind: str
    instant_01ms: int
    position_01mm: int


class TimedEnd:
    """The run is over when its time is, or its controller is gone (:class:`railhil.plant_sim.any_plant.Ending`).

    :param duration_s: simulation time of the whole run.
    """

    def __init__(self, duration_s: float, tick_ns: int) -> None:
        self.due_tick = round(duration_s * 1e9 / tick_ns)

    def happened(self, kind: str, tick: int) -> None:
        """Nothing that happens ends the run."""

    def reached(self, tick: int, controller_lost: bool) -> Event | None:
        """The event that ends the run at this tick, None when it goes on."""
        if controller_lost:
            return Event.ENDED_NOT_STOPPED
        return Event.ENDED_COMPLETE if tick >= self.due_tick else None
