"""Telemetry of the laws of several sections as one: extremes over all of them, events added up."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from railhil.controller_node.program.model import Quantity
from railhil.controller_node.telemetry import QuantityTelemetry, Telemetry


class SectionTelemetry:
    """One :class:`~railhil.controller_node.telemetry.Telemetry` for all laws with the same quantities.

    Laws whose programs differ from section to section have several; their rows are merged by name.
    """

    def __init__(self) -> None:
        self._parts: list[Telemetry] = []
        #: All quantities, in the order of the notes.
        self.quantities: tuple[Quantity, ...] = ()
        # For each quantity: the parts that have it, with its number there.
        self._places: list[list[tuple[Telemetry, int]]] = []

    def join(self, telemetry: Telemetry) -> Telemetry:
        """The telemetry in which a new law takes part: one with its quantities, else its own."""
        names = [(one.name, one.q, one.unit) for one in telemetry.quantities]
        for part in self._parts:
            if names == [(one.name, one.q, one.unit) for one in part.quantities]:
                return part
        self._parts.append(telemetry)
        known = {one.name: number for number, one in enumerate(self.quantities)}
        for number, quantity in enumerate(telemetry.quantities):
            place = known.get(quantity.name)
            if place is None:
                self.quantities += (quantity,)
                self._places.append([(telemetry, number)])
            else:
                self._places[place].append((telemetry, number))
        return telemetry

    @property
    def steps(self) -> int:
        """Control periods in which a law was stepped."""
        return sum(part.steps for part in self._parts)

    def row(self, index: int) -> QuantityTelemetry:
        """Telemetry of one quantity by its number."""
        rows = [part.row(number) for part, number in self._places[index]]
        return rows[0] if len(rows) == 1 else _merge(rows)

    @property
    def rows(self) -> tuple[QuantityTelemetry, ...]:
        """Telemetry of every quantity, in the order of the notes."""
        return tuple(self.row(index) for index in range(len(self.quantities)))


def _merge(rows: list[QuantityTelemetry]) -> QuantityTelemetry:
    return replace(
        rows[0],
        minimum_raw=_least(row.minimum_raw for row in rows),
        maximum_raw=_largest(row.maximum_raw for row in rows),
        minimum=_least(row.minimum for row in rows),
        maximum=_largest(row.maximum for row in rows),
        used_bits=_largest(row.used_bits for row in rows),
        headroom_bits=_least(row.headroom_bits for row in rows),
        wraps=sum(row.wraps for row in rows),
        saturations=sum(row.saturations for row in rows),
        zero_divisions=sum(row.zero_divisions for row in rows),
        steps=sum(row.steps for row in rows),
    )


def _least(values: Iterable[Any]) -> Any:
    return min((value for value in values if value is not None), default=None)


def _largest(values: Iterable[Any]) -> Any:
    return max((value for value in values if value is not None), default=None)
