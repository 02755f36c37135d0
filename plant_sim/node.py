"""The plant process: a plant on its run (:mod:`railhil.plant_sim.cycle`), and the bus administrator of the bench."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, NoReturn

from railhil.bus.administrator import REPLY_NS, Administrator, SendQueue
from railhil.bus.clock import Pacer
from railhil.bus.codes import Event, SupCommand
from railhil.bus.errors import PeerSilent
from railhil.bus.frame import Frame
from railhil.bus.hub.disturbances import Disturber
from railhil.bus.ident import PltIdent
from railhil.bus.layout import Telegram
from railhil.bus.link.base import PackedEnd
from railhil.bus.reception import Document, reception
from railhil.bus.schedule import Schedule
from railhil.bus.store import TrafficStore
from railhil.bus.telegrams import SupCmd, TimeSync
from railhil.common.patience import APPEAR_S
from railhil.dbc import Port
from railhil.plant_sim.any_plant import AnyPlant, Happened, PlantError
from railhil.plant_sim.cycle import Milestones, TickLoop
from railhil.plant_sim.cycle_times import MISSED_NS, PlantTiming
from railhil.plant_sim.faults.plant_faults import PlantFaults
from railhil.plant_sim.faults.plants import make_plant
from railhil.plant_sim.handshake import Handshake, Refused, plant_ident
from railhil.plant_sim.supervision import SILENCE_NS, RunEndpoint, SupervisorWatch
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import System

if TYPE_CHECKING:
    from railhil.bus.injector.node_faults import NodeFaults

#: Attempts to poll the last status, in real time or on a disturbed bus.
LAST_STATUS_POLLS: Final = 3


class PlantNode:
    """One run of the plant on one endpoint; :func:`make_plant_node` makes it with its parts.

    :param faults: the faults of this node.
    :param schedule: when each port is due.
    :param pacer: keeps the pace of the run.
    :param supervisor: tells whether the run is still recorded.
    """

    def __init__(
        self,
        plant: AnyPlant,
        faults: PlantFaults,
        system: System,
        schedule: Schedule,
        administrator: Administrator,
        pacer: Pacer,
        supervisor: SupervisorWatch,
        handshake: Handshake,
    ) -> None:
        self.plant = plant
        self.faults = faults
        self.administrator = administrator
        self.ended: Event | None = None
        self.controller_lost = False
        #: None in lockstep, which has no deadlines.
        self.timing = PlantTiming() if pacer.rate else None
        self._silence = ""
        self._handshake = handshake
        self._own_events = system.events
        self._tick_ns = schedule.base_tick_ns
        self._pacer = pacer
        self._store = administrator.store
        self._supervisor = supervisor
        #: Attributes of :class:`railhil.plant_sim.cycle.Surroundings`.
        self.publish = faults.limited(administrator.queue.publish, "" if system.truth is None else system.truth.port)
        self.milestones = Milestones(self.publish, self._tick_ns)
        contract = system.contract
        self._sup_port = contract.port(SupCmd.PORT)
        self._statuses = [contract.port(name) for name in plant.statuses]
        # Counts of the newest telegram of each status in the record.
        self._status_ticks = dict.fromkeys(plant.statuses, -1)
        # Position of the current tick, because a plant that has failed no longer has one.
        self._position_01mm = 0
        asked = [self._sup_port, *map(contract.port, plant.commands), *self._statuses]
        self._loop = TickLoop(plant, plant.ending, schedule, self, self._makers(), asked, contract.clock_port.name)

    def _makers(self) -> dict[str, Callable[[], Telegram | None]]:
        """Telegrams published in a tick: the plant's own, and behind the time the statement of the run for nodes that
        join late."""
        found: dict[str, Callable[[], Telegram | None]] = {}
        for port, make in self.plant.makers.items():
            found[port] = make
            if port == TimeSync.PORT:
                found[PltIdent.PORT] = self._repeated_ident
        return found

    def _repeated_ident(self) -> Telegram | None:
        # The handshake has sent it before the first tick.
        return self._handshake.own if self.plant.tick else None

    @property
    def counters(self) -> dict[str, int]:
        """Polls, missed polls, and telegrams refused by cause."""
        return {**self.administrator.counters, **self._store.counters}

    @property
    def received(self) -> Document:
        """Telegrams that it has received (:mod:`railhil.bus.reception`); a plant may give the results of its checks in
        ``judged``."""
        found = reception(self._store, getattr(self.plant, "judged", {}))
        found["frames"]["no_answer"] = self.administrator.counters["no_answer"]
        if self._pacer.rate:
            found["frames"]["late"] = self.administrator.counters["late_frames"]
        return found

    def resume(self) -> None:
        """Go on after standing still on the wall clock, which is no silence of the supervisor."""
        self._supervisor.heard(time.monotonic_ns())

    def adopt(self, scenario: AnyScenario, run: RunSpec, folder: Path | None) -> None:
        """Be the plant of another run from the next tick on, which differs from this one only in its faults, and in the
        noise from then on.

        :raises InputError: a fault has begun that is not in both runs.
        """
        self.faults.adopt(scenario, run.seed, folder)
        if change := getattr(scenario, "noise_change", None):
            self.plant.renew_noise(*change)  # type: ignore[attr-defined]
        self._handshake.own = replace(self._handshake.own, scenario_hash=plant_ident(scenario, run).scenario_hash)

    # -- before the run -------------------------------------------------------------------------------------------

    def handshake(self) -> None:
        """Wait for controller and supervisor, compare the runs that the nodes state, wait for the start.

        :raises PeerSilent: a node did not appear.
        :raises Refused: the nodes disagree; they have been told that the run has ended.
        """
        try:
            self._handshake.agree()
        except Refused:
            self.end(Event.ENDED_REFUSED)
            raise

    # -- the run --------------------------------------------------------------------------------------------------

    def run(self) -> Event:
        """Make the run from the handshake to its last event.

        :returns: the event that ended the run.
        :raises PeerSilent: the supervisor is gone.
        :raises BusLost: the bus is gone.
        """
        self.handshake()
        try:
            for _ in self.ticks():
                pass
        except (KeyboardInterrupt, SystemExit):
            # A controller on another machine, or a board, learns of the end only from this telegram. Otherwise it would
            # take the next run for this one.
            self._announce(Event.ENDED_BY_SUPERVISOR)
            self.administrator.queue.flush()
            raise
        return self.ending()

    def ending(self) -> Event:
        """The event that ended the run.

        :raises PeerSilent: the controller has been lost.
        """
        if self.controller_lost:
            raise PeerSilent(self._silence)
        assert self.ended is not None
        return self.ended

    def ticks(self) -> Iterator[None]:
        """The run after the handshake, tick by tick (:meth:`railhil.plant_sim.cycle.TickLoop.ticks`); :meth:`end` ends
        it.

        :raises PeerSilent: the supervisor is gone.
        :raises BusLost: the bus is gone.
        """
        self._pacer.start()
        self._supervisor.heard(time.monotonic_ns())
        try:
            yield from self._loop.ticks()
        except PlantError:
            self.end(Event.ENDED_PLANT_ERROR)
            raise

    # -- the plant's environment (railhil.plant_sim.cycle.Surroundings) ----------------------------------------------

    def begin(self) -> None:
        """Wait for the instant of the tick."""
        if self.timing is not None:
            tick = self.plant.tick
            self.timing.began(tick, self._pacer.wait(tick * self._tick_ns))
        self._position_01mm = self.plant.position_01mm

    def report(self, event: Happened) -> None:
        """A telegram of the plant's own, or RUN_EVENT."""
        telegram = self.plant.telegram_of(event)
        if telegram is not None:
            self.publish(telegram)
        else:
            own = self._own_events.get(event.kind)
            number = Event[event.kind.upper()] if own is None else own
            self.milestones.reached(self.plant.tick, number, event.instant_01ms, event.position_01mm)

    def finish(self) -> None:
        """In real time, telegrams are not held back until the next poll."""
        if self._pacer.rate:
            self.administrator.queue.flush()

    def poll(self, port: Port) -> None:
        """Poll a port, and act on the answer; a lost controller is no longer polled."""
        if self.controller_lost and port.source == "controller":
            return
        polled_ns = time.monotonic_ns()
        self._supervisor.begin()
        try:
            answered = self.administrator.poll(port)
        except PeerSilent as silence:
            if port.source != "controller":
                self._supervisor_lost(silence)
            # The train must stop by itself: time continues without the controller, and the train's watch brakes.
            self.controller_lost, self._silence = True, str(silence)
            return
        now_wall_ns = time.monotonic_ns()
        self._supervisor.end(now_wall_ns)
        if self.timing is not None:
            self.timing.polled(self.plant.tick, port.name, now_wall_ns - polled_ns if answered else MISSED_NS)
        if port is self._sup_port:
            if answered:
                self._supervisor.heard(now_wall_ns)
            elif self._supervisor.is_lost(now_wall_ns):
                silent_s = self._supervisor.limit_ns / 1e9
                self._supervisor_lost(PeerSilent(f"supervisor silent for {silent_s:g} s ({port.name})"))
        if not answered:
            return
        now_ns = self.plant.tick * self._tick_ns
        if port.name in self._status_ticks:
            self._status_ticks[port.name] = self.plant.tick
        elif port.name in self.plant.commands:
            command, _ = self._store.read(self.plant.commands[port.name], now_ns)
            if command is not None:
                self.plant.take(command)
        elif port is self._sup_port:
            self._obey(now_ns)

    def _obey(self, now_ns: int) -> None:
        """Carry out the supervisor's answer."""
        order, _ = self._store.read(SupCmd, now_ns)
        while order is not None and order.command == SupCommand.NONE and not self._pacer.rate:
            # A pause: in lockstep all nodes stand still with the plant. The next answer decides how the run continues.
            try:
                if not self.administrator.poll(self._sup_port):
                    break
            except PeerSilent as silence:
                self._supervisor_lost(silence)
            order, _ = self._store.read(SupCmd, now_ns)
        if order is not None and order.command == SupCommand.STOP:
            self.end(Event.ENDED_BY_SUPERVISOR)
        elif order is not None and order.fault_order:
            self.faults.order(order.fault_number, order.fault_order)

    def _controller_silent(self) -> bool:
        """True when the plant stands because it got no commands."""
        now_ns = self.plant.tick * self._tick_ns
        ages_ns = [self._store.read(telegram, now_ns)[1] for telegram in self.plant.commands.values()]
        return self.controller_lost or self.plant.is_abandoned(max(ages_ns, default=0))

    def _supervisor_lost(self, silence: PeerSilent) -> NoReturn:
        """The run is no longer recorded: tell the controller, and end."""
        self._announce(Event.ENDED_SUPERVISOR_LOST)
        self.administrator.queue.flush()
        raise silence

    def _announce(self, event: Event) -> None:
        self.ended = event
        instant_01ms = self.plant.tick * self._tick_ns // 100_000
        self.milestones.end(event, instant_01ms, self._position_01mm)

    def end(self, event: Event) -> None:
        """Last status and last event; the answer to the final poll shows that the supervisor has recorded
        everything."""
        if event is not Event.ENDED_REFUSED:
            # Nodes that disagree may use different wire contracts.
            self._last_status()
        if event in (Event.ENDED_COMPLETE, Event.ENDED_NOT_STOPPED) and self._controller_silent():
            event = Event.ENDED_CONTROLLER_LOST
        self._announce(event)
        self.administrator.poll(self._sup_port)

    def _last_status(self) -> None:
        """Poll the status in the last tick, so that errors in the controller since its last poll are recorded."""
        for port in self._statuses:
            for _ in range(LAST_STATUS_POLLS):
                if self.controller_lost or self._status_ticks[port.name] == self.plant.tick:
                    break
                self.poll(port)


