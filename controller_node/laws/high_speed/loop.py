"""Refusals at load: a horizon that ends before the command acts, and an unstable closed loop (spec D1)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from railhil.common.errors import InputError, Words
from railhil.controller_node.laws.high_speed.core import Unit
from railhil.controller_node.laws.high_speed.model import Sampled
from railhil.controller_node.laws.high_speed.predictor import Weights
from railhil.controller_node.laws.high_speed.stability import Train, spectral_radius

if TYPE_CHECKING:
    from railhil.controller_node.laws.high_speed.ngpc import GpcParameters

_HINT = "parameter override = true runs it"


def refuse_short_horizon(law: str, parameters: GpcParameters, delay_s: float) -> None:
    """Refuse N * T0 <= T: within such a horizon no command has any effect, or the wrong one.

    :param delay_s: the longest delay.
    :raises InputError: the horizon is too short and ``parameters.override`` is not set.
    """
    span_s = parameters.horizon * parameters.sample_period_s
    if span_s <= delay_s + 1e-9 and not parameters.override:
        found = Words(f"horizon {parameters.horizon} * sample_period_s {parameters.sample_period_s:g} = {span_s:g} s")
        raise InputError("controller", law, found, f"more than the longest delay, {delay_s:g} s", _HINT)


def refuse_unstable(
    law: str,
    parameters: GpcParameters,
    model: Sampled,
    weights: Weights[float],
    mode: str,
    delay_s: float,
    unit: Unit,
    smoothing: float | None,
) -> float:
    """The spectral radius of the closed loop in one mode (``traction``, ``braking``), also with the residual closed.

    :raises InputError: it is 1 or more and ``parameters.override`` is not set.
    """
    train = Train(delay_s, unit.lag_s)
    loops = [spectral_radius(train, model, weights, unit.sample_period_s, part) for part in {None, smoothing}]
    radius = max(loops)
    if radius >= 1.0 and not parameters.override:
        found = Words(f"a closed loop with the spectral radius {radius:.3f} in {mode}")
        raise InputError("controller", law, found, "a spectral radius below 1", _HINT)
    return radius
