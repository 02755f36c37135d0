"""Laws made of one controller for each loop: its samples in SI units, limits of its command by speed."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, TypeVar

from railhil.common.errors import InputError
from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.high_speed.base import (
    HighSpeedLaw,
    HighSpeedParameters,
    LoopAnswer,
    LoopInputs,
    LoopNotes,
)
from railhil.controller_node.vector.reals import Reals
from railhil.wire.power_units import ACCEL_PER_MPS2, PREVIEW, PREVIEW_STEP_S

State = TypeVar("State")


class Sample(NamedTuple, Generic[T]):
    """Inputs of a law at a sampling instant.

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
    """The law's data of one power unit: delays and lag (s), sampling period (s)."""

    traction_delay_s: float
    braking_delay_s: float
    lag_s: float
    sample_period_s: float


class LoopController(ABC, Generic[T, State]):
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


#: Runs on which ``railhil.systems.high_speed.tuning`` chose parameters: its training seed.
#: Scenarios of the journey, with which parameters are chosen.
JOURNEYS = ("jinan_xuzhou", "jinan_xuzhou_emergency", "jinan_xuzhou_mutation")
DESIGN_SEEDS = {"jinan_xuzhou": range(100, 101)}
#: Lowest speed in the power limit, m/s: it keeps the quotient finite.
_CRAWL_MPS = 1.0


@dataclass(frozen=True)
class LawParameters(HighSpeedParameters):
    """Parameters of every law of this kind."""

    #: Run also a horizon that ends before the command acts, and a loop that is not stable.
    override: bool = False


def weigh_preview(place: float) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Points of the preview (0 is now) and their weights for the reference at ``place`` steps of the preview from now.

    Linear between two points; behind the last one the last slope continues.
    """
    low = min(int(place + 1e-9), PREVIEW - 1)
    share = place - low
    for whole in (0, 1):
        if abs(share - whole) < 1e-9:
            return (low + whole,), (1.0,)
    return (low, low + 1), (1.0 - share, share)


class LoopControllerLaw(HighSpeedLaw[T, Any]):
    """A law made of one controller for each loop; it computes with real numbers and has no formats for fixed point."""

    parameters_type = LawParameters
    floating = True

    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: Any = None) -> None:
        super().__init__(arithmetic, scenario, parameters)
        self.re = re = Reals(arithmetic)
        task = scenario.task
        self.controllers: tuple[LoopController[T, Any], ...] = tuple(
            self.make_controller(
                re, Unit(model.traction_delay_s, model.braking_delay_s, model.lag_s, self.sample_s), self.given
            )
            for model in self.models
        )
        self._power = re.number("power", task.power_w_per_kg, "scenario, power_kw by mass")
        self._crawl = re.number("crawl", _CRAWL_MPS)
        self._per_count = re.number("per_count", 1.0 / ACCEL_PER_MPS2, "port table")
        steps = self.sample_s / PREVIEW_STEP_S
        horizon = max(controller.horizon for controller in self.controllers)
        if horizon * steps > PREVIEW + 1e-9:
            span_s = PREVIEW * PREVIEW_STEP_S
            raise InputError(
                "controller",
                f"{self.name}, horizon",
                f"{horizon} * {self.sample_s:g} s",
                f"at most {span_s:g} s, the preview",
            )
        self._instants = [
            (places, re.numbers(f"preview_{i}", shares))
            for i in range(horizon + 1)
            for places, shares in [weigh_preview(i * steps)]
        ]

    @abstractmethod
    def make_controller(self, re: Reals[T], unit: Unit, parameters: Any) -> LoopController[T, Any]:
        """The law of one loop."""

    @property
    def constants(self) -> tuple[Constant, ...]:
        return (*super().constants, *self.re.constants)

    def _sample(self, inputs: LoopInputs[T]) -> Sample[T]:
        re = self.re
        points = (inputs.target, *inputs.preview)
        reference = tuple(
            points[places[0]] if len(places) == 1 else re.dot(shares, [points[i] for i in places])
            for places, shares in self._instants
        )
        highest = re.ar.minimum(inputs.most, re.div(self._power, re.ar.maximum(inputs.speed, self._crawl)))
        return Sample(inputs.speed, reference, self.least, highest, inputs.emergency)

    def loop_start(self, loop: int, inputs: LoopInputs[T]) -> Any:
        return self.controllers[loop].start(self._sample(inputs))

    def loop_step(self, loop: int, state: Any, inputs: LoopInputs[T]) -> tuple[Any, LoopAnswer[T]]:
        after, move = self.controllers[loop].step(state, self._sample(inputs))
        return after, LoopAnswer(move.command, LoopNotes(move.model_error, move.xi, move.gain, move.delay))

    def with_sent(self, state: Any, commands: Sequence[T]) -> Any:
        """The model needs the commands really sent; the law's own come with the next sample."""
        told = [self.re.mul(count, self._per_count) for count in commands[::2]]
        loops = zip(self.controllers, state.loops, told, strict=False)
        return state._replace(loops=tuple(controller.sent(old, accel) for controller, old, accel in loops))
