"""The first check of a controller on a bus: handshake and some polls, as the bus administrator of a run makes them.

The plant of the scenario publishes its telegrams and never gets a command, so a train that begins at rest stands.
Nothing is recorded or scored; each answer is looked at, frame by frame.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from railhil.bus.administrator import REPLY_NS, SendQueue
from railhil.bus.clock import Pacer
from railhil.bus.codes import Event
from railhil.bus.errors import OTHER_ADMINISTRATOR, BusOccupied, PeerSilent
from railhil.bus.frame import Frame
from railhil.bus.ident import ARITHMETICS, INDEXINGS, CtlIdent, Role, law_words, make_ident
from railhil.bus.layout import Telegram
from railhil.bus.mvb import F_DEVICE_STATUS, master_frame
from railhil.bus.own_frames import OwnFrames
from railhil.bus.schedule import Schedule
from railhil.bus.store import TrafficStore
from railhil.common.digits import count_of
from railhil.common.exit_codes import FAIL, PASS
from railhil.common.patience import WallClock
from railhil.dbc import Port
from railhil.plant_sim.any_plant import Happened
from railhil.plant_sim.cycle import Milestones, TickLoop
from railhil.plant_sim.faults.plants import make_plant
from railhil.plant_sim.supervision import RunEndpoint
from railhil.record.trace import Trace
from railhil.run.answers import Fault, Form, constant_flags, ids_words, life_faults, value_faults, value_words
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

#: Polls of the first command, default wall time for an answer.
POLLS: Final = 10
PATIENCE_S: Final = 1.0
#: Wall time in which nothing may come: before the first poll, after the last one, after an answer that is not right.
_QUIET_NS: Final = 100_000_000
#: Interval between device status polls, and longest time in which an answer is waited for at once.
_LOOK_NS: Final = 100_000_000
_MS: Final = 1e6


@dataclass(frozen=True, slots=True)
class Answer:
    """A poll and its answer. ``tick``: -1 before the run; ``latency_ns``: wall time to the last frame, None: there was
    none; ``values``: signals in words, empty unless the bench would take the answer."""

    tick: int
    name: str
    latency_ns: int | None
    values: str


@dataclass(slots=True)
class Checked:
    """What was found. ``faults``: one line each; ``stated``: what the controller says of itself; ``lives``: life signs
    by port; ``notes``: one line for each flag that is never as usual; ``others``: number of frames with identifiers
    that the bench does not have."""

    answers: list[Answer] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    stated: dict[str, str] = field(default_factory=dict)
    lives: dict[str, list[int]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    others: int = 0

    @property
    def exit_code(self) -> int:
        """PASS without a fault, else FAIL."""
        return FAIL if self.faults else PASS

    def latencies_ms(self) -> dict[str, tuple[float, float, float]]:
        """Smallest, median and largest time of an answer, by the name of the poll."""
        found: dict[str, list[float]] = {}
        for answer in self.answers:
            if answer.latency_ns is not None:
                found.setdefault(answer.name, []).append(answer.latency_ns / _MS)
        return {name: (min(times), float(np.median(times)), max(times)) for name, times in found.items()}


class FirstCheck:
    """One check of the controller on an endpoint.

    :param run: scenario and pace; its ``patience_s`` is the wall time for an answer.
    :param fd: telegrams have the CAN FD form.
    :param appear_s: wall time for the controller to answer the device status poll.
    :param polls: of the first command.
    """

    def __init__(
        self,
        endpoint: RunEndpoint,
        scenario: AnyScenario,
        run: RunSpec,
        *,
        fd: bool = False,
        appear_s: float,
        polls: int = POLLS,
        wall: WallClock = time,
    ) -> None:
        system = scenario.installed_system
        contract = system.contract
        endpoint.lossless = not run.is_realtime
        self._endpoint, self._contract, self._fd = endpoint, contract, fd
        self._laws = system.laws
        self._polls, self._patience_ns, self._appear_ns = polls, round(run.patience_s * 1e9), round(appear_s * 1e9)
        self._pacer = Pacer(run.wall_rate, wall)
        self._monotonic_ns = wall.monotonic_ns
        self._plant, _ = make_plant(scenario, run)
        self._tick_ns = scenario.timing.base_tick_ns
        schedule = Schedule.from_contract(self._tick_ns, scenario.timing.port_period_ns, contract)
        self._queue = SendQueue(endpoint, contract, fd=fd, realtime=run.is_realtime)
        self._ident = make_ident(
            Role.PLANT, scenario.sha256, seed=run.seed, perturbed=run.perturbed, pace=run.pace, contract=contract
        )
        asked = [contract.port(name) for name in (*self._plant.commands, *self._plant.statuses)]
        self._store = TrafficStore([contract.port(CtlIdent.PORT), *asked])
        self._own = OwnFrames(contract)
        self._trace = Trace(contract)
        self._first_command = asked[0]
        self._asked = 0
        # Identifiers that the bench does not have, since the last poll of a port.
        self._other_ids: list[int] = []
        self._faults: dict[tuple[str, str], list[str]] = {}
        self._checked = Checked()
        #: Attributes of :class:`railhil.plant_sim.cycle.Surroundings`.
        self.ended: Event | None = None
        self.controller_lost = False
        self.publish = self._queue.publish
        self.milestones = Milestones(self.publish, self._tick_ns)
        makers = self._plant.makers
        clock_port = contract.clock_port.name
        self._loop = TickLoop(self._plant, self._plant.ending, schedule, self, makers, asked, clock_port)

    def check(self) -> Checked:
        """Handshake, polls and the end of the run.

        :raises PeerSilent: no controller answers.
        :raises BusOccupied: another bus administrator polls.
        :raises BusLost: the bus is gone.
        """
        self._expect_silence("before the first poll", _QUIET_NS)
        self._find_controller()
        try:
            self.publish(self._ident)
            self._ask(self._contract.port(CtlIdent.PORT), -1)
            self._compare()
            self._pacer.start()
            for _ in self._loop.ticks():
                if self._asked >= self._polls:
                    break
        finally:
            # A board or a node that has taken this for a run learns that it is over.
            self.milestones.end(Event.ENDED_BY_SUPERVISOR, self._plant.tick * self._tick_ns // 100_000, 0)
            self._queue.flush()
        self._expect_silence("after the end of the run", _QUIET_NS)
        for port in self._trace_ports():
            self._judge_values(port)
        found = self._checked
        found.faults = [f"{said[0]}{_times(len(said))}" for said in self._faults.values()]
        return found

    # -- the controller's answers -----------------------------------------------------------------------------------

    def _find_controller(self) -> None:
        """Poll the device status until there is an answer, right or not."""
        form = Form.of_device_status(self._contract, Role.CONTROLLER.value)
        poll = master_frame(F_DEVICE_STATUS, Role.CONTROLLER.value)
        deadline_ns = self._monotonic_ns() + self._appear_ns
        while self._monotonic_ns() < deadline_ns:
            sent_ns = self._monotonic_ns()
            self._endpoint.send([poll])
            if heard := self._heard(form, sent_ns, _LOOK_NS):
                frames = [frame for _, frame in heard]
                faults = list(form.faults(frames))
                self._note(faults)
                said = "" if faults else f"status {form.data(frames).hex()}"
                self._checked.answers.append(Answer(-1, form.name, heard[-1][0], said))
                return
        ids = ids_words(sorted(set(self._other_ids)))
        instead = f", but frames {ids} have come, right {ids_words(form.can_ids)}" if ids else ""
        raise PeerSilent(
            f"no controller answers the device status poll ({poll.can_id:03X}#{poll.data.hex().upper()}) "
            f"within {self._appear_ns / 1e9:g} s{instead}"
        )

    def _ask(self, port: Port, tick: int) -> None:
        """Poll a port, and look at the frames of its answer."""
        form = Form.of_port(port, self._fd)
        self._other_ids.clear()
        sent_ns = self._monotonic_ns()
        self._queue.poll(port)
        heard = self._heard(form, sent_ns, self._patience_ns)
        if not heard:
            instead = f", but frames {ids_words(self._other_ids)}" if self._other_ids else ""
            text = f"{port.name}: no answer within {self._patience_ns / 1e9:g} s{instead}"
            self._note([Fault("no answer", text)])
            self._checked.answers.append(Answer(tick, port.name, None, ""))
            return
        latency_ns = heard[-1][0]
        # In lockstep no time passes while an answer is on its way.
        taken = [self._store.feed(frame, at_ns if self._pacer.rate else 0) for at_ns, frame in heard]
        faults = list(form.faults([frame for _, frame in heard]))
        if self._pacer.rate and latency_ns > REPLY_NS:
            text = f"{port.name}: answer after {latency_ns / _MS:.1f} ms, in real time within {REPLY_NS / _MS:g} ms"
            faults.append(Fault("late", text))
        self._note(faults)
        values = ""
        if port.name in taken:
            self._trace.add(port.name, max(tick, 0) * self._tick_ns, self._store.raw(port.name))
            values = self._words(port)
        self._checked.answers.append(Answer(tick, port.name, latency_ns, values))

    def _heard(self, form: Form, sent_ns: int, limit_ns: int) -> list[tuple[int, Frame]]:
        """Frames of the bench after a poll, each with the wall time since then: until they are those of an answer, or
        nothing more comes."""
        heard: list[tuple[int, Frame]] = []
        deadline_ns = sent_ns + limit_ns
        while (left_ns := deadline_ns - self._monotonic_ns()) > 0:
            arrived = self._receive(min(left_ns, _LOOK_NS))
            heard += [(self._monotonic_ns() - sent_ns, frame) for frame in arrived]
            if tuple(frame.can_id for _, frame in heard) == form.can_ids:
                break
            if arrived:
                deadline_ns = self._monotonic_ns() + _QUIET_NS
            elif self._endpoint.has_ended(Role.CONTROLLER.name.lower()):
                break
        return heard

    def _receive(self, timeout_ns: int) -> list[Frame]:
        """Frames with identifiers of the bench; others are counted."""
        found = []
        for frame in self._endpoint.receive(timeout_ns / 1e9):
            if frame.can_id not in self._own.flags:
                self._checked.others += 1
                self._other_ids.append(frame.can_id)
            elif frame.can_id == self._contract.poll_id and frame in self._own:
                raise BusOccupied(OTHER_ADMINISTRATOR)
            else:
                found.append(frame)
        return found

    def _expect_silence(self, when: str, limit_ns: int) -> None:
        """Frames that nobody has asked for."""
        deadline_ns = self._monotonic_ns() + limit_ns
        while True:
            for frame in self._receive(max(0, deadline_ns - self._monotonic_ns())):
                self._note([Fault("unasked", f"frame {frame.can_id:03X}, which nobody asked for: {when}")])
            if self._monotonic_ns() >= deadline_ns:
                return

    def _note(self, faults: Sequence[Fault]) -> None:
        for fault in faults:
            self._faults.setdefault((fault.kind, fault.text.partition(":")[0]), []).append(fault.text)

    # -- what they say ----------------------------------------------------------------------------------------------

    def _compare(self) -> None:
        """The run that the controller states, beside that of the plant."""
        ident = self._store.read(CtlIdent, 0)[0]
        if ident is None:
            return
        self._note([Fault(text, text) for text in self._ident.differences(ident)])
        self._checked.stated = {
            "law": law_words(ident.law, self._laws) if ident.law else "not stated",
            "arithmetic": _stated(ARITHMETICS, ident.arithmetic),
            "indexing": _stated(INDEXINGS, ident.indexing),
        }

    def _trace_ports(self) -> list[Port]:
        return [self._contract.port(name) for name in self._store.ports if self._trace.count(name)]

    def _words(self, port: Port) -> str:
        """The signals of the newest telegram of a port."""
        newest = ((signal, int(self._trace.raw(port.name, signal.name)[-1])) for signal in port.signals)
        return ", ".join(f"{signal.name} {value_words(signal, raw)}" for signal, raw in newest)

    def _judge_values(self, port: Port) -> None:
        """Check variables, ranges and the life sign of all answers of a port."""
        for signal in port.signals:
            raws = self._trace.raw(port.name, signal.name).tolist()
            self._checked.notes += constant_flags(port, signal, raws)
            for raw in raws:
                self._note(value_faults(port, signal, raw))
        if port.life is not None:
            lives = self._trace.raw(port.name, port.life.name).tolist()
            self._checked.lives[port.name] = lives
            self._note(life_faults(port, port.life, lives))

    # -- the plant's environment (railhil.plant_sim.cycle.Surroundings) ----------------------------------------------

    def begin(self) -> None:
        """Wait for the instant of the tick."""
        self._pacer.wait(self._plant.tick * self._tick_ns)

    def report(self, event: Happened) -> None:
        """A telegram of the plant's own; milestones are not reported."""
        telegram: Telegram | None = self._plant.telegram_of(event)
        if telegram is not None:
            self.publish(telegram)

    def poll(self, port: Port) -> None:
        """Poll a port of the controller."""
        self._expect_silence("between two polls", 0)
        self._ask(port, self._plant.tick)
        self._asked += port is self._first_command

    def finish(self) -> None:
        """In real time, telegrams are not held back until the next poll."""
        if self._pacer.rate:
            self._queue.flush()

    def end(self, event: Event) -> None:
        """The plant has come to its end."""
        self.ended = event


def _stated(words: Sequence[str], code: int) -> str:
    if not code:
        return "not stated"
    return words[code] if code < len(words) else f"unknown code {code}"


def _times(count: int) -> str:
    return f" ({count_of(count, 'time')})" if count > 1 else ""
