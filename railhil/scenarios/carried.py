"""Compares the values that a run can reach with the ranges of its signals, when a scenario is loaded.

A :class:`Reach` gives the range of a quantity in a run of the scenario, by the keys that determine it. The port table
gives the range of the signal. Normal draws count up to :data:`SIGMAS` standard deviations. Values beyond (a rarer draw,
a fault, a train that does not stop) are not refused here: a reading then stays at the end of its range with an
erroneous check variable, and any other value ends the run: as INVALID if a fault in the plant has begun (the truth
alone, other values stay at the end of the range, too), else as an error of the plant.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

from railhil.common.errors import InputError
from railhil.dbc import Contract

#: Standard deviations up to which a normal draw must be carried; one in 500 million goes further.
SIGMAS = 6.0
Keys = tuple[str | int, ...]


class Reach(NamedTuple):
    """Range of a quantity: ``PORT.Signal``, the smallest and the largest value in its unit.

    ``keys``, ``found``: the key that is named when the signal cannot carry it, and its value.
    """

    signal: str
    low: float
    high: float
    keys: Keys
    found: object


def check_carried(
    contract: Contract, reaches: Iterable[Reach], refuse: Callable[[Keys, object, str], InputError]
) -> None:
    """Refuse values that the wire cannot carry.

    :raises InputError: a quantity can leave the range of its signal.
    """
    for reach in reaches:
        port, _, name = reach.signal.partition(".")
        signal = contract.port(port).signal(name)
        lowest, highest = (raw * signal.scale for raw in signal.raw_range)
        if signal.minimum is not None and signal.maximum is not None:
            lowest, highest = signal.minimum, signal.maximum
        # Half a count is rounded to the end of the range.
        if not lowest - signal.scale / 2 <= reach.low <= reach.high <= highest + signal.scale / 2:
            off = reach.low if reach.low < lowest else reach.high
            allowed = f"a value that keeps {reach.signal} within {lowest:.10g} to {highest:.10g} {signal.unit}"
            raise refuse(reach.keys, reach.found, f"{allowed.rstrip()}; this one makes it up to {off:.10g}")
