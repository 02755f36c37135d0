"""The slave side of the bus: the one place where a frame enters a node, and the answers to the administrator's polls.

A frame passes through :meth:`Responder.handle` from top to bottom: the clock counts it, the CAN module keeps or loses
it; then either it is a poll and is answered, or it is fed to the store, and a telegram completed by it goes to the
handler of its port. The frame is checked only once, for the clock or when it is read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any, Final, Generic, NamedTuple, Protocol, TypeVar

from railhil.bus.clock import BusClock
from railhil.bus.frame import Frame
from railhil.bus.layout import Telegram
from railhil.bus.lifesign import MAX_STEP
from railhil.bus.mvb import F_DEVICE_STATUS, TelegramSource, device_status_frame, parse_master_frame
from railhil.bus.schedule import Schedule
from railhil.bus.store import FrameCheck, TrafficStore
from railhil.bus.telegrams import TimeSync
from railhil.dbc import Contract, Port

#: Bits of the life sign of a port that counts time for the clock, see :func:`slow_port`.
_LIFE_BITS: Final = 4
#: Period and master word of :func:`pace_of` where there is none.
_NO_PACE: Final = (0, -1)
#: Device status word: class 2/3 device, nothing to report (IEC 61375-3-1, type nibble 1).
_STATUS_READY: Final = 0x1000

T = TypeVar("T", bound=Telegram)
T_co = TypeVar("T_co", bound=Telegram, covariant=True)


class Reading(NamedTuple, Generic[T_co]):
    """A telegram as passed to its handler.

    ``received_ns``: the clock's ``own_ns`` at its arrival, in the past if a task has read it late. ``stamp``: the same
    from the CAN module's counter, in bit times; None without a module.
    """

    telegram: T_co
    received_ns: int
    stamp: int | None


#: :class:`Reading` of a whole tuple, as :data:`railhil.bus.frame.quick_frame`.
_quick_reading: Final[Callable[[tuple[Any, int, int | None]], Reading[Any]]] = partial(tuple.__new__, Reading)


def slow_port(received: Iterable[Port], clock_port: Port, schedule: Schedule) -> Port | None:
    """The slowest received port whose life sign counts time (:meth:`BusClock.slow`). Its period is longer than the
    clock port's, and its life sign is the last 4 bits of its data. None: there is none."""

    def counts(port: Port) -> bool:
        end = 8 * port.data_bytes
        return (
            port.mode == "publish"
            and port.name in schedule.periods_ns
            and port.name != TimeSync.PORT
            and schedule.ticks(port.name) > schedule.ticks(clock_port.name)
            and any(s.name.endswith("Life") and s.first_bit == end - _LIFE_BITS for s in port.signals)
        )

    return max(filter(counts, received), key=lambda port: schedule.ticks(port.name), default=None)


def pace_of(own: Iterable[Port], schedule: Schedule) -> tuple[int, int]:
    """The fastest port of which a node is the source: its polls are the second time base of its clock.

    A port slower than the life sign can bridge is not used: its extra polls would be taken for lost time.

    :returns: its period in ticks, and the master word that polls it; (0, -1): there is none.
    """
    fast = (port for port in own if port.period_ns and schedule.ticks(port.name) <= MAX_STEP)
    return min(((schedule.ticks(port.name), port.f_code << 12 | port.address) for port in fast), default=_NO_PACE)


def _last_octet(data: bytes) -> int:
    return data[-1]


class CanModule(Protocol):
    """The CAN module of a node, if it is modelled: which frames it loses, and when its mailboxes are read.

    ``has_task``: some mailboxes are read by a task, the others at once.
    """

    has_task: bool

    def receive(self, frame: Frame, checked: FrameCheck | None, now_ns: int) -> int | None:
        """Take a frame; returns its time stamp if it is read at once, None if it is lost or waits for a task."""

    def read_due(self, now_ns: int) -> Sequence[tuple[Frame, FrameCheck | None, int, int]]:
        """The frames that a task reads now: frame, its check if there was one, arrival (simulation time, ns), time
        stamp."""


