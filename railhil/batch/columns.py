"""The signals that a batch keeps of a run, in the form of a record: enough for the score and the digest."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from railhil.dbc import Contract
from railhil.record.trace import Trace

Ints: TypeAlias = NDArray[np.int64]


class Columns(Trace):
    """A trace made of columns of raw values. A port has the instants given, and signals that are not given are 0.

    :param ports: port -> (instants in ns, signal -> raw values).
    """

    def __init__(self, contract: Contract, ports: Mapping[str, tuple[Ints, Mapping[str, Ints]]]) -> None:
        super().__init__(contract)
        self._columns = {port: columns for port, (_, columns) in ports.items()}
        self._times_ns = {port: array("q", instants.tobytes()) for port, (instants, _) in ports.items()}
        self.end_ns = max((times[-1] for times in self._times_ns.values() if times), default=0)

    def add(self, port: str, time_ns: int, data: bytes) -> None:
        """Refused: the columns are complete."""
        raise TypeError(f"{port} is recorded already")

    def raw(self, port: str, signal: str) -> NDArray[Any]:
        if not self.has(port, signal):
            raise KeyError(f"{port}.{signal}")
        found = self._columns.get(port, {}).get(signal)
        return np.zeros(self.count(port), dtype=np.int64) if found is None else found
