"""A bank of Kalman filters of [v, d, K], one for each extra transport delay: an estimate of the delay during the run.

All filters read the same speeds; they differ in when the commands act. The score of a filter is its sum of squared
prediction errors by their variances, with forgetting. The nominal delay is used unless another one's score is smaller
by a margin, so that noise does not change the delay.

A filter is v+ = v + T0 d + K g, with d and K random walks. ``g`` is the speed that the commands alone give in the
period (:class:`.delay_line.Rolled`), so it is known.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Generic, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.delay_line import DelayLines
from railhil.controller_node.high_speed.law import Unit
from railhil.controller_node.vector.reals import Reals

#: Periods after which a filter has settled at the latest, and the change of a gain that ends the count.
_SETTLED, _STEADY = 20_000, 1e-9


class Belief(NamedTuple, Generic[T]):
    """Estimates and the upper triangle of their covariance.

    ``speed`` m/s, ``disturbance`` m/s^2, ``gain`` (1 nominal); ``covariance``: vv, vd, vK, dd, dK, KK.
    """

    speed: T
    disturbance: T
    gain: T
    covariance: tuple[T, ...]


class Noise(NamedTuple, Generic[T]):
    """Variances: of a reading, and the additions in each period to the variances of speed, disturbance and gain."""

    reading: T
    speed: T
    disturbance: T
    gain: T


class Innovation(NamedTuple, Generic[T]):
    """v - v_hat (m/s) and its variance."""

    error: T
    variance: T


def predict(re: Reals[T], old: Belief[T], gained: T, period: T, noise: Noise[T]) -> Belief[T]:
    """The belief one period later, before the reading.

    :param gained: speed that the commands give with gain 1, m/s; ``period``: T0, s.
    """
    vv, vd, vk, dd, dk, kk = old.covariance
    speed = re.add(old.speed, re.add(re.mul(period, old.disturbance), re.mul(gained, old.gain)))
    # F P: the first row of F is 1, T0, g.
    on_v = re.add(vv, re.add(re.mul(period, vd), re.mul(gained, vk)))
    on_d = re.add(vd, re.add(re.mul(period, dd), re.mul(gained, dk)))
    on_k = re.add(vk, re.add(re.mul(period, dk), re.mul(gained, kk)))
    new_vv = re.add(on_v, re.add(re.mul(period, on_d), re.mul(gained, on_k)))
    return Belief(
        speed,
        old.disturbance,
        old.gain,
        (re.add(new_vv, noise.speed), on_d, on_k, re.add(dd, noise.disturbance), dk, re.add(kk, noise.gain)),
    )


def correct(re: Reals[T], old: Belief[T], reading: T, noise: Noise[T]) -> tuple[Belief[T], Innovation[T]]:
    """The belief after a reading of the speed, m/s."""
    vv, vd, vk, dd, dk, kk = old.covariance
    error = re.sub(reading, old.speed)
    variance = re.add(vv, noise.reading)
    on_v, on_d, on_k = (re.div(x, variance) for x in (vv, vd, vk))
    # (1 - on_v) vv without the difference of two large numbers.
    left = re.div(noise.reading, variance)
    after = (
        re.mul(left, vv),
        re.mul(left, vd),
        re.mul(left, vk),
        re.sub(dd, re.mul(on_d, vd)),
        re.sub(dk, re.mul(on_d, vk)),
        re.sub(kk, re.mul(on_k, vk)),
    )
    belief = Belief(
        re.add(old.speed, re.mul(on_v, error)),
        re.add(old.disturbance, re.mul(on_d, error)),
        re.add(old.gain, re.mul(on_k, error)),
        after,
    )
    return belief, Innovation(error, variance)


def steady_gains(re: Reals[float], period: float, noise: Noise[float]) -> tuple[float, float]:
    """Gains on speed (1) and disturbance (1/s) after many periods without a command, when K is not observed.

    :param period: T0, s.
    """
    belief = Belief(0.0, 0.0, 1.0, (noise.reading, 0.0, 0.0, noise.reading, 0.0, 0.0))
    gains = (0.0, 0.0)
    for _ in range(_SETTLED):
        before = predict(re, belief, 0.0, period, noise)
        vv, vd, *_ = before.covariance
        belief, innovation = correct(re, before, 0.0, noise)
        last, gains = gains, (vv / innovation.variance, vd / innovation.variance)
        if max(abs(new - old) for new, old in zip(gains, last, strict=True)) < _STEADY:
            break
    return gains


@dataclass(frozen=True)
class BankParameters:
    """Parameters of the filters and of the choice between them."""

    #: Standard deviations: of a reading, and of the steps of speed, disturbance and effectiveness in one second.
    reading_sigma_mps: Annotated[float, Field(gt=0, le=1)] = 0.02
    speed_walk_mps: Annotated[float, Field(ge=0, le=1)] = 0.004
    disturbance_walk_mps2: Annotated[float, Field(ge=0, le=1)] = 0.006
    gain_walk: Annotated[float, Field(ge=0, le=1)] = 0.02
    #: Standard deviations at the start.
    disturbance_sigma_mps2: Annotated[float, Field(ge=0, le=1)] = 0.05
    gain_sigma: Annotated[float, Field(ge=0, le=1)] = 0.1
    #: Limits of the estimated effectiveness.
    gain_limits: tuple[Annotated[float, Field(gt=0, le=10)], Annotated[float, Field(gt=0, le=10)]] = (0.4, 2.0)
    #: Extra delays to choose from besides 0, s, multiples of the sampling period; none: the delay is not estimated.
    extra_delays_s: tuple[Annotated[float, Field(gt=0, le=3)], ...] = (0.4, 1.0)
    #: Time constant of the forgetting of the scores, s.
    score_time_s: Annotated[float, Field(gt=0, le=1000)] = 8.0
    #: Another delay is used while its score is below this share of the nominal delay's.
    score_share: Annotated[float, Field(gt=0, le=1)] = 0.9


class Filter(NamedTuple, Generic[T]):
    """``accel``: acceleration of the lag, m/s^2, of several units a tuple. ``score``: forgotten mean square of the
    normalised errors."""

    belief: Belief[T]
    accel: Any
    score: T


Bank = tuple[Filter[T], ...]


class Found(NamedTuple, Generic[T]):
    """The chosen filter: belief, acceleration of the lag, last prediction error (m/s), extra delay (s).

    ``chosen``: for :meth:`DelayBank.pick`, conditions that each later filter replaces those before it.
    """

    belief: Belief[T]
    accel: Any
    error: T
    delay: T
    chosen: tuple[Any, ...]


class DelayBank(Generic[T]):
    """The filters of one power unit, or of several on which one filter is kept.

    :param lines: makes the lines of the units for the extra delays in periods; None: those of ``unit``.
    :raises ValueError: an extra delay that is not a multiple of the sampling period.
    """

    def __init__(
        self, re: Reals[T], unit: Unit, given: BankParameters, lines: Callable[[Sequence[int]], Any] | None = None
    ) -> None:
        self._re = re
        period_s = unit.sample_period_s
        self.extra_s = (0.0, *given.extra_delays_s)
        self.shifts = [round(extra_s / period_s) for extra_s in self.extra_s]
        for extra_s, shift in zip(self.extra_s, self.shifts, strict=True):
            if abs(shift * period_s - extra_s) > 1e-9:
                raise ValueError(f"extra_delays_s: {extra_s:g}, allowed multiples of sample_period_s, {period_s:g}")
        delays_s = (unit.traction_delay_s, unit.braking_delay_s)
        #: :class:`.delay_line.DelayLines`, or what has its interface for several units.
        self.lines: Any = (
            DelayLines(re, delays_s, unit.lag_s, period_s, self.shifts) if lines is None else lines(self.shifts)
        )
        #: The choice of the nominal delay, for :meth:`pick`.
        self.nominal = (False,) * (len(self.shifts) - 1)
        root = period_s**0.5
        self.noise = Noise(
            re.number("reading_variance", given.reading_sigma_mps**2, "parameters"),
            re.number("speed_variance", (given.speed_walk_mps * root) ** 2, "parameters"),
            re.number("disturbance_variance", (given.disturbance_walk_mps2 * root) ** 2, "parameters"),
            re.number("gain_variance", (given.gain_walk * root) ** 2, "parameters"),
        )
        first = (given.reading_sigma_mps**2, given.disturbance_sigma_mps2**2, given.gain_sigma**2)
        self._first = re.numbers("first_variance", first, "parameters")
        self._period = re.number("period", period_s, "T0")
        self._gains = re.numbers("gain_limit", given.gain_limits, "parameters")
        weight = min(1.0, period_s / given.score_time_s)
        self._weight = re.number("score_weight", weight, "parameters")
        self._share = re.number("score_share", given.score_share, "parameters")
        self._delays = re.numbers("extra_delay", self.extra_s, "parameters")

    def start(self, speed: T) -> Bank[T]:
        """The filters of a train that has run at its speed without a command."""
        re, zero = self._re, self._re.zero
        vv, dd, kk = self._first
        belief = Belief(speed, zero, re.one, (vv, zero, zero, dd, zero, kk))
        return (Filter(belief, self.lines.rest, re.one),) * len(self.shifts)

    def step(self, bank: Bank[T], commands: Sequence[Any], speed: T) -> tuple[Bank[T], Found[T]]:
        """One sampling period.

        :param commands: u(k-1), u(k-2), ..., m/s^2; of several units, those of each.
        :param speed: v(k) as read, m/s.
        """
        re = self._re
        parts = self.lines.parts(commands)
        filters, errors = [], []
        for one, shift in zip(bank, self.shifts, strict=True):
            rolled = self.lines.roll(one.accel, parts, shift)
            before = predict(re, one.belief, rolled.gained, self._period, self.noise)
            belief, innovation = correct(re, before, speed, self.noise)
            belief = belief._replace(gain=re.clip(belief.gain, *self._gains))
            square = re.div(re.mul(innovation.error, innovation.error), innovation.variance)
            score = re.add(one.score, re.mul(self._weight, re.sub(square, one.score)))
            filters.append(Filter(belief, rolled.accel, score))
            errors.append(innovation.error)
        chosen = []
        least = re.mul(self._share, filters[0].score)
        for one in filters[1:]:
            better = re.gt(least, one.score)
            chosen.append(better)
            least = re.ar.where(better, one.score, least)
        options = [(one.belief, one.accel, *rest) for one, *rest in zip(filters, errors, self._delays, strict=True)]
        belief, accel, error, delay = self.pick(chosen, options)
        return tuple(filters), Found(belief, accel, error, delay, tuple(chosen))

    def pick(self, chosen: Sequence[Any], options: Sequence[Any]) -> Any:
        """The chosen tuple of several nested tuples of one shape, one for each filter."""
        found = options[0]
        for better, option in zip(chosen, options[1:], strict=True):
            found = self._re.select(better, option, found)
        return found
