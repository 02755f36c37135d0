"""Kalman filter of speed, disturbance and effectiveness: v+ = v + T0 d + K g, d and K random walks.

``g`` is the speed that the commands alone give in the period (:class:`.delay_line.Rolled`), so it is known.
"""

from __future__ import annotations

from typing import Generic, NamedTuple

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.reals import Reals

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
    """Variances: of a reading, and what is added in each period to those of speed, disturbance and gain."""

    reading: T
    speed: T
    disturbance: T
    gain: T


class Innovation(NamedTuple, Generic[T]):
    """v - v_hat (m/s) and its variance."""

    error: T
    variance: T


def predicted(re: Reals[T], old: Belief[T], gained: T, period: T, noise: Noise[T]) -> Belief[T]:
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


def corrected(re: Reals[T], old: Belief[T], reading: T, noise: Noise[T]) -> tuple[Belief[T], Innovation[T]]:
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
        before = predicted(re, belief, 0.0, period, noise)
        vv, vd, *_ = before.covariance
        belief, innovation = corrected(re, before, 0.0, noise)
        last, gains = gains, (vv / innovation.variance, vd / innovation.variance)
        if max(abs(new - old) for new, old in zip(gains, last, strict=True)) < _STEADY:
            break
    return gains
