"""Identification of the linear model: its form, the projection algorithm with dead zone, estimators of its residual.

A(q) = (1 - q)(1 + alpha1 q + alpha2 q^2) + drift q^3 holds for every A of order 3, with alpha1 = 1 + a1, alpha2 =
1 + a1 + a2 and drift = A(1). Speeds then enter as differences, which keeps float32 exact enough at 83 m/s, and the
integrator of the train is visible: drift is 0 unless an identification loses it (D4).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, Generic, Literal, NamedTuple, TypeVar

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.model import Sampled
from railhil.controller_node.vector.reals import Reals

Memory = TypeVar("Memory")


class Past(NamedTuple, Generic[T]):
    """The regressors: ``speeds`` v(k-1), v(k-2), v(k-3) in m/s, ``commands`` u(k-1), u(k-2), u(k-3) in m/s^2.

    They are z(k-1) of 004 and z(k) of 002 (D9), the inputs of their networks.
    """

    speeds: tuple[T, ...]
    commands: tuple[T, ...]


class Estimate(NamedTuple, Generic[T]):
    """xi(k-1) in m/s per sampling period.

    ``predicted``: without knowledge of v(k); it enters v_hat(k) and so the identification (004 eqs. 18 to 20).
    ``used``: for the control law (004 eq. 26).
    """

    predicted: T
    used: T


class Estimator(ABC, Generic[T, Memory]):
    """Estimates xi(k-1), the part of the speed that the linear model does not explain; the learned laws add their own.

    A law of the NGPC family (``ngpc.NgpcLaw``) has one for each power unit. It is a pure step, straight-line.
    """

    #: Weight of the newest residual in ``used`` if the estimator is linear, for the spectral radius; else None.
    smoothing: float | None = None

    @abstractmethod
    def start(self) -> Memory:
        """State before the first step: a number of the arithmetic or a nested (named) tuple of them."""

    @abstractmethod
    def step(self, memory: Memory, past: Past[T], residual: T) -> tuple[Memory, Estimate[T]]:
        """One sampling period.

        :param past: the regressors at k.
        :param residual: A v(k) - B u(k-1) with the identified A and B: xi(k-1) as measured at k, m/s per period.
        """


class NoEstimate(Estimator[T, tuple[()]]):
    """xi = 0: linear GPC."""

    def __init__(self, re: Reals[T]) -> None:
        self._re = re

    def start(self) -> tuple[()]:
        return ()

    def step(self, memory: tuple[()], past: Past[T], residual: T) -> tuple[tuple[()], Estimate[T]]:
        return memory, Estimate(self._re.zero, self._re.zero)


class LowPass(Estimator[T, Any]):
    """xi += smoothing (residual - xi): the low-passed residual, without a network.

    :param smoothing: weight of the newest residual, 0..1; at most 0.2 is stable with all mutations of the plant.
    :param reading: ``predicted``: the law uses xi before the newest residual, as in the stability table of the
        specification; ``newest``: after it, which is one period faster and less robust.
    """

    def __init__(self, re: Reals[T], smoothing: float, reading: Literal["predicted", "newest"] = "predicted") -> None:
        self._re = re
        self._weight = re.number("smoothing", smoothing, "parameters")
        self._newest = reading == "newest"
        self.smoothing = smoothing

    def start(self) -> Any:
        return self._re.zero

    def step(self, memory: Any, past: Past[T], residual: T) -> tuple[Any, Estimate[T]]:
        re = self._re
        after = re.add(memory, re.mul(self._weight, re.sub(residual, memory)))
        return after, Estimate(memory, after if self._newest else memory)


class Theta(NamedTuple, Generic[T]):
    """Parameters of the model: ``alpha`` (2), ``drift``, ``b`` (3)."""

    alpha: tuple[T, ...]
    drift: T
    b: tuple[T, ...]


def theta_of(re: Reals[T], model: Sampled) -> Theta[T]:
    """The parameters of a sampled model as constants."""
    a1, a2, a3 = model.a
    alpha = re.numbers("alpha", (1.0 + a1, 1.0 + a1 + a2), "004 eq. 8")
    # The models of this folder contain the integrator exactly; the rest is rounding.
    drift = 1.0 + a1 + a2 + a3
    return Theta(alpha, re.number("drift", drift if abs(drift) > 1e-9 else 0.0), re.numbers("b", model.b, "004 eq. 8"))


def coefficients(re: Reals[T], theta: Theta[T]) -> tuple[T, ...]:
    """a1, a2, a3."""
    alpha1, alpha2 = theta.alpha
    return re.sub(alpha1, re.one), re.sub(alpha2, alpha1), re.sub(theta.drift, alpha2)


def residual(re: Reals[T], theta: Theta[T], speed: T, past: Past[T], *, integrating: bool) -> T:
    """A v(k) - B u(k-1), m/s: xi(k-1) as measured at k (004 eq. 11).

    :param integrating: the drift is known to be 0.
    """
    v1, v2, v3 = past.speeds
    moved = re.add(re.sub(speed, v1), re.dot(theta.alpha, (re.sub(v1, v2), re.sub(v2, v3))))
    explained = re.dot(theta.b, past.commands)
    left = re.sub(moved, explained)
    return left if integrating else re.add(left, re.mul(theta.drift, v3))


def dead_zone(re: Reals[T], error: T, half_width: T) -> T:
    """mu(k) e(k): the error where it is larger than ``half_width`` (2 Delta), else 0 (004 eqs. 14 and 19, D3)."""
    return re.ar.where(re.gt(re.ar.abs(error), half_width), error, re.zero)


def _scale(re: Reals[T], error: T, regressors: Sequence[T]) -> T:
    return re.div(error, re.add(re.one, re.dot(regressors, regressors)))


def paper_step(re: Reals[T], theta: Theta[T], past: Past[T], error: T) -> Theta[T]:
    """theta + x e / (1 + x'x), x = [-v, -v, -v, u, u, u], as printed (002 eq. 10, 004 eq. 19).

    :param error: after the dead zone, m/s.
    """
    scale = _scale(re, error, (*past.speeds, *past.commands))
    moved1, moved2, moved3 = (re.neg(re.mul(scale, v)) for v in past.speeds)
    on_alpha2 = re.add(moved1, moved2)
    alpha = (re.add(theta.alpha[0], moved1), re.add(theta.alpha[1], on_alpha2))
    drift = re.add(theta.drift, re.add(on_alpha2, moved3))
    return Theta(alpha, drift, re.axpy(scale, past.commands, theta.b))


def differenced_step(re: Reals[T], theta: Theta[T], past: Past[T], error: T) -> Theta[T]:
    """The same gain with x_d = [-dv(k-1), -dv(k-2), u(k-1), u(k-2), u(k-3)] (D4): A(1) stays 0.

    :param error: after the dead zone, m/s.
    """
    v1, v2, v3 = past.speeds
    moved = (re.sub(v2, v1), re.sub(v3, v2))
    scale = _scale(re, error, (*moved, *past.commands))
    return Theta(re.axpy(scale, moved, theta.alpha), theta.drift, re.axpy(scale, past.commands, theta.b))
