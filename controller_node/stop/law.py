"""Common part of the stopping laws: the order of a cycle, from speed and place to stage, command and learning.

Stages (:mod:`.stages`): start (a), accelerate (b), track (c), armed (d1), brake (d2), standstill (d3), learn (d4).
A law of this kind decides when the brake begins and gives its commands.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Generic, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.laws.memory import NOTHING, Remembered
from railhil.controller_node.stop.interface import COUNT_MAX, Gap, Inputs, Measured, Outputs
from railhil.controller_node.stop.learning import Learned, Learning, LearningRule, OffsetMemory, Report, stored_records
from railhil.controller_node.stop.model import Grades, StoppingDistance
from railhil.controller_node.stop.numbers import ACCEL_Q, DISTANCE_Q, SPEED_Q, TIME_Q, Numbers
from railhil.controller_node.stop.stages import Approach, Stages
from railhil.controller_node.vector.law import Answer, VectorLaw
from railhil.wire.stop import BrakeLevel

#: A law that begins further than this from the start of the run joins a run under way, m. Chosen: the first readings
#: are complete within 0.3 s.
_JOINED_M = 10.0
#: An estimate that has not settled defers the brake by at most this, s: a train whose estimate never settles must not
#: pass the platform. Chosen: longer than ``ilc_stop`` needs to settle.
_LATE_S = 0.5


@dataclass(frozen=True)
class StopParameters:
    """Parameters of every stopping law."""

    #: gamma of the learning; 0: the rule max(1/j, 0.3).
    gamma: Annotated[float, Field(ge=0, le=3)] = 0.0
    #: Offset before the first run; a positive one makes the first run undershoot.
    first_offset_m: Annotated[float, Field(ge=-12, le=12)] = 0.0
    #: Width of the innovation test in standard deviations of the last stops; 0: no test.
    innovation_sigmas: Annotated[float, Field(ge=0, le=10)] = 3.0
    #: Non-repeating scatter of a stop and its measurement; the gain is reduced where no other error is left. 0: the
    #: gain stays.
    report_sigma_m: Annotated[float, Field(ge=0, le=10)] = 0.0
    #: Gain with which the approach holds its speed, 1/s.
    hold_per_s: Annotated[float, Field(ge=0, le=2)] = 0.2


class Estimate(NamedTuple, Generic[T]):
    """``speed``: m/s, by which the brake is planned. ``left``: to the stopping point, m, without the learned offset."""

    speed: T
    left: T


class Order(NamedTuple, Generic[T]):
    """Action of the brake: command (m/s2) and the instant in the cycle from which it acts (s, Q ``TIME_Q``)."""

    accel: T
    start: T


class StopState(NamedTuple, Generic[T]):
    """State of a law; ``late``: cycles since the brake should have begun; ``own`` is the state of its estimate and of
    its brake."""

    gap: Gap[T]
    stage: T
    cruise: T
    cruising: T
    late: T
    accel: T
    braking: T
    learned: Learned[T]
    own: Any


class StopLaw(VectorLaw[T, StopState[T]]):
    """Base of the stopping laws."""

    parameters_type: ClassVar[type[Any]] = StopParameters
    parameters_origin = "ours; the paper prints none"

    def __init__(
        self, arithmetic: Arithmetic[T], scenario: Any, parameters: Any = None, memory: Remembered = NOTHING
    ) -> None:
        self.given = given = parameters or self.parameters_type()
        self.ar = arithmetic
        self.numbers = numbers = Numbers(arithmetic)
        self.task = task = scenario.task
        self.period_s: float = scenario.timing.control_period_ns / 1e9
        hold, origin = numbers.hold, "scenario"
        self.inputs = Inputs(numbers)
        self.distance = StoppingDistance(numbers, task.brake.delay_s, task.brake.lag_s)
        self.grades = Grades(numbers, task.grade, task.start_m, task.stop_m)
        self.offsets = OffsetMemory(numbers, memory.values, given.first_offset_m)
        rule = LearningRule(given.gamma, given.innovation_sigmas, given.report_sigma_m, self.learns)
        self.learning = Learning(numbers, self.offsets, rule)
        self._way = hold("way", task.stop_m - task.start_m, DISTANCE_Q, origin)
        self._plans = [
            hold("planned_dry", task.brake.braking_mps2, ACCEL_Q, origin),
            hold("planned_wet", task.brake.wet_braking_mps2, ACCEL_Q, origin),
        ]
        self.most = hold("accel_max", task.brake.traction_max_mps2, ACCEL_Q, origin)
        self.least = hold("accel_min", -task.brake.braking_max_mps2, ACCEL_Q, origin)
        self._stages = Stages(numbers)
        self._approach = Approach(numbers, self.grades, task, given.hold_per_s, self.period_s)
        self._outputs = Outputs(numbers, memory)
        self._cut = hold("cut", BrakeLevel.HOLD, 0, "port table")
        self._joined = hold("joined", _JOINED_M, DISTANCE_Q, "law")
        self._nothing = hold("no_distance", 0.0, DISTANCE_Q, "law")
        self._late = hold("late", round(_LATE_S / self.period_s), 0, "law")
        self._count_max = hold("count_max", COUNT_MAX, 0, "law")
        self._no_accel = hold("no_accel", 0.0, ACCEL_Q, "law")
        self.at_once = hold("at_once", 0.0, TIME_Q, "law")

    @property
    def constants(self) -> tuple[Constant, ...]:
        return tuple(self.numbers.constants)

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        # Counters and the command grow slowly up to limits that the interval analysis would take too long to find.
        brake = self.task.brake
        return {
            "gap.missed": (0.0, COUNT_MAX),
            "gap.samples": (0.0, COUNT_MAX),
            "late": (0.0, COUNT_MAX),
            "accel": (-brake.braking_max_mps2, brake.traction_max_mps2),
        }

    # -- what a law adds ------------------------------------------------------------------------------------------

    @property
    @abstractmethod
    def learns(self) -> bool:
        """Whether the offset is corrected after a run."""

    @property
    @abstractmethod
    def warm_up(self) -> int:
        """Samples of the speed before the brake may be armed."""

    @abstractmethod
    def own_start(self, measured: Measured[T]) -> Any:
        """State of the law's own part before the first step."""

    @abstractmethod
    def estimate(
        self, own: Any, measured: Measured[T], samples: tuple[T, ...], fresh: T, accel: T
    ) -> tuple[Any, Estimate[T]]:
        """Speed and place. ``accel``: the command of the last cycle, m/s2; ``fresh``: 1 with new samples (Q0)."""

    @abstractmethod
    def begins(self, estimate: Estimate[T], margin: T) -> T:
        """1 if the brake begins in this cycle (Q0). ``margin``: distance left before it has to begin, m."""

    @abstractmethod
    def brake(
        self, own: Any, estimate: Estimate[T], margin: T, last: T, offset: T, planned: T, missed: T, first: T
    ) -> tuple[Any, Order[T]]:
        """The command while the brake is on, computed in each cycle.

        :param last: command of the last cycle; ``planned``: planned deceleration, m/s2. :param missed: 1 while the
            speed is unknown (Q0). :param first: 1 in the cycle in which the brake begins.
        """

    def reserve(self, speed: T, planned: T) -> T:
        """Distance by which the brake begins before the stopping distance of a sudden brake, m (Q ``DISTANCE_Q``)."""
        return self.numbers.hold("no_reserve", 0.0, DISTANCE_Q, "law")

    def stopping(self, own: Any, measured: Measured[T], speed: T, planned: T) -> tuple[Any, T]:
        """Stopping distance from ``speed`` (m/s) with the planned deceleration (m/s2), m (Q ``DISTANCE_Q``)."""
        return own, self.distance(speed, planned).distance

    def teach(self, own: Any, first: T, usable: T, measured: Measured[T]) -> Any:
        """The law's own part after the brake began (``first`` is 1) or a stop was reported (``usable`` is 1)."""
        return own

    # -- the vector law -------------------------------------------------------------------------------------------

    def start(self, readings: Sequence[T]) -> StopState[T]:
        zero = self.numbers.zero
        measured = self.inputs.decode(readings)
        return StopState(
            self.inputs.start(measured),
            zero,
            self._approach.start(measured.samples[-1]),
            zero,
            zero,
            self.hold_speed(measured),
            self._nothing,
            # A law that joins a run under way, as after a restart of its controller, has lost the readings before.
            self.learning.start(measured.load, measured.wet)._replace(spoiled=self._joins(measured)),
            self.own_start(measured),
        )

    def step(self, state: Any, readings: Sequence[T]) -> tuple[Any, Answer[T]]:
        ar, zero, one = self.ar, self.numbers.zero, self.numbers.one
        measured = self.inputs.decode(readings)
        gap, samples, fresh = self.inputs.bridge_gap(state.gap, measured)
        refused = self.inputs.judge_gap(gap, self.warm_up)
        own, estimate = self.estimate(state.own, measured, samples, fresh, state.accel)
        speed = ar.note("v_hat", estimate.speed, SPEED_Q, "m/s")
        left = ar.note("left", estimate.left, DISTANCE_Q, "m")
        planned = ar.where(ar.gt(measured.wet, zero), self._plans[1], self._plans[0])
        own, stopping = self.stopping(own, measured, speed, planned)
        distance = ar.note("f", ar.add(stopping, self.reserve(speed, planned)), DISTANCE_Q, "m")
        offset = state.learned.before.offset
        margin = ar.note("margin_m", ar.sub(ar.sub(left, distance), offset), DISTANCE_Q, "m")

        late = ar.where(ar.gt(self._nothing, margin), ar.minimum(ar.add(state.late, one), self._count_max), zero)
        refused = ar.where(ar.gt(late, self._late), zero, refused)
        begins = self.begins(estimate, margin)
        done = state.learned.learned
        arrived = measured.standstill if self.task.start_kmh else ar.minimum(measured.standstill, self._joins(measured))
        stage = self._stages.advance(state.stage, measured, speed, state.cruise, margin, refused, begins, done, arrived)

        warm = ar.maximum(state.cruising, ar.sub(one, refused))
        cruise = self._approach.speed(state.cruise, speed, state.cruising, warm)
        pulled = self._approach.command(cruise, speed, warm, left, state.accel)
        pulled = ar.where(ar.gt(stage, self._stages.idle), pulled, state.accel)

        on = ar.gt(stage, self._stages.armed)
        first = ar.where(on, ar.where(ar.gt(self._stages.braking, state.stage), one, zero), zero)
        missed = ar.where(ar.gt(gap.missed, zero), one, zero)
        own, order = self.brake(own, estimate, margin, state.accel, offset, planned, missed, first)
        accel = ar.clip(ar.where(on, order.accel, pulled), self.most, self.least)
        accel = ar.note("accel", accel, ACCEL_Q, "m/s2")
        # From here on the command is the one sent to the train, so that no model has another one.
        code = self._outputs.code(accel)
        accel = self._on_the_bus(code)
        start = ar.where(ar.gt(first, zero), order.start, self.at_once)

        # The braking distance of the run, for the innovation test.
        distance_used = ar.where(ar.gt(first, zero), distance, state.braking)
        ready = ar.where(ar.gt(stage, self._stages.braking), one, zero)
        by_itself = ar.where(ar.gt(measured.level, self._cut), one, zero)
        spoiled = ar.where(ar.gt(ready, zero), zero, ar.maximum(measured.slide, by_itself))
        learned = self.learning.step(
            state.learned, ready, spoiled, measured.run, Report(measured.report, measured.error), distance_used
        )

        taught = ar.where(ar.gt(learned.learned, state.learned.learned), ar.sub(one, learned.spoiled), zero)
        own = self.teach(own, first, taught, measured)

        new = StopState(gap, stage, cruise, warm, late, accel, distance_used, learned, own)
        return new, self._outputs.answer(stage, code, start, margin, distance, speed, state.learned.before)

    def _joins(self, measured: Measured[T]) -> T:
        """1 if the run is under way (Q0)."""
        return self.ar.where(self.ar.gt(measured.odometer, self._joined), self.numbers.one, self.numbers.zero)

    def _on_the_bus(self, code: T) -> T:
        """The command (m/s2) that is on the bus as ``code`` (mm/s2, Q0)."""
        return self.ar.clip(self._outputs.accel(code), self.most, self.least)

    def with_sent(self, state: Any, commands: Sequence[T]) -> Any:
        """The train does not take an invalid command, and nothing is learned from such a run."""
        ar, zero = self.ar, self.numbers.zero
        code, _, valid = commands
        lost = ar.where(ar.gt(valid, zero), zero, self.numbers.one)
        accel = ar.where(ar.gt(valid, zero), self._on_the_bus(code), state.accel)
        learned = state.learned._replace(spoiled=ar.maximum(state.learned.spoiled, lost))
        return state._replace(accel=accel, learned=learned)

    # -- memory ---------------------------------------------------------------------------------------------------

    @classmethod
    def memory_key(cls, scenario: Any) -> str:
        task = scenario.task
        return f"{task.train} {task.platform} {task.direction}"

    @classmethod
    def check_memory(cls, scenario: Any, values: Mapping[str, Any]) -> None:
        stored_records(values)

    def memory(self, state: Any) -> Mapping[str, Any]:
        return self.offsets.after(state.learned)

    def hold_speed(self, measured: Measured[T]) -> T:
        """The command with which a train that runs keeps its speed, m/s2; 0 for one that stands."""
        kept = self._approach.hold_speed(self.way_left(measured.odometer))
        return self.ar.where(self.ar.gt(measured.standstill, self.numbers.zero), self._no_accel, kept)

    def way_left(self, odometer: T) -> T:
        """Distance to the stopping point by the odometer, m."""
        return self.ar.sub(self._way, odometer)
