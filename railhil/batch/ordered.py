"""The law of many trains as orders in machine code: replaces the loop of the law on arrays, with the same results.

For the shipped laws in the fixed point of the C28x and in double precision. In another arithmetic, and for a law of
somebody else or with an operation that has no order, the law itself is computed on arrays
(:class:`railhil.controller_node.loop.ControlLoop`).
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from railhil.batch.floats import run_floats
from railhil.batch.ints import run_ints
from railhil.batch.lanes import LANES
from railhil.batch.orders import Assembly, NotInOrdersError, Orders
from railhil.controller_node.arithmetic import make
from railhil.controller_node.arithmetic.base import DIVISION_BY_ZERO, SATURATION, WRAP
from railhil.controller_node.compiled_law import is_shipped
from railhil.controller_node.laws import load
from railhil.controller_node.laws.base import BaliseReading
from railhil.controller_node.loop import NO_BALISE, ControlLoop
from railhil.controller_node.program.record import record
from railhil.scenarios.model import Scenario
from railhil.scenarios.run_spec import LawSpec

#: Arithmetics whose operations have orders.
_ARITHMETICS = ("iq", "float64")
#: Events in the order of the rows of the counts.
_KINDS = (WRAP, SATURATION, DIVISION_BY_ZERO)


class Notches(NamedTuple):
    """The output that the batch uses."""

    notch: NDArray[Any]


class OrderedLoop:
    """A control loop whose law is carried out as orders.

    ``arithmetic``: on arrays, for its conversions and the counts of events. ``state``: set to None it begins anew.
    ``track``: whether the law reads the last balise.

    :param assembly: made for this arithmetic.
    """

    def __init__(self, assembly: Assembly, arithmetic: str) -> None:
        self.arithmetic: Any = make(arithmetic, batch=True)
        self._assembly = one = assembly
        self.track = one.track
        self._dtype: Any = np.float64 if self.arithmetic.wide else np.int64
        self._given = np.array(one.given, dtype=np.int64) * LANES
        self._terms = np.array(one.terms, dtype=np.int64).reshape(-1, 3)
        self._loose = np.array(one.loose or [0], dtype=self._dtype)
        self._pool = np.array(one.pool or [0], dtype=self._dtype)
        self._parts = {
            id(orders): [(orders.array[begin:end], pause) for begin, end, pause in _stretches(orders)]
            for orders in (one.inputs, one.start, one.step)
        }
        #: Rows of all blocks, (blocks, rows * LANES); None before the first step.
        self.state: Any = None

    def step(
        self, k: Any, speed_01mmps: Any, position_01mm: Any, balise: BaliseReading[Any] = NO_BALISE
    ) -> tuple[None, Notches]:
        """One control period of all trains."""
        trains = np.size(speed_01mmps)
        values = [k, speed_01mmps, position_01mm, *(balise if self.track else ())]
        blocks = -(-trains // LANES)
        wire = np.empty((len(values), blocks * LANES), dtype=self._dtype)
        for row, value in zip(wire, values, strict=True):
            row[:trains] = value
            # Lanes without a train do what the first train does.
            row[trains:] = row[0]
        if self.state is None:
            self._begin(blocks)
            self._carry_out(self._assembly.inputs, wire)
            self._carry_out(self._assembly.start, wire)
        else:
            self._carry_out(self._assembly.inputs, wire)
        self._carry_out(self._assembly.step, wire)
        self._count(trains)
        return None, Notches(self._row(self._assembly.notch * LANES)[:trains])

    def _begin(self, blocks: int) -> None:
        one = self._assembly
        self.state = np.zeros((blocks, one.count * LANES), dtype=self._dtype)
        for row, number in one.fixed.items():
            self.state[:, row * LANES : (row + 1) * LANES] = number
        self._counts = np.zeros((len(_KINDS), blocks * LANES), dtype=np.int64)

    def _row(self, place: int) -> NDArray[Any]:
        row: NDArray[Any] = self.state[:, place : place + LANES].reshape(-1)
        return row

    def _carry_out(self, orders: Orders, wire: NDArray[Any]) -> None:
        shared = self._terms, self._loose, self._pool, self.state
        for code, pause in self._parts[id(orders)]:
            if self.arithmetic.wide:
                run_floats(self._given, wire, code, *shared)
            else:
                run_ints(self._given, wire, code, *shared, self._counts)
            if pause is not None:
                found = self.arithmetic.curve(pause.curve, self._row(pause.argument))
                self.state[:, pause.result : pause.result + LANES] = found.reshape(-1, LANES)

    def _count(self, trains: int) -> None:
        """Pass the events of this period to the arithmetic, where the batch expects them."""
        if not self._counts.any():
            return
        counters, per_train = self.arithmetic.counters, self.arithmetic.per_train
        for kind, row in zip(_KINDS, self._counts[:, :trains], strict=True):
            if per_train is not None:
                per_train[kind] += row
            counters.wraps += int(row.sum()) if kind == WRAP else 0
            counters.saturations += int(row.sum()) if kind == SATURATION else 0
            counters.zero_divisions += int(row.sum()) if kind == DIVISION_BY_ZERO else 0
        self._counts[:] = 0


def _stretches(orders: Orders) -> list[tuple[int, int, Any]]:
    """Orders from one pause to the next: begin, end, the pause behind them."""
    found, begin = [], 0
    for pause in orders.pauses:
        found.append((begin, pause.before, pause))
        begin = pause.before
    return [*found, (begin, len(orders.rows), None)]


#: The laws assembled last: a campaign makes a loop for each of its chunks.
_KEPT = 8
_kept: list[tuple[Scenario, LawSpec, Assembly | None]] = []


def _assembly(scenario: Scenario, law: LawSpec) -> Assembly | None:
    """The orders of a law, None if it must be computed itself."""
    for known in _kept:
        if known[1] == law and known[0] == scenario:
            return known[2]
    found = None
    if law.arithmetic in _ARITHMETICS and is_shipped(load(law.controller)):
        number = make(law.arithmetic)
        # Otherwise it has an operation that is none of the arithmetic's own.
        with suppress(NotInOrdersError):
            found = Assembly(record(scenario, law, wide=number.wide), number)
    _kept.insert(0, (scenario, law, found))
    del _kept[_KEPT:]
    return found


def loop_of(scenario: Scenario, law: LawSpec) -> Any:
    """The loop of a law on arrays: as orders where that is possible.

    :raises InputError: as :class:`ControlLoop`.
    """
    assembly = _assembly(scenario, law)
    if assembly is None:
        return ControlLoop(scenario, law, make(law.arithmetic, batch=True))
    return OrderedLoop(assembly, law.arithmetic)
