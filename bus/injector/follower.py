"""Simulation time, true motion, events and orders of a run, from the frames that pass a node.

The injectors of all nodes use it, so that a trigger means the same at each of them. Time comes from a port that no
fault disturbs: at the plant from the port that opens the ticks, before any fault; at other nodes from the truth.
"""

from __future__ import annotations

from collections.abc import Mapping

from railhil.bus.codes import Event, FaultOrder, ends_run
from railhil.bus.frame import Frame
from railhil.bus.schedule import Schedule
from railhil.bus.store import TrafficStore
from railhil.bus.telegrams import RunEvent, SupCmd, TimeSync
from railhil.dbc import Contract, Port, Signal
from railhil.faults.activity import MotionEvents
from railhil.faults.capability import life_signal
from railhil.faults.model import Injection
from railhil.faults.truth import Truth


def raw_of(data: bytes, signal: Signal) -> int:
    """Raw value of a signal in process data."""
    value = (int.from_bytes(data) >> len(data) * 8 - signal.first_bit - signal.length) % (1 << signal.length)
    return value - (1 << signal.length) if value > signal.raw_range[1] else value


class _Value:
    """One signal of the truth, in its unit."""

    def __init__(self, port: Port, name: str) -> None:
        self._signal = next((one for one in port.signals if one.name == name), None) if name else None

    def of(self, data: bytes) -> float:
        return 0.0 if self._signal is None else raw_of(data, self._signal) * self._signal.scale


class TrueMotion:
    """The train's true motion, from the telegrams of the truth, and the events that it makes."""

    def __init__(self, truth: Truth, port: Port) -> None:
        self.port = port.name
        self._position, self._speed = _Value(port, truth.position), _Value(port, truth.speed)
        self._acceleration, self._traction = _Value(port, truth.acceleration), _Value(port, truth.traction)
        self._events = MotionEvents()

    def read(self, data: bytes) -> tuple[float, float, list[str]]:
        """Position in m, speed in m/s, and the events of the next telegram."""
        speed_mps = self._speed.of(data)
        events = self._events.seen(speed_mps, self._acceleration.of(data), self._traction.of(data))
        return self._position.of(data), speed_mps, events


class Levels:
    """Levels of the watches, and the events that their changes make.

    :param signals: the level of each port.
    """

    def __init__(self, signals: Mapping[str, Signal]) -> None:
        self._signals = signals
        self._last: dict[str, int] = {}

    def read(self, port: str, data: bytes) -> list[str]:
        """The events of a telegram: the new level, in lower case; none if it is not new, or the port has none."""
        signal = self._signals.get(port)
        if signal is None:
            return []
        level = raw_of(data, signal)
        if level == self._last.get(port, 0):
            return []
        self._last[port] = level
        return [signal.values.get(level, "")]


class Follower:
    """Follows one run.

    :param at_plant: the frames are the plant's own, before any fault.
    """

    def __init__(self, injection: Injection, contract: Contract, schedule: Schedule, *, at_plant: bool) -> None:
        truth = injection.truth
        #: Simulation time of the present tick; -1 before the first.
        self.now_ns = -1
        self.position_m = 0.0
        self.speed_mps = 0.0
        #: Simulated seconds per wall second, as told by TIME_SYNC; 0: lockstep, or not known.
        self.rate = 0.0
        #: The event that ended the run.
        self.ended: Event | None = None
        #: Events since :meth:`take_events`, in lower case.
        self._events: list[str] = []
        #: Orders by hand: number of the fault (or an octet), and the order.
        self._orders: list[tuple[int, int]] = []
        self._own_events = injection.events
        clock = contract.clock_port if at_plant or truth is None else contract.port(truth.port)
        self._clock = clock.name
        #: Identifiers of the port that carries the time.
        self.clock_ids = {*clock.can_ids, clock.fd_id}
        self._period_ns = schedule.ticks(clock.name) * schedule.base_tick_ns
        self._life_signal = life_signal(clock)
        self._life = -1
        self._event_number = 0
        self._motion = None if truth is None else TrueMotion(truth, contract.port(truth.port))
        levels = {} if truth is None else truth.levels
        self._levels = Levels({port: contract.port(port).signal(level) for port, level in levels.items()})
        followed = [clock.name, RunEvent.PORT, SupCmd.PORT, TimeSync.PORT, *levels]
        followed += [] if truth is None else [truth.port]
        ports = [contract.port(name) for name in dict.fromkeys(followed)]
        self._store = TrafficStore(ports)
        self._followed = {can_id for port in ports for can_id in (*port.can_ids, port.fd_id)}

    def wall_s(self, duration_s: float) -> float:
        """A simulated duration on the wall clock."""
        return duration_s / (self.rate or 1.0)

    def see(self, frame: Frame) -> bool:
        """Take a frame in bus order; True if it begins a new instant."""
        if frame.can_id not in self._followed:
            return False
        name = self._store.feed(frame, max(self.now_ns, 0))
        if name is None:
            return False
        data = self._store.raw(name)
        new = name == self._clock and self._tick(data)
        motion = self._motion
        if motion is not None and name == motion.port:
            self.position_m, self.speed_mps, events = motion.read(data)
            self._events += events
        elif name == RunEvent.PORT:
            self._milestone(RunEvent.decode(data))
        elif name == TimeSync.PORT:
            self.rate = TimeSync.decode(data).rate_10th / 10
        elif name == SupCmd.PORT:
            order = SupCmd.decode(data)
            if order.fault_order != FaultOrder.NONE:
                self._orders.append((order.fault_number, order.fault_order))
        self._events += self._levels.read(name, data)
        return new

    def take_events(self) -> list[str]:
        """Events since the last call."""
        found, self._events = self._events, []
        return found

    def take_orders(self) -> list[tuple[int, int]]:
        """Orders by hand since the last call."""
        found, self._orders = self._orders, []
        return found

    def _tick(self, data: bytes) -> bool:
        step = 1
        if self._life_signal is not None:
            modulus = 1 << self._life_signal.length
            life = raw_of(data, self._life_signal)
            # Lost ones are bridged; a repeated one is not a new instant.
            step = (life - self._life) % modulus if self._life >= 0 else 1
            self._life = life
        self.now_ns = 0 if self.now_ns < 0 else self.now_ns + step * self._period_ns
        return step > 0

    def _milestone(self, event: RunEvent) -> None:
        if event.number == self._event_number:
            return
        self._event_number = event.number
        code = event.event
        known = Event(code).name.lower() if code in Event._value2member_map_ else self._own_events.get(code, "")
        self._events.append(known)
        if ends_run(code):
            self.ended = Event(code)
