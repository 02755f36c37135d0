"""Offline part of predictive functional control (PFC): internal model, basis responses, gains, polynomial fits; notes.

Everything here runs once, in double precision, before a run. Equation numbers are those of Wang et al., "An improved
predictive function control algorithm for velocity curve of urban rail vehicle", Chinese Journal of Scientific
Instrument, DOI 10.19650/j.cnki.cjsi.J2108765.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field

from railhil.controller_node.laws.note import Note, flags

#: Softening factor, 0..1.
SOFTENING_Q = 30
#: Fuzzy satisfaction, 0..1.
SATISFACTION_Q = 24

#: Bits of the basis functions in use.
BASIS_STEP = 1
BASIS_WAVELET = 2
BASIS_RAMP = 4

BASIS_NOTE = flags("basis_in_use", "basis functions", ("step", "wavelet", "ramp"))
#: Alpha of eq. (27).
SOFTENING_NOTE = Note("softening_factor", "softening factor", SOFTENING_Q, symbol="α")
#: Mu of eq. (26).
SATISFACTION_NOTE = Note("satisfaction", "satisfaction", SATISFACTION_Q, symbol="μ")


Matrix: TypeAlias = NDArray[np.float64]

#: Ranges of the coefficients of eq. (2) in a parameter file. A model without gain has no inverse; one with a negative
#: damping or stiffness is unstable.
ModelGain = Annotated[float, Field(ge=0.001, le=10)]
ModelDamping = Annotated[float, Field(ge=0, le=10)]
ModelStiffness = Annotated[float, Field(ge=0, le=10)]


def on_grid(values: ArrayLike, bits: int = 40) -> Matrix:
    """Values to the nearest multiple of 2^-bits.

    The grid is too fine to affect a law, but makes a constant independent of the order of sums in a linear algebra
    library and of the last bit of a mathematical library.
    """
    return np.round(np.asarray(values, dtype=np.float64) * 2.0**bits) / 2.0**bits


@dataclass(frozen=True)
class InternalModel:
    """Second-order model y'' + a1 y' + a0 y = b u, sampled with a zero-order hold (eq. 16).

    State ``[y, dy/dt]`` in km/h and km/h/s, input in notches. ``a`` has shape (2, 2), ``b`` shape (2,).
    """

    a: Matrix
    b: Matrix

    @classmethod
    def sampled(cls, gain: float, damping_per_s: float, stiffness_per_s2: float, period_s: float) -> InternalModel:
        """Model of ``gain / (s^2 + damping s + stiffness)`` at a sampling period in seconds."""
        # Imported here, because most runs load their constants, and this import takes longer than all others together.
        from scipy.linalg import expm

        block = np.zeros((3, 3))
        block[0, 1] = 1.0
        block[1] = [-stiffness_per_s2, -damping_per_s, gain]
        step = expm(block * period_s)
        return cls(on_grid(step[:2, :2]), on_grid(step[:2, 2]))

    def free_rows(self, horizon: int) -> Matrix:
        """Rows C (A^i - I), i = 1..horizon: change of the output without any input; shape (horizon, 2)."""
        power, rows = np.eye(2), []
        for _ in range(horizon):
            power = self.a @ power
            rows.append(power[0] - np.array([1.0, 0.0]))
        return on_grid(np.array(rows))

    def responses(self, inputs: Matrix) -> Matrix:
        """Outputs at i = 1..horizon from rest under input sequences of shape (N, horizon); shape (N, horizon)."""
        state = np.zeros((inputs.shape[0], 2))
        outputs = np.empty_like(inputs)
        for i in range(inputs.shape[1]):
            state = state @ self.a.T + np.outer(inputs[:, i], self.b)
            outputs[:, i] = state[:, 0]
        return outputs

    def step_response(self, horizon: int) -> Matrix:
        """Output at i = 1..horizon after a unit step of the input, shape (horizon,)."""
        return on_grid(self.responses(np.ones((1, horizon)))[0])

    def gains(self, basis: Matrix, fit_points: Sequence[int]) -> Matrix:
        """U = f(0)^T (g g^T)^-1 g (eqs. 17 to 19), so that u(k) = U . d.

        :param basis: basis functions f_n(i), i = 0..P-1, shape (N, P).
        :param fit_points: fitting points h in samples, at least N of them, each at most P.
        :returns: shape (len(fit_points),).
        """
        at_points = self.responses(basis)[:, [point - 1 for point in fit_points]]
        combination = np.linalg.solve(at_points @ at_points.T, at_points)
        return on_grid(basis[:, 0] @ combination)


def morlet(scale: float, shift_s: float, bandwidth: float, time_s: Matrix) -> Matrix:
    """Daughter of the Morlet wavelet (eq. 21, with the factor 2a required by eq. 20) at times in seconds."""
    t = time_s - shift_s
    return np.asarray(np.exp(-(bandwidth**2) * t**2 / (2 * scale)) * np.cos(np.pi * t))


def polynomial_fit(points: Sequence[int], order: int) -> Matrix:
    """Least squares fit of c_1 i + ... + c_n i^n to values at ``points``: rows of weights, shape (order, len(points)).

    The polynomial passes through zero at i = 0: the values are differences from the newest one.
    """
    powers = np.array([[float(point) ** n for n in range(1, order + 1)] for point in points])
    return on_grid(np.linalg.pinv(powers))
