"""``ilc_stop``, the paper's law: one braking curve, begun where it meets the stopping point, corrected from run to run.

    (6) margin m = (S - s) - f(v_hat) - b        (7) brake at the first cycle with m <= eps

The paper compares |m| with eps; then the window is jumped over with probability 1 - 2 eps / (v Tc), so the one-sided
test is the default (``two_sided`` shows the other one).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Generic, Literal, NamedTuple

from pydantic import Field

from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic.base import Constant, T
from railhil.controller_node.laws.memory import NOTHING, Remembered
from railhil.controller_node.stop.filters import FilterName, speed_filter
from railhil.controller_node.stop.interface import Measured
from railhil.controller_node.stop.law import Estimate, Order, StopLaw, StopParameters
from railhil.controller_node.stop.least_squares import LeastSquares, checked
from railhil.controller_node.stop.model import BrakeModel
from railhil.controller_node.stop.numbers import ACCEL_Q, DISTANCE_Q, GAIN_Q, SPEED_Q, TIME_Q

#: Slowest speed by which a start instant is computed, m/s.
_CRAWL_MPS = 0.1


@dataclass(frozen=True)
class IlcStopParameters(StopParameters):
    """Parameters of the law."""

    gamma: Annotated[float, Field(ge=0, le=3)] = 0.5
    innovation_sigmas: Annotated[float, Field(ge=0, le=10)] = 0.0
    filter: FilterName = "packet"
    #: Noise of a speed sample for which the Kalman filters are designed.
    noise_mps: Annotated[float, Field(gt=0, le=1)] = 0.01
    epsilon_m: Annotated[float, Field(ge=0, le=10)] = 0.4
    #: The paper's |m| <= eps, ``window``: without a fallback, ``window_or_late``: or m < -eps.
    trigger: Literal["one_sided", "window", "window_or_late"] = "one_sided"
    #: Begin inside the cycle, where m = eps, instead of at its beginning.
    start_inside_cycle: bool = False
    #: An offset for each load class, or the brake itself over speed and load (:mod:`.least_squares`; floats only).
    learning: Literal["offset", "rls_load", "none"] = "offset"


class Filtered(NamedTuple, Generic[T]):
    """State of the filter; acceleration of the brake model and its queue, if the filter needs them."""

    filter: Any
    accel: T
    queue: tuple[T, ...]
    braking: Any = ()
    #: Regressors and stopping distance (m) in this cycle, for the braking that may begin in it.
    now: Any = ()


class IlcStop(StopLaw[T]):
    """See the module."""

    name = "ilc_stop"
    parameters_type = IlcStopParameters
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {
        "epsilon_m": (0.05, 2.0),
        "first_offset_m": (-8.0, 8.0),
        "hold_per_s": (0.05, 1.0),
    }

    def __init__(
        self, arithmetic: Any, scenario: Any, parameters: IlcStopParameters | None = None, memory: Remembered = NOTHING
    ) -> None:
        super().__init__(arithmetic, scenario, parameters, memory)
        given: IlcStopParameters = self.given
        numbers, brake = self.numbers, self.task.brake
        self._filter = speed_filter(numbers, given.filter, given.noise_mps)
        self._model = None
        if given.filter == "kalman_command":
            self._model = BrakeModel(numbers, brake.delay_s, brake.lag_s, self.period_s)
            self._per_cycle = numbers.hold("per_cycle", 1.0 / self.period_s, 16, "scenario")
        self._epsilon = numbers.hold("epsilon", given.epsilon_m, DISTANCE_Q, "parameters")
        self._cycle = numbers.hold("cycle", self.period_s, GAIN_Q, "scenario")
        self._cycle_end = numbers.hold("cycle_end", self.period_s, TIME_Q, "scenario")
        # When the brake begins, at most the way of a cycle is left.
        self._squares = None
        if given.learning == "rls_load":
            if not arithmetic.wide:
                found = Words("rls_load in fixed point")
                raise InputError("parameters", "learning", found, "offset, or float64 or float32")
            stored = None if memory.values is None else memory.values.get("braking")
            self._squares = LeastSquares(arithmetic, stored, brake.delay_s, brake.lag_s)
        self._rest = [numbers.hold(f"rest_{m}", m, DISTANCE_Q, "law") for m in (2.0, 0.0)]
        self._crawl = numbers.hold("crawl", _CRAWL_MPS, SPEED_Q, "law")

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        brake = self.task.brake
        model = self._model.bounds("own", -brake.braking_max_mps2, brake.traction_max_mps2) if self._model else {}
        return {**super().state_bounds(), **model}

    @property
    def learns(self) -> bool:
        return bool(self.given.learning == "offset")

    @property
    def constants(self) -> tuple[Constant, ...]:
        return (*super().constants, *(self._squares.re.constants if self._squares else ()))

    @property
    def warm_up(self) -> int:
        # 128 samples are the window of the packet; slower filters need more.
        return max(128, self._filter.warm_up)

    def own_start(self, measured: Measured[T]) -> Any:
        steady = self.hold_speed(measured)
        queue = (steady,) * self._model.count if self._model else ()
        squares, zero = self._squares, self.numbers.zero
        braking, now = (squares.start(), ((zero,) * 3, zero)) if squares else ((), ())
        return Filtered(self._filter.start(measured.samples[-1]), steady, queue, braking, now)

    def estimate(
        self, own: Any, measured: Measured[T], samples: tuple[T, ...], fresh: T, accel: T
    ) -> tuple[Any, Estimate[T]]:
        ar = self.ar
        filtered, lagged, queue = own.filter, own.accel, own.queue
        known = self.numbers.hold("no_accel", 0.0, ACCEL_Q, "law")
        if self._model is not None:
            queue = (accel, *queue[:-1])
            lagged, gained = self._model.step(lagged, queue)
            known = ar.add(ar.mpy(gained, self._per_cycle, 16), self.grades.at(self.way_left(measured.odometer)))
        filtered, speed = self._filter.step(filtered, samples, known)
        own = own._replace(filter=filtered, accel=lagged, queue=queue)
        return own, Estimate(speed, self.way_left(measured.odometer))

    def stopping(self, own: Any, measured: Measured[T], speed: T, planned: T) -> tuple[Any, T]:
        if self._squares is None:
            return super().stopping(own, measured, speed, planned)
        now = self._squares.distance(own.braking, speed, planned, measured.load)
        return own._replace(now=now), now[1]

    def teach(self, own: Any, first: T, usable: T, measured: Measured[T]) -> Any:
        if self._squares is None:
            return own
        begun = self._squares.begin(own.braking, first, *own.now)
        return own._replace(braking=self._squares.step(begun, usable, measured.run, measured.error))

    def begins(self, estimate: Estimate[T], margin: T) -> T:
        ar, zero, one = self.ar, self.numbers.zero, self.numbers.one
        over = ar.sub(margin, self._epsilon)
        if self.given.start_inside_cycle:
            over = ar.sub(over, ar.mpy_iqx(estimate.speed, SPEED_Q, self._cycle, GAIN_Q, DISTANCE_Q))
        late = ar.where(ar.gt(over, self.numbers.hold("nothing", 0.0, DISTANCE_Q, "law")), zero, one)
        if self.given.trigger == "one_sided":
            return late
        below = ar.gt(ar.neg(self._epsilon), margin)
        inside = ar.where(below, zero, late)
        if self.given.trigger == "window":
            return inside
        return ar.where(below, one, inside)

    def brake(
        self, own: Any, estimate: Estimate[T], margin: T, last: T, offset: T, planned: T, missed: T, first: T
    ) -> tuple[Any, Order[T]]:
        ar = self.ar
        start = self.at_once
        if self.given.start_inside_cycle:
            rest = ar.clip(ar.sub(margin, self._epsilon), *self._rest)
            rest = ar.convert(rest, DISTANCE_Q, SPEED_Q)
            speed = ar.maximum(estimate.speed, self._crawl)
            start = ar.clip(ar.div(rest, speed, TIME_Q), self._cycle_end, self.at_once)
        # One command: the plan of the cycle in which the brake began.
        return own, Order(ar.where(ar.gt(first, self.numbers.zero), ar.neg(planned), last), start)

    # -- memory ---------------------------------------------------------------------------------------------------

    @classmethod
    def check_memory(cls, scenario: Any, values: Mapping[str, Any]) -> None:
        super().check_memory(scenario, values)
        if "braking" in values:
            checked(values["braking"])

    def memory(self, state: Any) -> Mapping[str, Any]:
        kept = dict(super().memory(state))
        if self._squares is not None:
            kept["braking"] = self._squares.memory(state.own.braking)
        return kept
