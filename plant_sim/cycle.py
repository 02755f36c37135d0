"""What happens in a tick, in which order, and when a run is over: the same for every bench.

At the instant of each tick

1. the plant's ports that are due are published with the readings of this instant, first the one that opens the tick for
   all nodes (the contract's ``clock_port``);
2. what has happened since the tick before is reported: balises, departure, stop, emergency brake;
3. the ports of others that are due are polled: SUP_CMD, NOTCH_CMD, CTL_STAT; the train takes the command;
4. a run whose time has come ends (:class:`railhil.plant_sim.any_plant.Ending`);
5. else the train goes on to the next tick.

The plant process (:mod:`railhil.plant_sim.node`) does it on a bus, ``coupled_run`` (:mod:`railhil.bench`) with a law
alone. The batch (:mod:`railhil.batch.kernel`) has a compiled copy, and tests that it gives the same runs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Protocol

from railhil.bus.layout import Telegram
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import Event
from railhil.dbc import Port
from railhil.plant_sim.any_plant import Ending, Happened
from railhil.plant_sim.milestones import Milestones


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

    def report(self, event: Happened, /) -> None:
        """Something has happened to the plant."""

    def poll(self, port: Port, /) -> None:
        """Ask for a telegram of another node, and do what it says."""

    def finish(self) -> None:
        """All of the tick's telegrams have been published and asked for."""

    def end(self, event: Event, /) -> None:
        """The run is over: :attr:`ended` is set."""


class TickedPlant(Protocol):
    """What the loop asks of a plant."""

    tick: int

    def advance(self) -> None:
        """Simulate one base tick."""

    def drain_events(self) -> Sequence[Happened]:
        """What has happened since the last call."""


class TickLoop:
    """One run of a plant, tick by tick.

    :param makers: what makes the telegram of each published port, None when there is nothing to be sent.
    :param polled: ports of the other nodes, in the order in which they are asked.
    :param clock_port: the port that opens the tick.
    """

    def __init__(
        self,
        plant: TickedPlant,
        ending: Ending,
        schedule: Schedule,
        surroundings: Surroundings,
        makers: Mapping[str, Callable[[], Telegram | None]],
        polled: Iterable[Port],
        clock_port: str,
    ) -> None:
        self._plant = plant
        self._around = surroundings
        self._published = [
            (schedule.ticks(name), makers[name]) for name in sorted(makers, key=lambda name: name != clock_port)
        ]
        self._polled = [(schedule.ticks(port.name), port) for port in polled]
        self._ending = ending

    def run(self) -> None:
        """Go through the ticks until the run has ended.

        :raises PlantError: the simulation has failed.
        """
        plant, around, ending = self._plant, self._around, self._ending
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
                ending.happened(happened.kind, tick)
                around.report(happened)
            for period, port in self._polled:
                # An answer may end the run: then the other nodes are leaving.
                if tick % period == 0 and around.ended is None:
                    around.poll(port)
            around.finish()
            if around.ended is None and (tick >= ending.due_tick or around.controller_lost):
                event = ending.reached(tick, around.controller_lost)
                if event is not None:
                    around.end(event)
            if around.ended is not None:
                return
            plant.advance()
