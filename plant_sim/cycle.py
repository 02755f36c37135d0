"""What happens in a tick, in which order, and when a run is over: the same for every bench.

At the instant of each tick

1. the plant's ports that are due are published with the readings of this instant, first the one that opens the tick for
   all nodes (the contract's ``clock_port``);
2. what has happened since the tick before is reported: balises, departure, stop, emergency brake;
3. the ports of others that are due are polled: SUP_CMD, NOTCH_CMD, CTL_STAT; the train takes the command;
4. a run whose time has come ends (:class:`RunEnd`);
5. else the train goes on to the next tick.

The plant process (:mod:`railhil.plant_sim.node`) does it on a bus, ``coupled_run`` (:mod:`railhil.bench`) with a law
alone. The batch (:mod:`railhil.batch.kernel`) has a compiled copy, and tests that it gives the same runs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Protocol

from railhil.bus.layout import Telegram
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import CtlStat, Event, NotchCmd, SupCmd
from railhil.dbc import Port, wire_contract
from railhil.plant_sim.events import PlantEvent
from railhil.plant_sim.milestones import Milestones
from railhil.plant_sim.plant import Plant
from railhil.scenarios.model import Scenario

#: The record goes on this long after the stop, so that it shows the standstill.
AFTER_STOP_S = 1.0
#: No train brakes longer than this after its controller was lost.
BRAKING_MAX_NS = 300_000_000_000
#: Ports of the other nodes, in the order in which they are polled.
POLLED = (SupCmd.PORT, NotchCmd.PORT, CtlStat.PORT)


class Surroundings(Protocol):
    """What the train meets on its run: a bus with the other nodes, or whatever stands in for them."""

    #: What ended the run; None while it goes on.
    ended: Event | None
    #: True when nobody commands the train any more.
    controller_lost: bool
    #: Through which RUN_EVENT goes.
    milestones: Milestones

    def begin(self) -> None:
        """The instant of the tick has come, or is waited for."""

    def publish(self, telegram: Telegram, /) -> None:
        """A telegram of the plant."""

    def report(self, event: PlantEvent, /) -> None:
        """Something has happened to the train."""

    def poll(self, port: Port, /) -> None:
        """Ask for a telegram of another node, and do what it says."""

    def finish(self) -> None:
        """All of the tick's telegrams have been published and asked for."""

    def end(self, event: Event, /) -> None:
        """The run is over: :attr:`ended` is set."""


class RunEnd:
    """When a run is over: some time after the train has stopped, or when the timetable is over and it has not.

    A train whose controller is lost may still be braking when the timetable is over; once it stands, nobody will ever
    move it again.
    """

    def __init__(self, scenario: Scenario) -> None:
        plan, tick_ns = scenario.plan, scenario.timing.base_tick_ns
        #: Last tick at which a stop is waited for.
        self.last_tick = round((plan.running_time_s + plan.overtime_max_s) * 1e9 / tick_ns)
        self.after_stop_ticks = max(1, round(AFTER_STOP_S * 1e9 / tick_ns))
        #: Before this tick no run ends whose controller is there.
        self.due_tick = self.last_tick + 1
        self._braking_ticks = BRAKING_MAX_NS // tick_ns
        self._has_stopped = False

    def stopped(self, tick: int) -> None:
        """The train has stopped before this tick; only the first stop counts."""
        if not self._has_stopped:
            self._has_stopped, self.due_tick = True, tick + self.after_stop_ticks

    def reached(self, tick: int, plant: Plant, controller_lost: bool) -> Event | None:
        """The event that ends the run at this tick, None when it goes on."""
        if self._has_stopped:
            return Event.ENDED_COMPLETE if tick >= self.due_tick else None
        over = tick >= self.due_tick
        if controller_lost:
            over = plant.true_speed_01mmps == 0 or tick > self.last_tick + self._braking_ticks
        return Event.ENDED_NOT_STOPPED if over else None


class TickLoop:
    """One run of a plant, tick by tick.

    :param makers: what makes the telegram of each published port, None when there is nothing to be sent.
    :param polled: which of :data:`POLLED` there are.
    """

    def __init__(
        self,
        scenario: Scenario,
        plant: Plant,
        schedule: Schedule,
        surroundings: Surroundings,
        makers: Mapping[str, Callable[[], Telegram | None]],
        polled: Iterable[str] = POLLED,
    ) -> None:
        contract = wire_contract()
        self._plant = plant
        self._around = surroundings
        clock_port = contract.clock_port.name
        self._published = [
            (schedule.ticks(name), makers[name]) for name in sorted(makers, key=lambda name: name != clock_port)
        ]
        self._polled = [(schedule.ticks(name), contract.port(name)) for name in POLLED if name in polled]
        self._run_end = RunEnd(scenario)

    def run(self) -> None:
        """Go through the ticks until the run has ended.

        :raises PlantError: the simulation has failed.
        """
        plant, around, run_end = self._plant, self._around, self._run_end
        while True:
            tick = plant.tick
            around.begin()
            for period, make in self._published:
                if tick % period == 0:
                    telegram = make()
                    if telegram is not None:
                        around.publish(telegram)
            around.milestones.repeat(tick)
            for happened in plant.drain_events():
                if happened.kind == "stopped":
                    run_end.stopped(tick)
                around.report(happened)
            for period, port in self._polled:
                # An answer may end the run: then the other nodes are leaving.
                if tick % period == 0 and around.ended is None:
                    around.poll(port)
            around.finish()
            if around.ended is None and (tick >= run_end.due_tick or around.controller_lost):
                event = run_end.reached(tick, plant, around.controller_lost)
                if event is not None:
                    around.end(event)
            if around.ended is not None:
                return
            plant.advance()
