"""The controller's node for a law for several units: takes readings, answers polls with commands and notes."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

from railhil.bus.acceptance import Acceptance
from railhil.bus.ident import CtlIdent
from railhil.bus.layout import Telegram
from railhil.bus.responder import Reading, Responder
from railhil.bus.telegrams import RunEvent, TimeSync
from railhil.common.errors import InputError
from railhil.controller_node.laws import law_class
from railhil.controller_node.node import LawNode
from railhil.controller_node.vector.controller import VectorController, VectorOutput
from railhil.controller_node.vector.law import Interface, VectorLaw
from railhil.dbc import Contract, Port
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec
from railhil.scenarios.system import System


def sources_of(interface: Interface) -> dict[str, type[Telegram]]:
    """Ports with readings, in the order of the readings, each with its telegram."""
    found: dict[str, type[Telegram]] = {}
    for reading in interface.readings:
        found.setdefault(reading.telegram.PORT, reading.telegram)
    return found


@dataclass(slots=True)
class _Source:
    """One port with readings: process data and time of the last accepted telegram."""

    acceptance: Acceptance
    age_max_ns: int
    data: bytes = b""
    taken_ns: int = 0


class Readings:
    """Takes the telegrams with an interface's readings from a responder.

    Only an accepted telegram (:class:`railhil.bus.acceptance.Acceptance`) updates the readings; their age is the time
    since its arrival. ``counters``: refused telegrams by cause.

    :raises InputError: the life sign of a telegram is not a number of 4 bits.
    """

    def __init__(self, interface: Interface, responder: Responder) -> None:
        self.counters: Counter[str] = Counter()
        self._interface = interface
        self._clock = responder.clock
        self._store = responder.store
        self._sources: dict[str, _Source] = {}
        self._kinds = sources_of(interface)
        for port, kind in self._kinds.items():
            ages_ns = [interface.age_max_ns(item) for item in interface.readings if port == item.telegram.PORT]
            self._sources[port] = _Source(Acceptance(kind, self.counters), min(ages_ns))
            responder.on(kind, partial(self._take, port), port)

    def _take(self, port: str, reading: Reading[Any]) -> None:
        source = self._sources[port]
        if source.acceptance.accept(reading.telegram):
            # If this is a TIME_SYNC, it has already set the clock.
            source.data, source.taken_ns = self._store.raw(port), self._clock.own_ns

    def are_fresh(self) -> bool:
        """Whether every reading has an accepted telegram, none of them older than its largest age."""
        now_ns = self._clock.own_ns
        return all(source.data and now_ns - source.taken_ns <= source.age_max_ns for source in self._sources.values())

    def read_raws(self) -> list[int]:
        """One raw integer for each reading, from the last accepted telegrams; call only when :meth:`are_fresh`."""
        telegrams = {port: kind.decode(self._sources[port].data) for port, kind in self._kinds.items()}
        return [getattr(telegrams[item.telegram.PORT], item.field) for item in self._interface.readings]


def status_telegram(
    interface: Interface, kind: type[Telegram], output: VectorOutput | None, steps: int, life: int
) -> Telegram:
    """One of an interface's statuses; a note is limited to the range of its signal, so that a large one ends no run.

    :param output: the law's last result; None before its first step.
    :param steps: of the law since the start of the run.
    :param life: life sign of the telegram.
    """
    ranges = {name: signal.raw_range for name, signal in kind.signals()}
    fields = {"step_count": steps & 0xFFFF, "life": life}
    if output is not None:
        fields["overflow_flags"] = output.overflow_flags
        for note, raw in zip(interface.notes, output.notes, strict=True):
            if interface.status_of(note) is kind:
                low, high = ranges[note.field]
                fields[note.field] = min(max(raw, low), high)
    return kind(**{name: value for name, value in fields.items() if name in ranges})


def ports_of(contract: Contract, interface: Interface) -> tuple[list[Port], list[Port]]:
    """Ports that a controller of this interface receives (the clock port first), and ports that it sends."""
    read = [*(item.telegram.PORT for item in interface.readings), TimeSync.PORT, RunEvent.PORT]
    answered = [kind.PORT for kind in (*(item.telegram for item in interface.commands), *interface.statuses)]
    sides = ([contract.clock_port.name, *read], [*answered, CtlIdent.PORT])
    received, sent = ([contract.port(name) for name in dict.fromkeys(side)] for side in sides)
    return received, sent


def refuse_indexing(system: System, law: LawSpec) -> None:
    """Refuse set-points by distance: laws for several units have set-points by time.

    :raises InputError: ``law`` has another indexing.
    """
    if law.indexing != "time":
        raise InputError("command line", "--indexing", law.indexing, f"time with system {system.name}")


class VectorNode(LawNode):
    """See :class:`railhil.controller_node.controller.AnyController`; the system has a part ``interface``.

    :param controller: computes the commands; None: one is made for ``law``.
    :param bit_rate: of the bus in bit/s; ignored here, since no time stamps are counted in bit times.
    :raises InputError: an option that this controller does not support.
    """

    #: Class of the object that computes the commands.
    computes: ClassVar[type[Any]] = VectorController

    def __init__(
        self,
        scenario: AnyScenario,
        law: LawSpec,
        controller: VectorController | None = None,
        *,
        fd: bool = False,
        bit_rate: int | None = None,
    ) -> None:
        system = scenario.installed_system
        contract = system.contract
        if law.task_period_ms:
            raise InputError("command line", "--task-period-ms", law.task_period_ms, f"0 with system {system.name}")
        refuse_indexing(system, law)
        super().__init__(scenario, law, law_class(law, scenario, VectorLaw), controller)
        self.lost_messages = 0
        self.lost_by_mailbox: dict[str, int] = {}
        self._interface: Interface = system.part("interface")
        self._output: VectorOutput | None = None
        self._stale = 0
        self._life: dict[str, int] = {}
        sent = dict.fromkeys(item.telegram for item in self._interface.commands)
        answers: dict[str, Any] = {kind.PORT: partial(self._command, kind) for kind in sent}
        answers |= {kind.PORT: partial(self._status, kind) for kind in self._interface.statuses}
        received, _ = ports_of(contract, self._interface)
        self._readings = Readings(self._interface, self.attach(received, answers, fd=fd))

    @property
    def counters(self) -> dict[str, int]:
        """Counters of refused telegrams, by cause; ``stale``: safe commands sent because a reading was too old."""
        counted = self.responder.store.counters + self._readings.counters
        return {**counted, **({"stale": self._stale} if self._stale else {})}

    def _control(self) -> bool:
        """Run the law if a control period has begun since its last step; returns whether its commands may be sent."""
        fresh = self._readings.are_fresh()
        k = self._clock.now_ns // self._control_ns
        if fresh and self._clock.running and k != self._last_k:
            self._output, self._last_k = self.controller.step(self._readings.read_raws()), k
            self._steps += 1
        return fresh and self._output is not None

    def _next_life(self, port: str) -> int:
        self._life[port] = life = (self._life.get(port, -1) + 1) & 0xF
        return life

    def _command(self, kind: type[Telegram]) -> Telegram:
        may_be_sent = self._control()
        output, commands = self._output, self._interface.commands
        values = tuple(item.safe for item in commands)
        if output is not None and may_be_sent:
            values = output.commands
        elif output is not None:
            self._stale += 1
            self.controller.sent(*values)
        fields = {item.field: raw for item, raw in zip(commands, values, strict=True) if item.telegram is kind}
        fields["life"] = self._next_life(kind.PORT)
        return kind(**fields)

    def _status(self, kind: type[Telegram]) -> Telegram:
        return status_telegram(self._interface, kind, self._output, self._steps, self._next_life(kind.PORT))
