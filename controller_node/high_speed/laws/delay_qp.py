"""DelayQP: our law with constraints. The filters of :mod:`.delay_gpc`, and a quadratic program over the horizon.

A program (:mod:`.qp_problem`) replaces the formula and the clip of :mod:`.delay_gpc`. It has a jerk limit, limits of
the commands, the power limit at the coming speeds, the forces of the couplers and the work of the traction. With ``loop
= "train"`` one program finds the commands of all units of a coupled train: it follows the mean speed by mass, and
predicts from the units' delays the forces that their commands will cause. The commands alone determine these forces:
effects on all units alike do not move them against each other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import fsum
from typing import Annotated, Any, ClassVar, Generic, NamedTuple

import numpy as np
from pydantic import Field

from railhil.common.errors import InputError, Words
from railhil.controller_node.arithmetic.base import Arithmetic, Constant, Problem, T
from railhil.controller_node.high_speed.base import (
    HighSpeedLaw,
    HighSpeedParameters,
    LoopAnswer,
    LoopInputs,
    LoopNotes,
)
from railhil.controller_node.high_speed.delay_bank import Bank, BankParameters, DelayBank
from railhil.controller_node.high_speed.delay_line import TrainLines
from railhil.controller_node.high_speed.law import JOURNEYS, Unit, weigh_preview
from railhil.controller_node.high_speed.qp_problem import Limits, Qp, QpParameters, Situation, daqp_solver
from railhil.controller_node.high_speed.train_model import CouplerModel, Prediction, TrainModel, UnitModel
from railhil.controller_node.vector.reals import Reals
from railhil.wire.power_units import ACCEL_PER_MPS2, PREVIEW, PREVIEW_STEP_S


@dataclass(frozen=True)
class DelayQpParameters(QpParameters, BankParameters, HighSpeedParameters):
    """Parameters of the law."""

    sample_period_s: Annotated[float, Field(gt=0, le=10)] = 0.2


class QpState(NamedTuple, Generic[T]):
    """State of one program. ``commands``: of each unit, newest first, m/s^2. ``apart``: speeds of the units relative to
    the train (m/s), then gaps (m). ``new``: 1 before the first sample."""

    commands: tuple[tuple[T, ...], ...]
    apart: tuple[T, ...]
    bank: Bank[T]
    new: T


@dataclass(frozen=True)
class Group:
    """Units that one program commands: delays and lags (s), shares of the mass; the train's couplers."""

    units: tuple[Unit, ...]
    masses_t: tuple[float, ...]
    coupler: CouplerModel | None

    @property
    def shares(self) -> tuple[float, ...]:
        """Shares of the units in the mass of the group."""
        total = fsum(self.masses_t)
        return tuple(mass_t / total for mass_t in self.masses_t)