class Responder:
    """Handles one frame at a time; it has no socket, so it runs in a process of its own or in memory.

    :param device: MVB device address, answered to device status polls.
    :param schedule: base tick, and the period of every port in ticks.
    :param sinks: ports with a mailbox, including the clock port.
    :param answers: for each port of which this node is the source, the function that makes the telegram when it is
        polled.
    :param module: the node's CAN module; None: every frame of its ports is read at once.
    :param contract: of the run's system.
    :param paced: the polls of its own ports are the second time base of its clock, and the slowest port with a life
        sign the third; False: the clock has another time base.
    :param begins: these polls may also begin the time, see :meth:`BusClock.polled`; none may come before the run.
    """

    def __init__(
        self,
        device: int,
        schedule: Schedule,
        sinks: Iterable[Port],
        answers: Mapping[str, Callable[[], Telegram]],
        *,
        fd: bool = False,
        contract: Contract,
        module: CanModule | None = None,
        paced: bool = True,
        begins: bool = False,
    ) -> None:
        clock_port = contract.clock_port
        sinks = tuple(sinks)
        self.store = TrafficStore(sinks)
        self.clock = BusClock(schedule.base_tick_ns, schedule.ticks(clock_port.name), self.store.counters)
        self._device = device
        self._module = module
        self._poll_id = contract.poll_id
        # The module of a classic chip does not receive the CAN FD form.
        self._clock_ids = (clock_port.address, clock_port.fd_id) if module is None else (clock_port.address,)
        # For each port, the class that decodes its telegrams and the handler, of each receiver in the node.
        self._handlers: dict[str, list[tuple[Callable[[bytes], Any], Callable[[Any], None]]]] = {}
        if TimeSync.PORT in self.store.ports:
            self.on(TimeSync, self._synchronise)
        slow = slow_port(sinks, clock_port, schedule) if paced else None
        if slow is not None:
            self._slow_ticks = schedule.ticks(slow.name)
            self._handlers.setdefault(slow.name, []).append((_last_octet, self._count))
        self._answers = {
            contract.port(name).f_code << 12 | contract.port(name).address: (
                TelegramSource(contract.port(name), fd),
                make,
            )
            for name, make in answers.items()
        }
        self._pace = pace_of(map(contract.port, answers), schedule) if paced else _NO_PACE
        self._begins = begins

    def on(self, telegram: type[T], handler: Callable[[Reading[T]], None], port: str = "") -> None:
        """Call ``handler`` with each telegram that is accepted on a port, decoded as ``telegram``; it is called after
        the handlers that the port already has.

        :param port: another port with this layout, for trains with several units; default: the telegram's own.
        :raises KeyError: when this node has no mailbox for the port.
        """
        name = port or telegram.PORT
        if name not in self.store.ports:
            raise KeyError(name)
        telegram.make_codec()
        self._handlers.setdefault(name, []).append((telegram.decode, handler))

    def handle(self, frame: Frame) -> list[Frame]:
        """Take one frame in bus order; returns the answer to a poll of this node, otherwise nothing."""
        can_id, data, flags = frame
        checked = None
        if can_id in self._clock_ids:
            # Advance the time first, regardless of who reads the mailbox, so that all handlers get the right time.
            checked = self.store.check(frame)
            if not checked.cause:
                self.clock.feed(data)
        now_ns, stamp = self.clock.own_ns, None
        module = self._module
        if module is not None:
            if module.has_task:
                # The task is due at the start of the tick, before the tick's frames.
                self._read_due(module)
            stamp = module.receive(frame, checked, now_ns)
            if stamp is None:
                return []
        if can_id == self._poll_id and not flags:
            return self._answer(data)
        self._deliver(frame, checked, now_ns, stamp)
        return []

    def opens_tick(self, frame: Frame) -> bool:
        """Use a frame of the clock port for the clock only, not for its mailbox; True when it opened a new tick."""
        return not self.store.check(frame).cause and self.clock.feed(frame.data)

    def _read_due(self, module: CanModule) -> None:
        for frame, checked, received_ns, stamp in module.read_due(self.clock.own_ns):
            self._deliver(frame, checked, received_ns, stamp)

    def _deliver(self, frame: Frame, checked: FrameCheck | None, received_ns: int, stamp: int | None) -> None:
        port = self.store.feed(frame, received_ns, checked)
        if port is not None:
            for decode, handler in self._handlers.get(port, ()):
                handler(_quick_reading((decode(self.store.raw(port)), received_ns, stamp)))

    def _count(self, reading: Reading[Any]) -> None:
        self.clock.slow(reading.telegram & (1 << _LIFE_BITS) - 1, self._slow_ticks, reading.received_ns)

    def _synchronise(self, reading: Reading[TimeSync]) -> None:
        self.clock.synchronise(reading.telegram)

    def _answer(self, data: bytes) -> list[Frame]:
        asked = parse_master_frame(data)
        if asked is None:
            self.store.counters["wrong_master_word"] += 1
            return []
        f_code, address = asked
        if f_code == F_DEVICE_STATUS:
            return [device_status_frame(self._device, _STATUS_READY)] if address == self._device else []
        word = f_code << 12 | address
        found = self._answers.get(word)
        if found is None:
            return []
        period_ticks, pace_word = self._pace
        if word == pace_word:
            self.clock.polled(period_ticks, self._begins)
            # The poll itself may have opened the tick if the clock frame is missing.
            if self._module is not None and self._module.has_task:
                self._read_due(self._module)
        source, make = found
        return source.frames(make().encode())
