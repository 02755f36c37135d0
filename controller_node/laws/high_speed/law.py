"""Base of the laws of the high-speed trains: readings and commands of the bus, sampling, one core for each unit."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from typing import Annotated, Any, Generic, Literal, NamedTuple

from pydantic import Field

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.laws.high_speed.core import Core, Move, Sample, Unit
from railhil.controller_node.laws.high_speed.reals import Reals
from railhil.controller_node.vector.law import Answer, VectorLaw
from railhil.scenarios.system import system_named

#: Points of the reference: w(t + j * 0.25 s), j = 0..14.
PREVIEW = 14
PREVIEW_STEP_S = 0.25
#: Counts on the wire.
SPEED_PER_MPS = 360.0
ACCEL_PER_MPS2 = 1000.0
NOTES = {"model_error": 10_000.0, "xi": 10_000.0, "gain": 1000.0, "delay": 1000.0}

#: Lowest speed in the power limit, m/s: it keeps the quotient finite.
_CRAWL_MPS = 1.0
#: Modes of a command.
COAST, TRACTION, BRAKE, EMERGENCY = range(4)


@dataclass(frozen=True, slots=True)
class LawParameters:
    """Parameters of every law of the high-speed trains."""

    #: T0, a multiple of the control period of the node; between two samples the command is held (D1).
    sample_period_s: Annotated[float, Field(gt=0, le=10)] = 1.0
    #: Three units: one law each, or one on their mean speed with equal acceleration for all.
    loop: Literal["units", "mean"] = "units"
    #: Run also a horizon that ends before the command acts, and a loop that is not stable.
    override: bool = False


def between(place: float) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Points of the preview and their weights for the reference at ``place`` steps of the preview from now.

    Linear between two points; behind the last one the last slope goes on.
    """
    low = min(int(place + 1e-9), PREVIEW - 1)
    share = place - low
    if abs(share) < 1e-9:
        return (low,), (1.0,)
    if abs(share - 1.0) < 1e-9:
        return (low + 1,), (1.0,)
    return (low, low + 1), (1.0 - share, share)


class State(NamedTuple, Generic[T]):
    """``phase``: control periods since the last sample; ``cores``: the units' states; ``moves``: their last results."""

    phase: T
    cores: tuple[Any, ...]
    moves: tuple[Move[T], ...]