class _Program(Generic[T]):
    """The filters of a group and its program, one :class:`.qp_problem.Qp` for each extra delay."""

    def __init__(self, re: Reals[T], group: Group, given: DelayQpParameters, limits: Limits, law: str) -> None:
        self.re, self.group = re, group
        self._horizon = given.horizon
        self.count = len(group.units)
        self.bank: DelayBank[T] = DelayBank(
            re, group.units[0], given, lambda shifts: TrainLines(re, group.units, group.shares, shifts)
        )
        self.past: int = self.bank.lines.count
        solver = daqp_solver(law)
        self._programs = [self._program(extra_s, given, limits, solver) for extra_s in self.bank.extra_s]
        apart = 2 * self.count - 1
        sizes = (given.horizon + 1, 6, apart, self.count, self.count * self.past)
        self._edges = np.cumsum(sizes)[:-1]
        self.problem = Problem("quadratic program", sum(sizes), self.count + apart, self._solved)

    def _program(self, extra_s: float, given: DelayQpParameters, limits: Limits, solver: Any) -> Qp:
        period_s = self.group.units[0].sample_period_s
        delays_s = [[unit.traction_delay_s + extra_s, unit.braking_delay_s + extra_s] for unit in self.group.units]
        models = [
            UnitModel((first, second), unit.lag_s, mass_t)
            for (first, second), unit, mass_t in zip(delays_s, self.group.units, self.group.masses_t, strict=True)
        ]
        prediction = Prediction(TrainModel(models, self.group.coupler, period_s), given.horizon, self.past)
        rows = zip(delays_s, self.group.units, strict=True)
        centres = [[(delay_s + unit.lag_s) / period_s + 0.5 for delay_s in own] for own, unit in rows]
        return Qp(prediction, centres, self.group.shares, limits, given, period_s, solver)

    def _solved(self, values: Sequence[float]) -> Sequence[float]:
        """Commands of the units, and ``apart`` one sample later, from the values that :meth:`step` passes."""
        parts = np.split(np.asarray(values, dtype=np.float64), self._edges)
        reference, (speed, disturbance, gain, delay_s, *words), apart, lags, past = parts
        program = self._programs[int(np.argmin(np.abs(np.array(self.bank.extra_s) - delay_s)))]
        state = np.concatenate([apart, lags])
        past = past.reshape(self.count, self.past)
        emergency, first = (bool(word > 0.0) for word in words)
        situation = Situation(reference, float(speed), float(disturbance), float(gain), emergency, first, state, past)
        commands, after = program.decide(situation)
        after[: self.count] -= np.dot(self.group.shares, after[: self.count])
        return [*commands.tolist(), *after[: len(apart)].tolist()]

    def start(self, inputs: Sequence[LoopInputs[T]]) -> QpState[T]:
        """The state before the first sample."""
        re = self.re
        speed = self.bank.lines.mean([one.speed for one in inputs])
        nothing = ((re.zero,) * self.past,) * self.count
        return QpState(nothing, (re.zero,) * (2 * self.count - 1), self.bank.start(speed), re.one)

    def step(
        self, state: QpState[T], inputs: Sequence[LoopInputs[T]], reference: Sequence[T]
    ) -> tuple[QpState[T], tuple[LoopAnswer[T], ...]]:
        """One sample; an answer for each unit."""
        re, lines = self.re, self.bank.lines
        speed = lines.mean([one.speed for one in inputs])
        filters, found = self.bank.step(state.bank, state.commands, speed)
        belief = found.belief
        known = (belief.speed, belief.disturbance, belief.gain, found.delay, inputs[0].emergency, state.new)
        past = (command for own in state.commands for command in own)
        solved = re.ar.solve(self.problem, (*reference, *known, *state.apart, *found.accel, *past))
        commands, apart = solved[: self.count], solved[self.count :]
        xi = re.mul(belief.disturbance, self._period())
        notes = LoopNotes(found.error, xi, belief.gain, found.delay)
        kept = tuple((command, *own[:-1]) for command, own in zip(commands, state.commands, strict=True))
        answers = tuple(LoopAnswer(command, notes) for command in commands)
        return QpState(kept, apart, filters, re.zero), answers

    def _period(self) -> T:
        return self.re.number("period", self.group.units[0].sample_period_s, "T0")


