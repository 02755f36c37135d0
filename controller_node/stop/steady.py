"""Gains of the Kalman filter in its steady state, for a speed and the acceleration or disturbance behind it."""

from __future__ import annotations

#: Steps of the Riccati equation, and the relative change at which it has settled.
_STEPS = 200_000
_SETTLED = 1e-14


def steady_gains(period_s: float, noise_mps: float, walk: float) -> tuple[float, float]:
    """Gains on the innovation: of the speed (1) and of the acceleration (1/s).

    The model is v+ = v + T a, a+ = a + w; only sums, products and quotients, so that it has the same bits everywhere.

    :param noise_mps: standard deviation of a reading. :param walk: of ``a`` after one second, m/s2.
    :raises ValueError: noise or walk are not positive.
    """
    if not (noise_mps > 0.0 and walk > 0.0):
        raise ValueError(f"noise {noise_mps:g} m/s and walk {walk:g} m/s2 must be positive")
    reading, walked = noise_mps * noise_mps, walk * walk * period_s
    vv, va, aa = reading, 0.0, 1.0
    before = (0.0, 0.0)
    for _ in range(_STEPS):
        vv, va, aa = vv + 2.0 * period_s * va + period_s * period_s * aa, va + period_s * aa, aa + walked
        variance = vv + reading
        gains = (vv / variance, va / variance)
        vv, va, aa = reading * gains[0], reading * gains[1], aa - gains[1] * va
        if all(abs(new - old) <= _SETTLED * new for new, old in zip(gains, before, strict=True)):
            break
        before = gains
    return before