class HighSpeedLaw(VectorLaw[T, State[T]]):
    """A law made of one core for each power unit.

    :raises InputError: a sampling period that is not a multiple of the control period, or what :meth:`core` refuses.
    """

    parameters_type = LawParameters
    floating = True

    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: Any = None) -> None:
        given = parameters or self.parameters_type()
        self.parameters = given
        self.re = re = Reals(arithmetic)
        self._periods = self._multiple(given.sample_period_s, scenario.timing.control_period_ns / 1e9)
        task = scenario.task
        units = [
            Unit(unit.traction_delay_s, unit.braking_delay_s, unit.lag_s, given.sample_period_s) for unit in task.unit
        ]
        self._unit_count = len(units)
        if given.loop == "mean":
            units = [_mean(units)]
        self.cores: tuple[Core[T, Any], ...] = tuple(self.core(re, unit, given) for unit in units)
        self._lowest = re.number("lowest", -task.braking_max_mps2, "scenario, braking_max_mps2")
        self._traction = re.number("traction", task.traction_max_mps2, "scenario, traction_max_mps2")
        self._power = re.number("power", task.power_w_per_kg, "scenario, power_kw by mass")
        self._crawl = re.number("crawl", _CRAWL_MPS)
        self._share = re.number("share", 1.0 / self._unit_count)
        self._speed_scale = re.number("speed_scale", 1.0 / SPEED_PER_MPS, "port table")
        self._accel_scale = re.number("accel_scale", ACCEL_PER_MPS2, "port table")
        self._accel_back = re.number("accel_back", 1.0 / ACCEL_PER_MPS2, "port table")
        self._note_scales = {name: re.number(f"{name}_scale", counts, "port table") for name, counts in NOTES.items()}
        steps = given.sample_period_s / PREVIEW_STEP_S
        self._instants = [
            (places, re.numbers(f"preview_{i}", shares))
            for i in range(max(core.horizon for core in self.cores) + 1)
            for places, shares in [between(i * steps)]
        ]
        self._last = re.number("last_period", self._periods - 1.5)
        self._half = re.number("half", 0.5)
        self._modes = re.numbers("mode", range(4), "port table")
        self._bind([reading.name for reading in system_named(scenario.system).part("interface").readings])

    def _bind(self, names: list[str]) -> None:
        """Places of the readings."""
        several = self._unit_count > 1
        speeds = [f"speed_{i + 1}" if several else "speed" for i in range(self._unit_count)]
        self._speeds = [names.index(name) for name in speeds]
        self._preview = [names.index(f"ref{j}") for j in range(PREVIEW + 1)]
        self._emergency = names.index("emergency")

    def _multiple(self, sample_period_s: float, control_period_s: float) -> int:
        periods = round(sample_period_s / control_period_s)
        if periods < 1 or abs(periods * control_period_s - sample_period_s) > 1e-9:
            allowed = f"a multiple of the control period, {control_period_s:g} s"
            raise InputError("controller", f"{self.name}, sample_period_s", sample_period_s, allowed)
        return periods

    @abstractmethod
    def core(self, re: Reals[T], unit: Unit, parameters: Any) -> Core[T, Any]:
        """The law of one power unit."""

    @property
    def constants(self) -> tuple[Constant, ...]:
        return tuple(self.re.constants)

    def _samples(self, readings: Sequence[T]) -> list[Sample[T]]:
        re = self.re
        speeds = [re.mul(readings[place], self._speed_scale) for place in self._speeds]
        if len(self.cores) < self._unit_count:
            speeds = [re.mul(re.add(*speeds), self._share)]
        preview = [re.mul(readings[place], self._speed_scale) for place in self._preview]
        reference = tuple(
            preview[places[0]] if len(places) == 1 else re.dot(shares, [preview[i] for i in places])
            for places, shares in self._instants
        )
        samples = []
        for speed in speeds:
            highest = re.ar.minimum(self._traction, re.div(self._power, re.ar.maximum(speed, self._crawl)))
            samples.append(Sample(speed, reference, self._lowest, highest))
        return samples

    def start(self, readings: Sequence[T]) -> State[T]:
        samples, zero = self._samples(readings), self.re.zero
        states = tuple(core.start(sample) for core, sample in zip(self.cores, samples, strict=True))
        return State(zero, states, (Move(zero, zero, zero, self.re.one, zero),) * len(self.cores))

    def step(self, state: State[T], readings: Sequence[T]) -> tuple[State[T], Answer[T]]:
        re = self.re
        stepped = [
            core.step(old, sample)
            for core, old, sample in zip(self.cores, state.cores, self._samples(readings), strict=True)
        ]
        states, moves = tuple(new for new, _ in stepped), tuple(move for _, move in stepped)
        phase = state.phase
        if self._periods > 1:
            due = re.gt(self._half, phase)
            states = re.select(due, states, state.cores)
            moves = re.select(due, moves, state.moves)
            phase = re.ar.where(re.gt(phase, self._last), re.zero, re.add(phase, re.one))
        return State(phase, states, moves), self._answer(moves, readings[self._emergency])

    def _answer(self, moves: tuple[Move[T], ...], emergency: T) -> Answer[T]:
        re, ar, zero = self.re, self.re.ar, self.re.zero
        if len(moves) < self._unit_count:
            moves = moves * self._unit_count
        coast, traction, brake, called = self._modes
        commands: list[T] = []
        notes: list[T] = []
        for move in moves:
            count = re.mul(move.command, self._accel_scale)
            mode = ar.where(re.gt(count, self._half), traction, coast)
            mode = ar.where(re.gt(re.neg(self._half), count), brake, mode)
            commands += [count, ar.where(re.gt(emergency, zero), called, mode)]
            notes += [re.mul(getattr(move, name), scale) for name, scale in self._note_scales.items()]
        return Answer(tuple(commands), tuple(notes))

    def with_sent(self, state: State[T], commands: Sequence[T]) -> State[T]:
        """The commands really sent are those that the model has to know; the law's own come with the next sample."""
        re = self.re
        sent = [re.mul(count, self._accel_back) for count in commands[::2]]
        cores = zip(self.cores, state.cores, sent, strict=False)
        return state._replace(cores=tuple(core.sent(old, command) for core, old, command in cores))


def _mean(units: list[Unit]) -> Unit:
    """One unit in place of several: means of delays and lags."""
    means = [sum(values) / len(units) for values in zip(*(astuple(unit) for unit in units), strict=True)]
    return Unit(*means)
