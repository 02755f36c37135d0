"""Waiting times between nodes in lockstep, where a slow node and a dead one look the same on the bus.

==================================================== =================================================================
what is known                                        what is done
==================================================== =================================================================
``railhil run`` has started both                     a node that has ended is given up at once (:class:`Lifelines`)
the hub, or the own interface, is gone               the link says so (:class:`railhil.bus.errors.BusLost`)
the hub has reported that the other has left it      it is given up at once (:mod:`railhil.bus.packing`)
nothing: the other is a board, on another machine,   it is given a limited time (``--patience``)
or was started by hand
==================================================== =================================================================
"""

from __future__ import annotations

import select
from collections.abc import Mapping
from typing import Protocol

#: Longest wall time for an answer from a node that is not known to have ended: on a machine with a load of 9 a process
#: was observed to be stalled for 2 to 10 s.
PATIENCE_S = 60.0
#: Wall time for all nodes of a run to appear.
APPEAR_S = 25.0
#: Nodes wait longer for the bus administrator than it waits itself, because it knows better which node is missing.
LATER_S = 2.0


class Lifelines:
    """Read ends of pipes; each other process holds the write end of its own pipe open for as long as it lives.

    The kernel closes the write end when its process ends in any way; nothing is ever written.

    :param ends: name of a node and the file descriptor that this process has inherited for it.
    """

    def __init__(self, ends: Mapping[str, int] | None = None) -> None:
        self._ends = dict(ends or {})

    def has_ended(self, node: str) -> bool:
        """Whether a node is known to have ended; also False for a node without a pipe."""
        end = self._ends.get(node)
        return end is not None and bool(select.select((end,), (), (), 0.0)[0])


class WallClock(Protocol):
    """Monotonic wall time and waiting; the module :mod:`time` is one."""

    def monotonic(self) -> float:
        """Monotonic wall time in s."""

    def monotonic_ns(self) -> int:
        """The same in ns."""

    def sleep(self, seconds: float, /) -> None:
        """Wait for this many seconds."""
