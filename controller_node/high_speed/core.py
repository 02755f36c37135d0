"""What a law of one power unit is: a pure step in SI units, once per sampling period."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, TypeVar

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.high_speed.reals import Reals

State = TypeVar("State")


class Sample(NamedTuple, Generic[T]):
    """What a law knows at a sampling instant.

    ``speed``: m/s, measured. ``reference``: w(k), w(k+1), ..., m/s, one sampling period apart. ``lowest``,
    ``highest``: limits of the command now, m/s^2. ``emergency``: 1 from its trigger on, else 0.
    """

    speed: T
    reference: tuple[T, ...]
    lowest: T
    highest: T
    emergency: T


class Move(NamedTuple, Generic[T]):
    """Result of a step: the command (m/s^2) and the figures that every law reports (0 where it has none).

    ``model_error``: v - v_hat over one sampling period, m/s. ``xi``: estimated residual of the model, m/s per period.
    ``gain``: estimated effectiveness of the actuators, 1 nominal. ``delay``: estimated extra delay, s.
    """

    command: T
    model_error: T
    xi: T
    gain: T
    delay: T


@dataclass(frozen=True, slots=True)
class Unit:
    """One power unit as the law knows it: delays and lag (s), sampling period (s)."""

    traction_delay_s: float
    braking_delay_s: float
    lag_s: float
    sample_period_s: float


class Core(ABC, Generic[T, State]):
    """The law of one power unit. ``step`` is pure and straight-line, see ``VectorLaw``."""

    #: Future samples of the reference that it reads.
    horizon: int

    def __init__(self, re: Reals[T], unit: Unit, parameters: Any) -> None:
        """Bind the law to its constants.

        :param parameters: an instance of the law's ``parameters_type``.
        """
        self.re = re
        self.unit = unit

    @abstractmethod
    def start(self, sample: Sample[T]) -> State:
        """State before the first step, from the sample of that step."""

    @abstractmethod
    def step(self, state: State, sample: Sample[T]) -> tuple[State, Move[T]]:
        """One sampling period."""

    @abstractmethod
    def sent(self, state: State, command: T) -> State:
        """The state if another command (m/s^2) than the law's was really sent."""
