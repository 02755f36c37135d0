"""Multi-model GPC, the comparator of 004 ([3], [24] there): several fixed models, of which the best fitting one is
used."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Generic, NamedTuple

from pydantic import Field

from railhil.controller_node.arithmetic.base import T
from railhil.controller_node.arithmetic.float64 import Float64
from railhil.controller_node.high_speed.carima import (
    CarimaParameters,
    Increments,
    Track,
    command_of,
    increments,
    one_step_error,
    radius,
    resent,
    start_track,
    tracked,
)
from railhil.controller_node.high_speed.law import DESIGN_SEEDS, LoopController, LoopControllerLaw, Move, Sample, Unit
from railhil.controller_node.high_speed.model import pade_zoh
from railhil.controller_node.high_speed.stability import Train, refuse_short_horizon, refuse_unstable
from railhil.controller_node.vector.reals import Reals


@dataclass(frozen=True)
class MmGpcParameters(CarimaParameters):
    """Parameters of the law."""

    control_weight: Annotated[float, Field(ge=0, le=1000)] = 8.8
    #: Gains of its models; each is used once with the traction and once with the braking delay.
    gains: tuple[Annotated[float, Field(gt=0, le=10)], ...] = (1.0,)
    #: Share of the old sum of squared errors in the new one.
    forgetting: Annotated[float, Field(ge=0, lt=1)] = 0.37


class MmState(NamedTuple, Generic[T]):
    """Regressors, and the forgotten sum of squared one-step errors of each model."""

    track: Track[T]
    squares: tuple[T, ...]


class _Model(NamedTuple, Generic[T]):
    alpha: tuple[T, ...]
    b: tuple[T, ...]
    law: Increments[T]
    gain: T


class MmController(LoopController[T, MmState[T]]):
    """Each model has its weights, computed in advance."""

    def __init__(self, re: Reals[T], unit: Unit, parameters: MmGpcParameters) -> None:
        super().__init__(re, unit, parameters)
        self.horizon = parameters.horizon
        delays = (unit.traction_delay_s, unit.braking_delay_s)
        models = [(delay_s, gain) for gain in parameters.gains for delay_s in delays]
        #: Spectral radius of the loop of each model and the train that it describes.
        self.radii: dict[str, float] = {}
        self._models = [self._model(i, *model, parameters) for i, model in enumerate(models)]
        self._forgetting = re.number("forgetting", parameters.forgetting, "parameters")

    def _model(self, i: int, delay_s: float, gain: float, given: MmGpcParameters) -> _Model[T]:
        re = self.re
        sampled = pade_zoh(delay_s, self.unit.lag_s, self.unit.sample_period_s)
        b = tuple(gain * x for x in sampled.b)
        exact = Reals(Float64())
        law = increments(exact, sampled.a, b, given.horizon, given.control_horizon, given.control_weight)
        mode = "traction" if i % 2 == 0 else "braking"
        train = Train(delay_s, self.unit.lag_s, gain)
        self.radii[f"{mode} with gain {gain:g}"] = radius(law, train, self.unit.sample_period_s)
        alpha = (1.0 + sampled.a[0], 1.0 + sampled.a[0] + sampled.a[1])
        return _Model(
            re.numbers(f"alpha_{i}", alpha, "004 eq. 8"),
            re.numbers(f"b_{i}", b, "004 eq. 8"),
            Increments(*(re.numbers(f"{name}_{i}", getattr(law, name), "004 eq. 26") for name in law._fields)),
            re.number(f"gain_{i}", gain, "parameters"),
        )

    def start(self, sample: Sample[T]) -> MmState[T]:
        return MmState(start_track(self.re, sample), (self.re.zero,) * len(self._models))

    def step(self, state: MmState[T], sample: Sample[T]) -> tuple[MmState[T], Move[T]]:
        re, track = self.re, state.track
        errors = [one_step_error(re, model.alpha, model.b, sample.speed, track) for model in self._models]
        squares = tuple(
            re.add(re.mul(self._forgetting, old), re.mul(error, error))
            for old, error in zip(state.squares, errors, strict=True)
        )
        chosen: Any = (self._models[0], errors[0])
        least = squares[0]
        for model, error, square in zip(self._models[1:], errors[1:], squares[1:], strict=True):
            better = re.gt(least, square)
            chosen = re.select(better, (model, error), chosen)
            least = re.ar.where(better, square, least)
        model, error = chosen
        command = command_of(re, model.law, sample, track)
        after = MmState(tracked(track, sample.speed, command), squares)
        return after, Move(command, error, re.zero, model.gain, re.zero)

    def sent(self, state: MmState[T], command: T) -> MmState[T]:
        return state._replace(track=resent(state.track, command))


class MmGpc(LoopControllerLaw[T]):
    """Multi-model GPC."""

    name = "mm_gpc"
    parameters_type = MmGpcParameters
    parameters_origin = "railhil.systems.high_speed.tuning; the papers print none"
    design_seeds: ClassVar[Mapping[str, range]] = DESIGN_SEEDS
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {"control_weight": (0.5, 100.0), "forgetting": (0.05, 0.99)}

    def make_controller(self, re: Reals[T], unit: Unit, parameters: Any) -> MmController[T]:
        refuse_short_horizon(self.name, parameters, max(unit.traction_delay_s, unit.braking_delay_s))
        controller = MmController(re, unit, parameters)
        refuse_unstable(self.name, parameters, controller.radii)
        return controller
