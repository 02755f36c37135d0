"""Estimators of xi, the part of the speed that the linear model does not explain: the seam for the learned laws.

A law of the NGPC family (``ngpc.NgpcLaw``) has one estimator for each power unit. It is a pure step: its state before,
what was measured, its state after.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Generic, Literal, NamedTuple, TypeVar

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.reals import Reals

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
    """Estimates xi(k-1); written with the arithmetic, straight-line."""

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
    :param reading: ``predicted``: the law uses xi before the newest residual, as the stability table of the
        specification has it; ``newest``: after it, which is one period faster and less robust.
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
