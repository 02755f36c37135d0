"""The linear model of a power unit: lag, transport delay and integrator, sampled (paper 004 eqs. 1 to 10).

Input: target acceleration (m/s^2); output: speed (m/s). Everything here is computed once, in float64.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

Matrix: TypeAlias = NDArray[np.float64]

#: Orders of the model: A has three coefficients after its leading one, B three (002 section 1.2, 004 eq. 10).
A_COUNT = 3
B_COUNT = 3


class Sampled(NamedTuple):
    """A(q) v(k) = B(q) u(k-1) + ``direct`` u(k) + xi(k-1), with q the backward shift by one sampling period.

    ``a``: a1, a2, a3; ``b``: b0, b1, b2 (m/s per m/s^2); ``direct``: c0 of the bilinear transform, else 0.
    """

    a: tuple[float, ...]
    b: tuple[float, ...]
    direct: float = 0.0

    @property
    def b_sum(self) -> float:
        """B(1), without ``direct``."""
        return math.fsum(self.b)


def exponential(matrix: Matrix) -> Matrix:
    """Matrix exponential: Taylor series of 18 terms after scaling, then squaring. Shape (n, n)."""
    norm = float(np.abs(matrix).sum(axis=1).max(initial=0.0))
    squarings = max(0, math.ceil(math.log2(norm)) + 1) if norm > 0.5 else 0
    scaled = matrix / 2.0**squarings
    term = total = np.eye(len(matrix))
    for power in range(1, 19):
        term = term @ scaled / power
        total = total + term
    for _ in range(squarings):
        total = total @ total
    return total


def hold_input(dynamics: Matrix, drive: Matrix, period_s: float) -> tuple[Matrix, Matrix]:
    """Transition over a period with the input held: (n, n) and (n,) of x(k+1) = F x(k) + g u(k)."""
    n = len(drive)
    joined = np.zeros((n + 1, n + 1))
    joined[:n, :n], joined[:n, n] = dynamics, drive
    whole = exponential(joined * period_s)
    return whole[:n, :n], whole[:n, n]


def make_lag(lag_s: float, gain: float = 1.0) -> tuple[Matrix, Matrix]:
    """Continuous state-space form of lag and integrator, states speed and acceleration."""
    return np.array([[0.0, 1.0], [0.0, -1.0 / lag_s]]), np.array([0.0, gain / lag_s])


def pade_zoh(delay_s: float, lag_s: float, period_s: float) -> Sampled:
    """Zero-order hold of the transfer function with the first-order Pade delay (004 eqs. 4, 5 and 8; D5 iii).

    The pole of the delay is 2 / T, which the papers call lambda and never state (D5 iv).
    """
    pole = 2.0 / delay_s
    dynamics = np.array([[0.0, 1.0, 0.0], [0.0, -1.0 / lag_s, 2.0 * pole / lag_s], [0.0, 0.0, -pole]])
    step, drive = hold_input(dynamics, np.array([0.0, -1.0 / lag_s, 1.0]), period_s)
    # The poles are known: 1, exp(-T0/tau), exp(-pole T0).
    roots = (1.0, math.exp(-period_s / lag_s), math.exp(-period_s * pole))
    a = _product([1.0, -root] for root in roots)
    state, response = drive, []
    for _ in range(B_COUNT):
        response.append(float(state[0]))
        state = step @ state
    b = (math.fsum(a[i] * response[k - i] for i in range(k + 1)) for k in range(B_COUNT))
    return Sampled(tuple(a[1:]), tuple(b))


def bilinear(delay_s: float, lag_s: float, period_s: float) -> Sampled:
    """Bilinear transform of the same transfer function (004 eqs. 6 and 7), with its four numerator coefficients.

    Corrected: lambda (1 + q) in the numerator, and the factor 2/T0 of the last term of the denominator (D5 i).
    """
    pole, rate = 2.0 / delay_s, 2.0 / period_s
    fall, rise = [1.0, -1.0], [1.0, 1.0]
    numerator = _product([[pole - rate, pole + rate], rise, rise])
    cubic = _product([fall, fall, fall])
    square = _product([fall, fall, rise])
    first = _product([fall, rise, rise])
    weights = (lag_s * rate**3, (pole * lag_s + 1.0) * rate**2, pole * rate)
    terms = zip(cubic, square, first, strict=True)
    denominator = [math.fsum(w * x for w, x in zip(weights, some, strict=True)) for some in terms]
    c = [value / denominator[0] for value in numerator]
    return Sampled(tuple(value / denominator[0] for value in denominator[1:]), tuple(c[1:]), c[0])


def bilinear_without_direct(delay_s: float, lag_s: float, period_s: float) -> Sampled:
    """The bilinear model with c0 dropped, so that it has the three coefficients of eq. (8) (D5 ii).

    Its gain B(1) is then wrong by the share c0 / (c0 + ... + c3).
    """
    return bilinear(delay_s, lag_s, period_s)._replace(direct=0.0)


def _product(factors: object) -> list[float]:
    """Coefficients of a product of polynomials in q, lowest power first."""
    result = [1.0]
    for factor in factors:  # type: ignore[attr-defined]
        result = [float(x) for x in np.convolve(result, factor)]
    return result
