"""TPFC2: predictive functional control with Morlet wavelets as basis for every set-point.

One of the traditional laws with which section 4.5 of Wang et al. (see ``pfc_model``) compares IPFC: the core of ``pfc``
with IPFC's wavelets and the constant softening factor of section 2.3. Equation numbers are theirs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, ClassVar

from railhil.controller_node.arithmetic.base import Arithmetic, T
from railhil.controller_node.ato.pfc import Basis, ConstantPfc
from railhil.controller_node.ato.pfc_constants import (
    CONSTANT_TUNABLE,
    GAIN_Q,
    WAVELETS,
    ConstantPfcConstants,
    ConstantPfcParameters,
    Row,
    Wavelets,
    constant_values,
    gains,
    internal_model,
    wavelet_basis,
)
from railhil.controller_node.ato.pfc_model import BASIS_WAVELET
from railhil.controller_node.laws.constant_table import LawTable, build, held
from railhil.systems.ato.scenario.model import Scenario


@dataclass(frozen=True, slots=True)
class Tpfc2Parameters(ConstantPfcParameters):
    """Parameters of the law."""

    wavelets: Wavelets = WAVELETS


@dataclass(frozen=True)
class Tpfc2Constants(ConstantPfcConstants):
    """Constant table of the law."""

    gains_wavelet: Row = field(metadata=held(GAIN_Q, "U of eq. (19), wavelets of eqs. (20) and (21)"))


def compute_constants(parameters: Tpfc2Parameters, period_s: float, notch_max: float) -> Tpfc2Constants:
    """The constant table at a control period (s) and a notch range (notches).

    Raises ``ValueError`` when a constant does not fit its format, or parameters are inconsistent.
    """
    p = parameters
    model = internal_model(p, period_s)
    values = constant_values(p, model, notch_max) | {
        "basis": (BASIS_WAVELET,),
        "gains_wavelet": gains(model, wavelet_basis(p.wavelets, p.horizon, period_s), p.fit_points),
    }
    return build(Tpfc2Constants, values)


#: The checked-in table: the paper's parameters at 0.5 s and 7 notches.
TABLE = LawTable("tpfc2", Tpfc2Constants, Tpfc2Parameters(), 0.5, 7.0, compute_constants)


@lru_cache(maxsize=8)
def make_constants(parameters: Tpfc2Parameters, period_s: float, notch_max: float) -> Tpfc2Constants:
    """Like :func:`compute_constants`, but from the checked-in table at its operating point.

    Also raises :class:`~railhil.common.errors.InputError` (one line) if that table is not as generated.
    """
    return TABLE.make(parameters, period_s, notch_max)


class Tpfc2(ConstantPfc[T]):
    """The TPFC2 law on one arithmetic. Raises ``ValueError`` for inconsistent parameters."""

    name: ClassVar[str] = "tpfc2"
    parameters_type: ClassVar[type[Any]] = Tpfc2Parameters
    tunable: ClassVar[Mapping[str, tuple[float, float]]] = CONSTANT_TUNABLE
    parameters_origin: ClassVar[str] = "the paper's, and ours where it prints none"

    def __init__(
        self, arithmetic: Arithmetic[T], scenario: Scenario, parameters: Tpfc2Parameters | None = None
    ) -> None:
        parameters = parameters or Tpfc2Parameters()
        table = make_constants(parameters, scenario.timing.control_period_ns / 1e9, scenario.train.notch_max)
        (wavelet,) = table.basis
        super().__init__(arithmetic, parameters, table, (Basis(wavelet, table.gains_wavelet),))
