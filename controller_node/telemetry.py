"""Telemetry of every named quantity of a law: extremes, headroom, wraps, saturations, divisions by zero.

Requirement: each variable of a fixed-point controller reports its used range and every event that corrupted it.
The values come from :meth:`~railhil.controller_node.arithmetic.base.Arithmetic.note`, the events from the arithmetic
itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP, Arithmetic
from railhil.controller_node.program.model import Quantity

#: Bits of an int32 without its sign.
VALUE_BITS = 31


@dataclass(frozen=True, slots=True)
class QuantityTelemetry:
    """One quantity since the start, ``minimum`` and ``maximum`` in ``unit``; None before the first step.

    ``used_bits``: bits of the largest magnitude of the raw value, without the sign (INT32_MIN uses all 31);
    ``headroom_bits``: the rest of 31. Raw values and bits are None in an arithmetic without formats. ``steps`` counts
    control periods; over N trains the extremes are those of all trains, and an event counts once for each affected
    train.
    """

    name: str
    q: int
    unit: str
    minimum_raw: int | None
    maximum_raw: int | None
    minimum: float | None
    maximum: float | None
    used_bits: int | None
    headroom_bits: int | None
    wraps: int
    saturations: int
    zero_divisions: int
    steps: int


class Telemetry:
    """Telemetry of a law's quantities, on one arithmetic, for one train or for arrays over N.

    The arithmetic must have a list in ``noted``; :meth:`take` empties it.

    :param quantities: in the order in which the law notes them, at least one
        (:attr:`~railhil.controller_node.program.model.LawProgram.quantities`).
    """

    def __init__(self, quantities: Sequence[Quantity]) -> None:
        self.quantities = tuple(quantities)
        self.steps = 0
        #: A list keeps what was noted in each control period, raw (in an arithmetic without formats: the values).
        self.history: list[list[Any]] | None = None
        self._wide = False
        self._batch = False
        self._lows: list[Any] = []
        self._highs: list[Any] = []
        # Kind of event -> count for each quantity.
        self._events = {kind: [0] * len(self.quantities) for kind in (WRAP, SATURATION, DIVISION_BY_ZERO)}

    def take(self, arithmetic: Arithmetic[Any]) -> None:
        """Take the quantities that the arithmetic has noted in one control period, and the events in it.

        An event is assigned to the quantity noted next, because it occurred during its computation; after the last
        note, to the last one. Between two periods (when the law is told the notch really sent) there are only events.

        :raises ValueError: the number of noted values differs from the number of quantities (or 0), or nothing is noted
            at all.
        """
        noted = arithmetic.noted
        if noted is None:
            raise ValueError("the arithmetic notes nothing")
        if arithmetic.events:
            last = len(self.quantities) - 1
            for index, kind, count in arithmetic.events:
                self._events[kind][min(index, last) if noted else last] += count
            arithmetic.events.clear()
        if not noted:
            return
        if len(noted) != len(self.quantities):
            raise ValueError(f"{len(noted)} values noted, {len(self.quantities)} quantities known")
        if self.steps == 0:
            self._wide = arithmetic.wide
            self._batch = any(isinstance(value, np.ndarray) for value in noted)
        lows: list[Any] = noted
        highs: list[Any] = noted
        if self._batch:
            lows = [np.minimum.reduce(value, axis=None) for value in noted]
            highs = [np.maximum.reduce(value, axis=None) for value in noted]
        if self.steps == 0:
            self._lows, self._highs = list(lows), list(highs)
        else:
            # Twice as fast as min() and max(): this runs in every control period.
            self._lows = [new if new < old else old for new, old in zip(lows, self._lows, strict=True)]
            self._highs = [new if new > old else old for new, old in zip(highs, self._highs, strict=True)]
        self.steps += 1
        if self.history is not None:
            self.history.append(list(noted))
        noted.clear()

    def row(self, index: int) -> QuantityTelemetry:
        """Telemetry of one quantity by its number."""
        quantity = self.quantities[index]
        low_raw = high_raw = used_bits = headroom_bits = None
        low = high = None
        if self.steps and self._wide:
            low, high = float(self._lows[index]), float(self._highs[index])
        elif self.steps:
            low_raw, high_raw = int(self._lows[index]), int(self._highs[index])
            low, high = math.ldexp(low_raw, -quantity.q), math.ldexp(high_raw, -quantity.q)
            used_bits = min(max(abs(low_raw), abs(high_raw)).bit_length(), VALUE_BITS)
            headroom_bits = VALUE_BITS - used_bits
        return QuantityTelemetry(
            quantity.name,
            quantity.q,
            quantity.unit,
            low_raw,
            high_raw,
            low,
            high,
            used_bits,
            headroom_bits,
            self._events[WRAP][index],
            self._events[SATURATION][index],
            self._events[DIVISION_BY_ZERO][index],
            self.steps,
        )

    @property
    def rows(self) -> tuple[QuantityTelemetry, ...]:
        """Telemetry of every quantity, in the order of the notes."""
        return tuple(self.row(index) for index in range(len(self.quantities)))