class DelayQp(HighSpeedLaw[T, Any]):
    """See the module."""

    name = "delay_qp"
    parameters_type = DelayQpParameters
    parameters_origin = "ours"
    #: Includes the seeds of the filters' parameters, which are :mod:`.delay_gpc`'s.
    design_seeds: ClassVar[Mapping[str, range]] = {
        **dict.fromkeys(JOURNEYS, range(1, 204)),
        **dict.fromkeys(("hst_short", "emu3_short", "jinan_xuzhou_emu3_coupled"), range(100, 101)),
    }
    loops = ("unit", "mean", "train")
    floating = True
    solver = True

    def __init__(self, arithmetic: Arithmetic[T], scenario: Any, parameters: Any = None) -> None:
        super().__init__(arithmetic, scenario, parameters)
        self.re = re = Reals(arithmetic)
        given, task = self.given, scenario.task
        limits = Limits(task.traction_max_mps2, task.braking_max_mps2, task.power_w_per_kg)
        #: Whether one program commands several units.
        self._joint = given.loop == "train" and self.units > 1
        self._programs = [_Program(re, group, given, limits, self.name) for group in self._groups(task)]
        steps = self.sample_s / PREVIEW_STEP_S
        delays_s = [s for model in self.models for s in (model.traction_delay_s, model.braking_delay_s)]
        span_s = given.horizon * self.sample_s
        if not max(delays_s) < span_s <= PREVIEW * PREVIEW_STEP_S + 1e-9:
            allowed = f"more than the longest delay, {max(delays_s):g} s, at most {PREVIEW * PREVIEW_STEP_S:g} s"
            found = Words(f"horizon {given.horizon} * sample_period_s {self.sample_s:g} = {span_s:g} s")
            raise InputError("controller", self.name, found, allowed)
        if given.control_horizon > given.horizon:
            raise InputError("parameters", "control_horizon", given.control_horizon, "at most horizon")
        self._instants = [
            (places, re.numbers(f"preview_{i}", shares))
            for i in range(given.horizon + 1)
            for places, shares in [weigh_preview(i * steps)]
        ]
        self._per_count = re.number("per_count", 1.0 / ACCEL_PER_MPS2, "port table")

    def _groups(self, task: Any) -> list[Group]:
        """Units commanded by each program: each unit alone, the train as one unit, or all units.

        :raises InputError: all units without couplers.
        """
        units = [Unit(m.traction_delay_s, m.braking_delay_s, m.lag_s, self.sample_s) for m in self.models]
        if not self._joint:
            return [Group((unit,), (1.0,), None) for unit in units]
        between_units = task.between_units
        if between_units is None:
            found = Words("train on units that nothing connects")
            raise InputError("parameters", "loop", found, 'couplers ([task.coupler]), or "unit"')
        masses_t = tuple(unit.mass_t * (1.0 + task.rotating_mass_share) for unit in task.unit)
        coupler = CouplerModel(between_units.stiffness_kn_per_m, between_units.damping_kn_per_mps)
        return [Group(tuple(units), masses_t, coupler)]

    @property
    def constants(self) -> tuple[Constant, ...]:
        return (*super().constants, *self.re.constants)

    def _reference(self, inputs: LoopInputs[T]) -> tuple[T, ...]:
        points = (inputs.target, *inputs.preview)
        return tuple(
            points[places[0]] if len(places) == 1 else self.re.dot(shares, [points[i] for i in places])
            for places, shares in self._instants
        )

    def loop_start(self, loop: int, inputs: LoopInputs[T]) -> QpState[T]:
        return self._programs[loop].start([inputs])

    def loop_step(self, loop: int, state: Any, inputs: LoopInputs[T]) -> tuple[Any, LoopAnswer[T]]:
        after, (answer,) = self._programs[loop].step(state, [inputs], self._reference(inputs))
        return after, answer

    def loops_start(self, inputs: Sequence[LoopInputs[T]]) -> tuple[Any, ...]:
        return (self._programs[0].start(inputs),) if self._joint else super().loops_start(inputs)

    def loops_step(
        self, states: Sequence[Any], inputs: Sequence[LoopInputs[T]]
    ) -> tuple[tuple[Any, ...], tuple[LoopAnswer[T], ...]]:
        if not self._joint:
            return super().loops_step(states, inputs)
        after, answers = self._programs[0].step(states[0], inputs, self._reference(inputs[0]))
        return (after,), answers

    def with_sent(self, state: Any, commands: Sequence[T]) -> Any:
        """See :meth:`.law.LoopControllerLaw.with_sent`."""
        told = iter([self.re.mul(count, self._per_count) for count in commands[::2]])
        return state._replace(
            loops=tuple(
                old._replace(commands=tuple((next(told), *own[1:]) for own in old.commands)) for old in state.loops
            )
        )
