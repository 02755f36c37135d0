"""Conditions that are bound to a scenario: their comparisons, and the margins that they make of theirs on a grid."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from railhil.judge.requirements.grid import Grid
from railhil.judge.requirements.units import Unit
from railhil.record.trace import FloatArray

Margins: TypeAlias = Callable[[Grid], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class Leaf:
    """A comparison or an event: the smallest part of a condition with margins of its own, in ``unit``.

    ``scale``: size by which margins of different units are divided to be compared; None: the standard deviation of the
    margins of the run.
    """

    text: str
    unit: Unit
    margins: Margins
    scale: float | None = 1.0
    periods_ns: Mapping[str, int] = field(default_factory=dict)

    def on(self, grid: Grid) -> FloatArray:
        """Its margins at each tick, shape (n,)."""
        found = grid.kept.get(self)
        if found is None:
            found = grid.kept[self] = self.margins(grid)
        return found

    def scale_on(self, grid: Grid) -> float:
        """Its scale for a record."""
        if self.scale is not None:
            return self.scale
        margins = self.on(grid)
        known = margins[np.isfinite(margins)]
        return _deviation(known) or 1.0 if len(known) else 1.0


def _deviation(values: FloatArray) -> float:
    """Standard deviation. A running sum adds in one order on every processor."""
    away = values - np.cumsum(values)[-1] / len(values)
    return float(np.sqrt(np.cumsum(away * away)[-1] / len(values)))


@dataclass(frozen=True, slots=True, eq=False)
class Bound:
    """A condition: its leaves, and the margins that it makes of theirs."""

    leaves: tuple[Leaf, ...]
    joined: Callable[[Grid, Callable[[Leaf], FloatArray]], FloatArray]

    @property
    def unit(self) -> Unit | None:
        """The unit of its margins: that of its first leaf; None if its leaves have different dimensions."""
        first = self.leaves[0].unit
        alike = all(leaf.unit.dimensions == first.dimensions for leaf in self.leaves)
        return first if alike else None

    @property
    def periods_ns(self) -> dict[str, int]:
        """Periods of the ports that it depends on."""
        return {port: period_ns for leaf in self.leaves for port, period_ns in leaf.periods_ns.items()}

    def on(self, grid: Grid) -> FloatArray:
        """Its margins at each tick, shape (n,): in :attr:`unit`; without one each leaf divided by its scale."""
        unit = self.unit

        def margins(leaf: Leaf) -> FloatArray:
            if unit is None:
                return leaf.on(grid) / leaf.scale_on(grid)
            ratio = leaf.unit.factor / unit.factor
            return leaf.on(grid) if ratio == 1 else leaf.on(grid) * float(ratio)

        return self.joined(grid, margins)


def alone(leaf: Leaf) -> Bound:
    """A condition of one leaf."""
    return Bound((leaf,), lambda grid, margins: margins(leaf))


def pulses(found: npt.NDArray[np.bool_]) -> FloatArray:
    """Margins of an event, in steps: above 0 at its ticks."""
    return np.where(found, 1.0, -1.0)
