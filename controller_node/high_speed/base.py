"""Common part of the laws of high-speed trains: units of measure, sampling period, and one loop per unit or one for
all.

A law of :class:`HighSpeedLaw` describes one loop: target speeds and one measured speed in, one acceleration out, at
each of its samples. Between samples its commands are held.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, fsum
from typing import Annotated, Any, ClassVar, Generic, Literal, NamedTuple, TypeVar

from pydantic import Field

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.high_speed.interface import COMMAND_Q, NOTE_COUNT_Q
from railhil.controller_node.vector.law import Answer, VectorLaw
from railhil.wire.power_units import (
    ACCEL_PER_MPS2,
    BRAKE,
    COAST,
    EMERGENCY,
    NOTES,
    PREVIEW,
    PREVIEW_STEP_S,
    SPEED_PER_MPS,
    TRACTION,
)

LoopState = TypeVar("LoopState")

#: Formats inside the laws: speeds (m/s) and estimates, accelerations (m/s2).
SPEED_Q = 20
ACCEL_Q = 24
#: Target ahead below which the train is to stand, m/s, and the least braking then, m/s^2 (D17: the linear models are
#: not valid at a standstill, and the reference alone lets a train creep).
_STILL_MPS, _HOLDING_MPS2 = 0.05, 0.3
#: Accelerations below this are coasting.
_COASTING_MPS2 = 0.0005


@dataclass(frozen=True)
class HighSpeedParameters:
    """Parameters of every law: its sampling period, a multiple of the node's, and what a loop controls.

    ``loop``: ``unit``: each power unit has a loop of its own; ``mean``: one loop on the mean speed, whose acceleration
    all units get; ``train``: one loop that reads all speeds and gives each unit its own acceleration (a law whose
    :attr:`HighSpeedLaw.loops` has it).
    """

    sample_period_s: Annotated[float, Field(gt=0, le=10)] = 1.0
    loop: Literal["unit", "mean", "train"] = "unit"


class LoopInputs(NamedTuple, Generic[T]):
    """Inputs of a loop, m/s: measured speed, present target, the 14 targets ahead; ``emergency`` is 0 or 1 (Q0).

    ``error``: target less speed. Of one unit it is the difference of the counts, which single precision has exactly.

    ``most``: largest command now, m/s2 (Q ``ACCEL_Q``); the holding brake's while the train is to be held.
    """

    speed: T
    target: T
    preview: tuple[T, ...]
    emergency: T
    most: T
    error: T


class LoopNotes(NamedTuple, Generic[T]):
    """Report of a law (Q ``SPEED_Q``): model error and residual (m/s), estimates of gain and delay (s)."""

    model_error: T
    xi: T
    gain: T
    delay: T


class LoopAnswer(NamedTuple, Generic[T]):
    """Result of a loop: acceleration in m/s2 (Q ``ACCEL_Q``), and its notes."""

    accel: T
    notes: LoopNotes[T]


@dataclass(frozen=True)
class LoopModel:
    """The train as a loop's model knows it: data of its unit, or means over the units."""

    gain: float
    lag_s: float
    traction_delay_s: float
    braking_delay_s: float


class _State(NamedTuple, Generic[T, LoopState]):
    """Periods since the last sample, last reading of the emergency; for each loop the last result and its own state."""

    period: T
    urgent: T
    held: tuple[LoopAnswer[T], ...]
    loops: tuple[LoopState, ...]


