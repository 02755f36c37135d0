"""``reaim``, ours: the brake is aimed anew every 64 ms at the stopping point, with the estimated disturbance.

The train is propagated through the commands still on their way (delay). From there, with the lag tau and a command u
that stays, its speed and place equal a train's without lag that has ``ve = vp + (ap - u) tau`` and still has ``D = S -
b - sp + (ap - u) tau^2`` to go, so that::

    u = -ve^2 / (2 D) - d_hat

three times from the last u. The observer is a steady Kalman filter of the speed and a disturbance d (random walk)
beside the brake model and the grade map; balises correct the odometer. Learning from run to run moves the aim point.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Generic, NamedTuple

from pydantic import Field

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.laws.memory import NOTHING, Remembered
from railhil.controller_node.stop.filters import steady_gains
from railhil.controller_node.stop.interface import Measured
from railhil.controller_node.stop.law import Estimate, Order, StopLaw, StopParameters
from railhil.controller_node.stop.model import BrakeModel, Rolled
from railhil.controller_node.stop.numbers import ACCEL_Q, DISTANCE_Q, GAIN_Q, SPEED_Q, TIME_Q
from railhil.controller_node.stop.odometry import Odometry

#: The mean of the samples of a cycle is the speed this part of a cycle before its end.
_MEAN_BEFORE = 0.4
_AIMS = 3
#: Shortest way for which a command is computed, m, and bound of the disturbance, m/s2.
_SHORTEST_M = 0.05
_DISTURBANCE_MPS2 = 1.0
_NEEDED_MPS2 = 4.0
#: Samples in which the observer settles.
_SETTLED_SAMPLES = 512
#: Only a command that brakes at least so much stays at the end of the stop, m/s2: a law that begins there must brake.
_FROZEN_FROM_MPS2 = -0.2


@dataclass(frozen=True)
class ReaimParameters(StopParameters):
    """Parameters of the law."""

    sample_period_ms: Annotated[int, Field(ge=1, le=1024)] = 64
    observer: bool = True
    balises: bool = True
    learning: bool = True
    report_sigma_m: Annotated[float, Field(ge=0, le=10)] = 0.035
    #: Noise of a speed sample, and random walk of the disturbance, m/s2 in a second.
    noise_mps: Annotated[float, Field(gt=0, le=1)] = 0.01
    disturbance_walk: Annotated[float, Field(gt=0, le=1)] = 0.02
    wheel_sigma: Annotated[float, Field(gt=0, le=0.02)] = 0.002
    balise_sigma_m: Annotated[float, Field(gt=0, le=1)] = 0.03
    jerk_mps3: Annotated[float, Field(gt=0, le=10)] = 0.75
    #: Below this predicted speed the command stays.
    freeze_mps: Annotated[float, Field(gt=0, le=5)] = 0.45


class Aim(NamedTuple, Generic[T]):
    """Past commands, acceleration by the brake, speed, disturbance (SI), place, cycles to the next sample."""

    queue: tuple[T, ...]
    accel: T
    speed: T
    disturbance: T
    place: Any
    wait: T


class Reaim(StopLaw[T]):
    """See the module."""

    name = "reaim"
    parameters_type = ReaimParameters
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {
        "noise_mps": (0.002, 0.1),
        "disturbance_walk": (0.002, 0.2),
        "jerk_mps3": (0.2, 2.0),
        "freeze_mps": (0.1, 1.5),
    }
    warm_up = _SETTLED_SAMPLES

    def __init__(
        self, arithmetic: Any, scenario: Any, parameters: ReaimParameters | None = None, memory: Remembered = NOTHING
    ) -> None:
        super().__init__(arithmetic, scenario, parameters, memory)
        given: ReaimParameters = self.given
        numbers, task, period_s = self.numbers, self.task, self.period_s
        self._most_cycles = cycles = round(given.sample_period_ms / 1e3 / period_s)
        if cycles < 1 or abs(cycles * period_s * 1e3 - given.sample_period_ms) > 1e-6:
            allowed = f"a multiple of the control period, {period_s * 1e3:g} ms"
            raise InputError("parameters", "sample_period_ms", given.sample_period_ms, allowed)
        hold, origin = numbers.hold, "parameters"
        lag_s = task.brake.lag_s
        self._model = BrakeModel(numbers, task.brake.delay_s, lag_s, period_s)
        places_m = [task.stop_m - before_m - task.start_m for before_m in task.balises_m] if given.balises else []
        self._odometry = Odometry(numbers, places_m, given.wheel_sigma, given.balise_sigma_m)
        noise_mps = given.noise_mps / 5.0**0.5
        on_speed, on_disturbance = steady_gains(period_s, noise_mps, given.disturbance_walk)
        self._on_speed = hold("observer_speed", on_speed, GAIN_Q, "steady state of the Kalman filter")
        self._on_disturbance = hold(
            "observer_disturbance", on_disturbance, ACCEL_Q, "steady state of the Kalman filter"
        )
        self._cycle = hold("cycle", period_s, GAIN_Q, "scenario")
        self._fifth = hold("fifth", 0.2, GAIN_Q, "law")
        self._before = hold("mean_before", _MEAN_BEFORE, GAIN_Q, "law")
        self._disturbed = [hold(f"disturbance_{sign}", sign * _DISTURBANCE_MPS2, ACCEL_Q, "law") for sign in (1, -1)]
        self._lag = hold("model_lag", lag_s, TIME_Q, "scenario")
        self._lag_squared = hold("model_lag_squared", lag_s * lag_s, TIME_Q, "scenario")
        self._half = hold("half", 0.5, GAIN_Q, "law")
        self._shortest = hold("shortest", _SHORTEST_M, DISTANCE_Q, "law")
        self._longest = hold("longest", 20_000.0, DISTANCE_Q, "law")
        self._still = hold("still", 0.0, SPEED_Q, "law")
        self._released = hold("released", 0.0, ACCEL_Q, "law")
        sample_jerk = given.jerk_mps3 * cycles * period_s
        self._sample_jerk = [hold(f"sample_jerk_{sign}", sign * sample_jerk, ACCEL_Q, origin) for sign in (1, -1)]
        self._freeze = hold("freeze", given.freeze_mps, SPEED_Q, origin)
        self._frozen_from = hold("frozen_from", _FROZEN_FROM_MPS2, ACCEL_Q, "law")
        self._ramp = hold("ramp", 0.5 / given.jerk_mps3, ACCEL_Q, origin)
        self._cycles = hold("sample_cycles", cycles - 1, 0, origin)
        self._needed = [hold("needed_max", _NEEDED_MPS2, 20, "law"), hold("needed_min", 0.0, 20, "law")]
        self._rest = hold("no_margin", 0.0, DISTANCE_Q, "law")

    def state_bounds(self) -> dict[str, tuple[float, float]]:
        brake = self.task.brake
        model = self._model.bounds("own", -brake.braking_max_mps2, brake.traction_max_mps2)
        return {**super().state_bounds(), **model, "own.wait": (0.0, float(self._most_cycles))}

    @property
    def learns(self) -> bool:
        return bool(self.given.learning)

    def own_start(self, measured: Measured[T]) -> Aim[T]:
        steady = self.hold_speed(measured)
        queue = (steady,) * self._model.count
        return Aim(queue, steady, measured.samples[-1], self._released, self._odometry.start(), self.numbers.zero)

    def estimate(
        self, own: Aim[T], measured: Measured[T], samples: tuple[T, ...], fresh: T, accel: T
    ) -> tuple[Aim[T], Estimate[T]]:
        ar, held = self.ar, self.numbers
        queue = (accel, *own.queue[:-1])
        lagged, gained = self._model.step(own.accel, queue)
        place, run = self._odometry.step(own.place, measured)
        left = self.way_left(run)
        outside = ar.add(self.grades.at(left), own.disturbance)
        gained = ar.add(gained, ar.mpy(outside, self._cycle, GAIN_Q))
        guess = ar.add(own.speed, held.rounded(gained, ACCEL_Q, SPEED_Q))
        mean = ar.dot((self._fifth,) * len(samples), samples, GAIN_Q)
        earlier = ar.sub(guess, held.rounded(ar.mpy(gained, self._before, GAIN_Q), ACCEL_Q, SPEED_Q))
        error = ar.clip(ar.sub(mean, earlier), held.fastest, held.slowest)
        # Without new samples, and at standstill, the model continues alone.
        error = ar.where(ar.gt(fresh, measured.standstill), error, self._still)
        speed = ar.clip(ar.add(guess, ar.rmpy(error, self._on_speed, GAIN_Q)), held.fastest, self._still)
        disturbance = ar.add(own.disturbance, ar.rmpy(error, self._on_disturbance, SPEED_Q))
        disturbance = ar.note("disturbance", ar.clip(disturbance, *self._disturbed), ACCEL_Q, "m/s2")
        return Aim(queue, lagged, speed, disturbance, place, own.wait), Estimate(speed, left)

    def reserve(self, speed: T, planned: T) -> T:
        # The command falls with limited jerk: half the time that it takes passes without braking.
        ramp_s = self.ar.mpy(planned, self._ramp, ACCEL_Q)
        return self.ar.mpy_iqx(speed, SPEED_Q, ramp_s, ACCEL_Q, DISTANCE_Q)

    def begins(self, estimate: Estimate[T], margin: T) -> T:
        return self.ar.where(self.ar.gt(margin, self._rest), self.numbers.zero, self.numbers.one)

    def brake(
        self, own: Aim[T], estimate: Estimate[T], margin: T, last: T, offset: T, planned: T, missed: T, first: T
    ) -> tuple[Aim[T], Order[T]]:
        ar, zero, one = self.ar, self.numbers.zero, self.numbers.one
        observed = own.disturbance if self.given.observer else self._released
        now = Rolled(ar.sub(estimate.left, offset), estimate.speed, own.accel)
        then = self._model.predict(now, ar.add(self.grades.at(estimate.left), observed), own.queue)
        left = ar.clip(then.left, self._longest, self._shortest)
        outside = ar.add(self.grades.mean(left), observed)
        command = last
        for _ in range(_AIMS):
            lagging = ar.sub(then.accel, command)
            speed = ar.add(then.speed, ar.mpy_iqx(lagging, ACCEL_Q, self._lag, TIME_Q, SPEED_Q))
            speed = ar.clip(speed, self.numbers.fastest, self._still)
            way = ar.add(left, ar.mpy_iqx(lagging, ACCEL_Q, self._lag_squared, TIME_Q, DISTANCE_Q))
            way = ar.clip(way, self._longest, self._shortest)
            squared = ar.mpy_iqx(ar.mpy(speed, self._half, GAIN_Q), SPEED_Q, speed, SPEED_Q, DISTANCE_Q)
            needed = ar.clip(ar.div(squared, way, 20), *self._needed)
            command = ar.sub(ar.neg(ar.convert(needed, 20, ACCEL_Q)), outside)
            command = ar.clip(command, self._released, self.least)
        change = ar.clip(ar.sub(command, last), *self._sample_jerk)
        aimed = ar.clip(ar.add(last, change), self._released, self.least)
        frozen = ar.where(ar.gt(self._freeze, then.speed), last, aimed)
        aimed = ar.where(ar.gt(self._frozen_from, last), frozen, aimed)
        aimed = ar.where(ar.gt(missed, zero), last, aimed)
        due = ar.gt(one, ar.where(ar.gt(first, zero), zero, own.wait))
        wait = ar.where(due, self._cycles, ar.maximum(ar.sub(own.wait, one), zero))
        return own._replace(wait=wait), Order(ar.where(due, aimed, last), self.at_once)
