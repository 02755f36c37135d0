"""Refusals at load: a horizon that ends before the command acts, and an unstable closed loop (spec D1)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

from railhil.common.errors import InputError, Words

if TYPE_CHECKING:
    from railhil.controller_node.high_speed.law import LawParameters


class Spanning(Protocol):
    """Parameters of a law with a horizon."""

    @property
    def horizon(self) -> int: ...

    @property
    def sample_period_s(self) -> float: ...

    @property
    def override(self) -> bool: ...


_HINT = "parameter override = true runs it"


def refuse_short_horizon(law: str, parameters: Spanning, delay_s: float) -> None:
    """Refuse N * T0 <= T: within such a horizon no command has any effect, or the wrong one.

    :param delay_s: the longest delay.
    :raises InputError: the horizon is too short and ``parameters.override`` is not set.
    """
    span_s = parameters.horizon * parameters.sample_period_s
    if span_s <= delay_s + 1e-9 and not parameters.override:
        found = Words(f"horizon {parameters.horizon} * sample_period_s {parameters.sample_period_s:g} = {span_s:g} s")
        raise InputError("controller", law, found, f"more than the longest delay, {delay_s:g} s", _HINT)


def refuse_unstable(law: str, parameters: LawParameters, radii: Mapping[str, float]) -> None:
    """Refuse a closed loop with a spectral radius of 1 or more.

    :param radii: of each mode of the train, in words (``traction``, ``braking``).
    :raises InputError: one of them is 1 or more and ``parameters.override`` is not set.
    """
    mode, radius = max(radii.items(), key=lambda pair: pair[1])
    if radius >= 1.0 and not parameters.override:
        found = Words(f"a closed loop with the spectral radius {radius:.3f} in {mode}")
        raise InputError("controller", law, found, "a spectral radius below 1", _HINT)
