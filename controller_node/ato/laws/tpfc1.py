"""TPFC1: predictive functional control with a step as basis, and a step and a ramp where the set-point changes steeply.

One of the traditional laws with which section 4.5 of Wang et al. (see ``pfc_model``) compares IPFC: the core of ``pfc``
with the constant softening factor of section 2.3. Equation numbers are theirs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, ClassVar

from railhil.controller_node.arithmetic.base import Arithmetic, Constant, T
from railhil.controller_node.ato.pfc import Basis, ConstantPfc
from railhil.controller_node.ato.pfc_constants import (
    CONSTANT_TUNABLE,
    GAIN_Q,
    ConstantPfcConstants,
    ConstantPfcParameters,
    Row,
    Slope,
    constant_values,
    gains,
    internal_model,
    step_and_ramp_basis,
    step_basis,
)
from railhil.controller_node.ato.pfc_model import BASIS_RAMP, BASIS_STEP
from railhil.controller_node.laws.base import SPEED_Q
from railhil.controller_node.laws.constant_table import LawTable, build, held
from railhil.systems.ato.scenario.model import Scenario


@dataclass(frozen=True, slots=True)
class Tpfc1Parameters(ConstantPfcParameters):
    """Parameters of the law."""

    #: Mean acceleration over the horizon above which the ramp is used, km/h per s: the threshold of eq. (22).
    ramp_slope_kmh_per_s: Slope = 1.134


@dataclass(frozen=True)
class Tpfc1Constants(ConstantPfcConstants):
    """Constant table of the law."""

    gains_step: Row = field(metadata=held(GAIN_Q, "U of eq. (19), step basis"))
    gains_ramp: Row = field(metadata=held(GAIN_Q, "U of eq. (19), step and ramp basis"))
    ramp_change: Constant = field(metadata=held(SPEED_Q, "eq. (22): threshold times the horizon"))


def compute_constants(parameters: Tpfc1Parameters, period_s: float, notch_max: float) -> Tpfc1Constants:
    """The constant table at a control period (s) and a notch range (notches).

    Raises ``ValueError`` when a constant does not fit its format, or parameters are inconsistent.
    """
    p = parameters
    model = internal_model(p, period_s)
    values = constant_values(p, model, notch_max) | {
        "basis": (BASIS_STEP, BASIS_STEP | BASIS_RAMP),
        "gains_step": gains(model, step_basis(p.horizon), p.fit_points),
        "gains_ramp": gains(model, step_and_ramp_basis(p.horizon), p.fit_points),
        "ramp_change": p.ramp_slope_kmh_per_s * p.horizon * period_s,
    }
    return build(Tpfc1Constants, values)


#: The checked-in table: the paper's parameters at 0.5 s and 7 notches.
TABLE = LawTable("tpfc1", Tpfc1Constants, Tpfc1Parameters(), 0.5, 7.0, compute_constants)


@lru_cache(maxsize=8)
def make_constants(parameters: Tpfc1Parameters, period_s: float, notch_max: float) -> Tpfc1Constants:
    """Like :func:`compute_constants`, but from the checked-in table at its operating point.

    Also raises :class:`~railhil.common.errors.InputError` (one line) if that table is not as generated.
    """
    return TABLE.make(parameters, period_s, notch_max)


class Tpfc1(ConstantPfc[T]):
    """The TPFC1 law on one arithmetic. Raises ``ValueError`` for inconsistent parameters."""

    name: ClassVar[str] = "tpfc1"
    parameters_type: ClassVar[type[Any]] = Tpfc1Parameters
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = {**CONSTANT_TUNABLE, "ramp_slope_kmh_per_s": (0.0, 3.0)}
    parameters_origin: ClassVar[str] = "the paper's, and ours where it prints none"

    def __init__(
        self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: Tpfc1Parameters | None = None
    ) -> None:
        parameters = parameters or Tpfc1Parameters()
        table = make_constants(parameters, scenario.timing.control_period_ns / 1e9, scenario.train.notch_max)
        step, ramp = table.basis
        bases = (Basis(step, table.gains_step), Basis(ramp, table.gains_ramp))
        super().__init__(arithmetic, parameters, table, bases, table.ramp_change)