def make_plant_node(
    scenario: AnyScenario,
    run: RunSpec,
    endpoint: RunEndpoint,
    *,
    fd: bool = False,
    appear_s: float = APPEAR_S,
    reply_ns: int = REPLY_NS,
    silence_ns: int = SILENCE_NS,
    fault_log: Path | None = None,
    disturber: Disturber | None = None,
    packed: PackedEnd | None = None,
    branches: bool = False,
) -> PlantNode:
    """The plant of a run.

    :param run: the run; its law is not used by the plant.
    :param appear_s: how long the other nodes may take to appear, on the wall clock.
    :param reply_ns: real time: an answer to a poll later than this, on the wall clock, counts as missed.
    :param silence_ns: real time: a supervisor silent for this long on the wall clock is considered lost; at a slow pace
        the limit is longer.
    :param fault_log: the run folder, for the log of the faults of this node; None: no log is written.
    :param disturber: takes the orders of faults of the bus; None: they are not acted out (a replay).
    :param packed: the same endpoint for packed frames (:attr:`railhil.bus.link.Link.packed`). With faults, only the
        frames that they leave are sent early there.
    :param branches: the run may be given other faults (:meth:`PlantNode.adopt`).
    :raises InputError: the plant cannot have the run's faults or FMU.
    """
    system = scenario.installed_system
    contract = system.contract
    tick_ns = scenario.timing.base_tick_ns
    schedule = Schedule.from_contract(tick_ns, scenario.timing.port_period_ns, contract)
    plant, inside = make_plant(scenario, run, branches=branches)
    endpoint.lossless = not run.is_realtime
    sent: NodeFaults | None = None
    send_early: Callable[[Sequence[Frame]], bool] | None = None
    if scenario.faults or branches:
        # The injector is loaded only for a run with faults, because it takes a tenth of the start of a node.
        from railhil.bus.injector.node_faults import NodeFaults
        from railhil.bus.injector.plant_side import FaultyEndpoint
        from railhil.scenarios.fault_list import make_injection

        sent = NodeFaults(make_injection(scenario, run.seed), contract, schedule, "plant", fault_log)
        if branches:
            sent.activities.remember()
        endpoint = faulty = FaultyEndpoint(endpoint, sent, contract, disturber, packed)
        send_early, packed = faulty.send_early, None
    # The score alone reads the truth.
    unread = "" if system.truth is None else system.truth.port
    queue = SendQueue(
        endpoint, contract, fd=fd, realtime=run.is_realtime, send_early=send_early, packed=packed, unread=unread
    )
    pacer = Pacer(run.wall_rate)
    store = TrafficStore([port for port in contract.ports if port.mode == "poll"])
    administrator = Administrator(
        endpoint,
        store,
        queue,
        lambda: plant.tick * tick_ns,
        pacer,
        contract,
        reply_ns=reply_ns,
        patience_s=run.patience_s,
    )
    supervisor = SupervisorWatch(
        endpoint,
        schedule.ticks(SupCmd.PORT) * tick_ns,
        run.wall_rate,
        silence_ns=silence_ns,
        patience_s=run.patience_s,
    )
    handshake = Handshake(administrator, plant_ident(scenario, run), contract, appear_s)
    faults = PlantFaults(sent, inside, fault_log)
    return PlantNode(plant, faults, system, schedule, administrator, pacer, supervisor, handshake)