class HighSpeedLaw(VectorLaw[T, Any], Generic[T, LoopState]):
    """Base of the laws of ``hst1`` and ``emu3``; a law adds :meth:`loop_start` and :meth:`loop_step`.

    Set at construction: ``ar``, ``sample_s`` (T0), ``models`` (a :class:`LoopModel` for each loop), ``least`` and
    ``most`` (smallest and largest command), ``zero`` (Q-free).

    :raises InputError: the sampling period is not a multiple of the node's, or the law does not have the loop.
    """

    parameters_type: ClassVar[type[Any]] = HighSpeedParameters
    #: Values of the parameter ``loop`` that the law has.
    loops: ClassVar[tuple[str, ...]] = ("unit", "mean")
    #: Whether it holds the train at the end of the reference.
    holds = True

    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: Any = None) -> None:
        given = parameters or self.parameters_type()
        self.given = given
        self.ar = arithmetic
        task = scenario.task
        self.units = len(task.unit)
        if given.loop not in self.loops:
            raise InputError("parameters", "loop", given.loop, f"one of {', '.join(self.loops)} with {self.name}")
        self._per_unit = given.loop != "mean" or self.units == 1
        self.models = _models(task.unit, self._per_unit)
        period_s = scenario.timing.control_period_ns / 1e9
        self._periods = round(given.sample_period_s / period_s)
        if self._periods < 1 or abs(self._periods * period_s - given.sample_period_s) > 1e-9:
            allowed = f"a multiple of the control period, {period_s:g} s"
            raise InputError("parameters", "sample_period_s", given.sample_period_s, allowed)
        self.sample_s: float = given.sample_period_s
        self._held: list[Constant] = []
        self.zero = self.hold("zero", 0.0, 0, "law")
        self.least = self.hold("least", -task.braking_max_mps2, ACCEL_Q, "scenario")
        self.most = self.hold("most", task.traction_max_mps2, ACCEL_Q, "scenario")
        self._still = self.hold("still", _STILL_MPS, SPEED_Q, "law")
        self._holding = self.hold("holding", -min(_HOLDING_MPS2, task.braking_max_mps2), ACCEL_Q, "law")
        # A command given now brakes at this point of the preview.
        delay_s = max(unit.braking_delay_s for unit in task.unit)
        self._braked = min(max(ceil(delay_s / PREVIEW_STEP_S - 1e-9), 1), PREVIEW) - 1
        self._mps = self.hold("mps", 1.0 / SPEED_PER_MPS, 30, "port table")
        self._counts = self.hold("counts", ACCEL_PER_MPS2, 16, "port table")
        self._note_counts = [self.hold(f"{name}_counts", counts, 8, "port table") for name, counts in NOTES.items()]
        self._share = self.hold("share", 1.0 / self.units, 30, "scenario")
        self._one = self.hold("one", 1.0, 0, "law")
        self._last = self.hold("last_period", self._periods - 2, 0, "parameters")
        self._end = self.hold("end_period", self._periods - 1, 0, "parameters")
        modes = {"coast": COAST, "traction": TRACTION, "brake": BRAKE, "emergency": EMERGENCY}
        self._modes = [self.hold(name, mode, 0, "port table") for name, mode in modes.items()]
        self._coasting = [
            self.hold("coasting", _COASTING_MPS2, ACCEL_Q, "law"),
            self.hold("minus_coasting", -_COASTING_MPS2, ACCEL_Q, "law"),
        ]

    def hold(self, name: str, value: float, q: int, origin: str) -> T:
        """A constant of the law as an operand; all of them are in :attr:`constants`."""
        constant = Constant(name, value, q, origin)
        self._held.append(constant)
        return self.ar.const(constant)

    @property
    def constants(self) -> tuple[Constant, ...]:
        return tuple(self._held)

    @abstractmethod
    def loop_start(self, loop: int, inputs: LoopInputs[T]) -> LoopState:
        """The state of a loop before its first sample, from the inputs of that sample."""

    @abstractmethod
    def loop_step(self, loop: int, state: LoopState, inputs: LoopInputs[T]) -> tuple[LoopState, LoopAnswer[T]]:
        """One sample of a loop; the acceleration need not keep to the limits."""

    def loops_start(self, inputs: Sequence[LoopInputs[T]]) -> tuple[LoopState, ...]:
        """The states of all loops before their first sample."""
        return tuple(self.loop_start(loop, one) for loop, one in enumerate(inputs))

    def loops_step(
        self, states: Sequence[LoopState], inputs: Sequence[LoopInputs[T]]
    ) -> tuple[tuple[LoopState, ...], tuple[LoopAnswer[T], ...]]:
        """One sample of all loops."""
        rows = zip(states, inputs, strict=True)
        stepped = [self.loop_step(loop, state, one) for loop, (state, one) in enumerate(rows)]
        return tuple(state for state, _ in stepped), tuple(answer for _, answer in stepped)

    def no_notes(self) -> LoopNotes[T]:
        """The notes of a law that estimates nothing."""
        return LoopNotes(self.zero, self.zero, self.zero, self.zero)

    # -- the vector law -------------------------------------------------------------------------------------------

    def start(self, readings: Sequence[T]) -> _State[T, LoopState]:
        inputs = self._inputs(readings)
        nothing = LoopAnswer(self.zero, self.no_notes())
        return _State(self.zero, self.zero, (nothing,) * len(inputs), self.loops_start(inputs))

    def step(self, state: Any, readings: Sequence[T]) -> tuple[Any, Answer[T]]:
        ar = self.ar
        every = self._inputs(readings)
        ar.note("target", every[0].target, SPEED_Q, "m/s")
        for loop, inputs in enumerate(every):
            ar.note(f"measured[{loop}]", inputs.speed, SPEED_Q, "m/s")
        loops, wanted = self.loops_step(state.loops, every)
        limited = [ar.clip(answer.accel, one.most, self.least) for one, answer in zip(every, wanted, strict=True)]
        answers = tuple(
            LoopAnswer(ar.note(f"accel[{loop}]", limited[loop], ACCEL_Q, "m/s2"), answer.notes)
            for loop, answer in enumerate(wanted)
        )
        urgent = readings[-1]
        after = _State(self.zero, urgent, answers, loops)
        if self._periods > 1:
            # The trigger of an emergency is a sample, from which the next ones are counted.
            since = ar.where(ar.gt(urgent, state.urgent), self.zero, state.period)
            waits = ar.gt(since, self.zero)
            after = select_nested(ar, waits, state, after)
            # The minimum bounds the count for the interval analysis.
            count = ar.minimum(ar.add(since, self._one), self._end)
            period = ar.where(ar.gt(since, self._last), self.zero, count)
            after = after._replace(period=ar.note("period", period, 0), urgent=urgent)
        return after, self._answer(after.held, readings[-1])

    def _inputs(self, readings: Sequence[T]) -> list[LoopInputs[T]]:
        """The inputs of each loop, from the readings of the interface."""
        ar = self.ar
        numbers = [ar.mpy_iqx(reading, 0, self._mps, 30, SPEED_Q) for reading in readings[: self.units + PREVIEW + 1]]
        speeds, preview, target = numbers[: self.units], tuple(numbers[self.units : -1]), numbers[-1]
        if not self._per_unit:
            mean = speeds[0]
            for speed in speeds[1:]:
                mean = ar.add(mean, speed)
            speeds = [ar.mpy(mean, self._share, 30)]
            errors = [ar.sub(target, speeds[0])]
        else:
            counts = [ar.sub(readings[self.units + PREVIEW], reading) for reading in readings[: self.units]]
            errors = [ar.mpy_iqx(count, 0, self._mps, 30, SPEED_Q) for count in counts]
        # The last point of the preview tells the end of a journey from its start.
        ahead = ar.maximum(preview[self._braked], preview[-1])
        most = ar.where(ar.gt(self._still, ahead), self._holding, self.most) if self.holds else self.most
        pairs = zip(speeds, errors, strict=True)
        return [LoopInputs(speed, target, preview, readings[-1], most, error) for speed, error in pairs]

    def _answer(self, held: tuple[LoopAnswer[T], ...], emergency: T) -> Answer[T]:
        ar = self.ar
        commands: list[T] = []
        notes: list[T] = []
        for unit in range(self.units):
            accel, told = held[unit if self._per_unit else 0]
            coast, traction, brake, urgent = self._modes
            mode = ar.where(ar.gt(self._coasting[1], accel), brake, coast)
            mode = ar.where(ar.gt(accel, self._coasting[0]), traction, mode)
            mode = ar.where(ar.gt(emergency, self.zero), urgent, mode)
            commands += [ar.mpy_iqx(accel, ACCEL_Q, self._counts, 16, COMMAND_Q), mode]
            notes += [
                ar.mpy_iqx(value, SPEED_Q, counts, 8, NOTE_COUNT_Q)
                for value, counts in zip(told, self._note_counts, strict=True)
            ]
        return Answer(tuple(commands), tuple(notes))


def select_nested(ar: Arithmetic[T], condition: Any, a: Any, b: Any) -> Any:
    """``where`` for numbers in tuples of any depth: ``a`` where the condition is true, else ``b``."""
    if isinstance(a, tuple):
        parts = [select_nested(ar, condition, one, other) for one, other in zip(a, b, strict=True)]
        return type(a)(*parts) if hasattr(a, "_fields") else tuple(parts)
    return ar.where(condition, a, b)


def _models(units: Sequence[Any], per_unit: bool) -> tuple[LoopModel, ...]:
    rows = [(unit.gain, unit.lag_s, unit.traction_delay_s, unit.braking_delay_s) for unit in units]
    if not per_unit:
        # The exact sum: the result of `sum` depends on the version of Python.
        return (LoopModel(*(fsum(column) / len(rows) for column in zip(*rows, strict=True))),)
    return tuple(LoopModel(*row) for row in rows)
