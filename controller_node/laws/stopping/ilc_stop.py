"""``ilc_stop``, the paper's law: one braking curve, begun where it meets the stopping point, corrected from run to run.

    (6) margin m = (S - s) - f(v_hat) - b        (7) brake at the first cycle with m <= eps

The paper compares |m| with eps; then the window is jumped over with probability 1 - 2 eps / (v Tc), so the one-sided
test is the default (``two_sided`` shows the other one).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Generic, Literal, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.laws.memory import NOTHING, Remembered
from railhil.controller_node.laws.stopping.filters import FilterName, speed_filter
from railhil.controller_node.laws.stopping.law import Estimate, Order, StopLaw, StopParameters
from railhil.controller_node.laws.stopping.model import BrakeModel
from railhil.controller_node.laws.stopping.numbers import ACCEL_Q, DISTANCE_Q, GAIN_Q, SPEED_Q, TIME_Q
from railhil.controller_node.laws.stopping.readings import Measured

#: Slowest speed by which a start instant is computed, m/s.
_CRAWL_MPS = 0.1


@dataclass(frozen=True)
class IlcStopParameters(StopParameters):
    """Parameters of the law."""

    gamma: Annotated[float, Field(ge=0, le=3)] = 0.5
    innovation_sigmas: Annotated[float, Field(ge=0, le=10)] = 0.0
    filter: FilterName = "packet"
    #: Noise of a speed sample that the Kalman filters are made for.
    noise_mps: Annotated[float, Field(gt=0, le=1)] = 0.01
    epsilon_m: Annotated[float, Field(ge=0, le=10)] = 0.4
    #: The paper's |m| <= eps, ``window``: without a fallback, ``window_or_late``: or m < -eps.
    trigger: Literal["one_sided", "window", "window_or_late"] = "one_sided"
    #: Begin inside the cycle, where m = eps, instead of at its beginning.
    start_inside_cycle: bool = False
    learning: Literal["offset", "none"] = "offset"


class Filtered(NamedTuple, Generic[T]):
    """State of the filter; acceleration of the brake model and its queue, if the filter needs them."""

    filter: Any
    accel: T
    queue: tuple[T, ...]


class IlcStop(StopLaw[T]):
    """See the module."""

    name = "ilc_stop"
    parameters_type = IlcStopParameters

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
        self._crawl = numbers.hold("crawl", _CRAWL_MPS, SPEED_Q, "law")

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        brake = self.task.brake
        model = self._model.bounds("own", -brake.braking_max_mps2, brake.traction_max_mps2) if self._model else {}
        return {**super().state_bounds(), **model}

    @property
    def learns(self) -> bool:
        return bool(self.given.learning != "none")

    @property
    def warm_up(self) -> int:
        # 128 samples are the window of the packet; slower filters need more.
        return max(128, self._filter.warm_up)

    def own_start(self, measured: Measured[T]) -> Any:
        steady = self.steady(measured)
        queue = (steady,) * self._model.count if self._model else ()
        return Filtered(self._filter.start(measured.samples[-1]), steady, queue)

    def estimated(
        self, own: Any, measured: Measured[T], samples: tuple[T, ...], fresh: T, accel: T
    ) -> tuple[Any, Estimate[T]]:
        ar = self.ar
        filtered, lagged, queue = own
        known = self.numbers.hold("no_accel", 0.0, ACCEL_Q, "law")
        if self._model is not None:
            queue = (accel, *queue[:-1])
            lagged, gained = self._model.step(lagged, queue)
            known = ar.add(ar.mpy(gained, self._per_cycle, 16), self.grades.at(self.way_left(measured.odometer)))
        filtered, speed = self._filter.step(filtered, samples, known)
        return Filtered(filtered, lagged, queue), Estimate(speed, self.way_left(measured.odometer))

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
            rest = ar.convert(ar.sub(margin, self._epsilon), DISTANCE_Q, SPEED_Q)
            speed = ar.maximum(estimate.speed, self._crawl)
            start = ar.clip(ar.div(rest, speed, TIME_Q), self._cycle_end, self.at_once)
        # One command: the plan of the cycle in which the brake began.
        return own, Order(ar.where(ar.gt(first, self.numbers.zero), ar.neg(planned), last), start)
