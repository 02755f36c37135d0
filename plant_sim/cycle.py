"""The order of events in a tick and the end of a run, shared by every bench.

At the instant of each tick

1. the plant's ports that are due are published with the readings of this instant, starting with the one that opens the
   tick for all nodes (the contract's ``clock_port``);
2. events since the previous tick are reported: balises, departure, stop, emergency brake;
3. the ports of other nodes that are due are polled: SUP_CMD, NOTCH_CMD, CTL_STAT; the train takes the command;
4. the run ends if its end condition is met (:class:`railhil.plant_sim.any_plant.Ending`);
5. otherwise the train advances to the next tick.

The plant process (:mod:`railhil.plant_sim.node`) uses it on a bus, ``coupled_run`` (:mod:`railhil.run.coupled`) with
only a law. The batch of ``ato`` has a compiled copy; tests check that it gives the same runs.

A run has milestones, which go over the bus as RUN_EVENT: each is numbered and repeated, so that no single frame
decides a verdict.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from math import lcm
from typing import Final, Protocol

from railhil.bus.codes import EVENT_COPIES, EVENT_SPACING_NS, Event
from railhil.bus.layout import Telegram
from railhil.bus.schedule import Schedule
from railhil.bus.telegrams import RunEvent
from railhil.dbc import Port
from railhil.plant_sim.any_plant import Ending, Happened, PlantError

_NUMBER_MASK: Final = 0xFFFF


class Milestones:
    """Sends each milestone :data:`railhil.bus.codes.EVENT_COPIES` times under one number.

    The first telegram is sent at once, the others at intervals of :data:`railhil.bus.codes.EVENT_SPACING_NS` (in
    whole ticks, at least one). For the milestone that ends the run there is no later tick: all its telegrams are sent
    at once, after the outstanding repetitions of earlier milestones.

    :param publish: queues a telegram for the bus.
    """

    def __init__(self, publish: Callable[[Telegram], None], base_tick_ns: int) -> None:
        self._publish = publish
        self._spacing_ticks = -(-EVENT_SPACING_NS // base_tick_ns)
        self._number = 0
        #: Tick at which the telegram is due, in increasing order per milestone.
        self._due: list[tuple[int, RunEvent]] = []

    def reached(self, tick: int, event: int, instant_01ms: int, position_01mm: int) -> None:
        """Send a milestone of the train at ``tick``."""
        telegram = self._numbered(event, instant_01ms, position_01mm)
        self._publish(telegram)
        self._due += [(tick + copy * self._spacing_ticks, telegram) for copy in range(1, EVENT_COPIES)]

    def repeat(self, tick: int) -> None:
        """Send the repetitions due at ``tick``."""
        if self._due:
            for due_tick, telegram in self._due:
                if due_tick <= tick:
                    self._publish(telegram)
            self._due = [item for item in self._due if item[0] > tick]

    def end(self, event: Event, instant_01ms: int, position_01mm: int) -> None:
        """Send the milestone that ends the run."""
        for _, telegram in self._due:
            self._publish(telegram)
        self._due = []
        telegram = self._numbered(event, instant_01ms, position_01mm)
        for _ in range(EVENT_COPIES):
            self._publish(telegram)

    def _numbered(self, event: int, instant_01ms: int, position_01mm: int) -> RunEvent:
        self._number = self._number % _NUMBER_MASK + 1
        return RunEvent(event, self._number, instant_01ms, position_01mm)


#: Longest cycle of due ports for which a table is made, in ticks.
_TABLE_TICKS: Final = 1000


class Surroundings(Protocol):
    """The environment of the train in a run: a bus with the other nodes, or a substitute."""

    #: The event that ended the run; None while it continues.
    ended: Event | None
    #: True when the train no longer gets commands.
    controller_lost: bool
    #: Sends RUN_EVENT.
    milestones: Milestones

    def begin(self) -> None:
        """Begin the tick, after waiting for its instant if necessary."""

    def publish(self, telegram: Telegram, /) -> None:
        """Publish a telegram of the plant."""

    def report(self, event: Happened, /) -> None:
        """Report an event of the plant."""

    def poll(self, port: Port, /) -> None:
        """Poll a telegram of another node, and act on it."""

    def finish(self) -> None:
        """Finish the tick after all its telegrams have been published and polled."""

    def end(self, event: Event, /) -> None:
        """End the run: set :attr:`ended`."""


class TickedPlant(Protocol):
    """Interface of a plant for the loop."""

    tick: int

    def advance(self) -> None:
        """Simulate one base tick."""

    def drain_events(self) -> Sequence[Happened]:
        """Events since the last call."""


class TickLoop:
    """One run of a plant, tick by tick.

    :param makers: for each published port, the function that makes its telegram, or None when nothing is to be sent.
    :param polled: ports of the other nodes, in the order of the polls.
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
        self._turn_ticks = lcm(*(period for period, _ in (*self._published, *self._polled)))

    def run(self) -> None:
        """Execute ticks until the run has ended.

        :raises PlantError: the simulation has failed.
        """
        for _ in self.ticks():
            pass

    def _due(self, tick: int) -> tuple[list[Callable[[], Telegram | None]], list[Port]]:
        """Makers of the telegrams published in a tick, and the ports that are polled."""
        return (
            [make for period, make in self._published if tick % period == 0],
            [port for period, port in self._polled if tick % period == 0],
        )

    def ticks(self) -> Iterator[None]:
        """Execute ticks until the run has ended; gives control back at the instant of each, after all its telegrams.

        The caller may end the run through the surroundings.

        :raises PlantError: the simulation has failed.
        """
        plant, around, ending = self._plant, self._around, self._ending
        turn = self._turn_ticks
        table = [self._due(tick) for tick in range(turn)] if turn <= _TABLE_TICKS else []
        while True:
            tick = plant.tick
            makers, ports = table[tick % turn] if table else self._due(tick)
            around.begin()
            try:
                for make in makers:
                    telegram = make()
                    if telegram is not None:
                        around.publish(telegram)
                around.milestones.repeat(tick)
                for happened in plant.drain_events():
                    ending.happened(happened.kind, tick)
                    around.report(happened)
            except OverflowError as misfit:
                # The values that a scenario can reach are checked when it is loaded. Only a fault can exceed them.
                raise PlantError(f"tick {tick}: {misfit}: the wire cannot carry it") from misfit
            for port in ports:
                # An answer may end the run; the other nodes then leave the bus.
                if around.ended is None:
                    around.poll(port)
            around.finish()
            if around.ended is None and (tick >= ending.due_tick or around.controller_lost):
                event = ending.reached(tick, around.controller_lost)
                if event is not None:
                    around.end(event)
            yield
            if around.ended is not None:
                return
            plant.advance()
