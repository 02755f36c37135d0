"""Bounds of each quantity for all readings possible on the wire, from interval analysis of the recorded law."""

from __future__ import annotations

from dataclasses import dataclass
from math import ldexp

from railhil.controller_node.law_controller import LawController
from railhil.controller_node.program.ranges import analyse_law
from railhil.controller_node.telemetry import VALUE_BITS


@dataclass(frozen=True, slots=True)
class Bound:
    """Bounds of one quantity in its unit, and the headroom of its format at these bounds."""

    name: str
    minimum: float
    maximum: float
    headroom_bits: int


@dataclass(frozen=True, slots=True)
class Bounds:
    """Bounds of all quantities, and the number of operations for which the analysis cannot exclude a wrap."""

    quantities: tuple[Bound, ...]
    may_wrap: int


def bounds_of(controller: LawController) -> Bounds:
    """Bounds of a law in fixed point."""
    program = controller.program
    ranges = analyse_law(program, controller.law.state_bounds(), controller.wire)
    found = []
    for part, within in ((program.inputs, ranges.inputs), (program.step, ranges.step)):
        for quantity in part.quantities:
            low, high = within.of(quantity.value)
            used_bits = min(max(abs(low), abs(high)).bit_length(), VALUE_BITS)
            lsb = ldexp(1.0, -quantity.q)
            found.append(Bound(quantity.name, low * lsb, high * lsb, VALUE_BITS - used_bits))
    return Bounds(tuple(found), len(ranges.may_wrap))
