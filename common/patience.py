"""How long one node waits for another in lockstep, where a slow node and a dead one look the same on the bus.

==================================================== =================================================================
what is known                                        what is done
==================================================== =================================================================
``railhil run`` has started both                     a node that has ended is given up at once (:class:`Lifelines`)
the hub, or the own interface, is gone               the link says so (:class:`railhil.bus.errors.BusLost`)
the hub has said that the other has left it          it is given up at once (:mod:`railhil.bus.hub.wire`)
nothing: the other is a board, on another machine,   it is waited for with patience (``--patience``)
or was started by hand
==================================================== =================================================================
"""

from __future__ import annotations

import select
from collections.abc import Mapping

#: Wall time that an answer may take when nobody says that its owner has ended: on a machine with a load of 9 a process
#: was seen to stand still for 2 to 10 s.
PATIENCE_S = 60.0
#: Wall time for all nodes of a run to appear.
APPEAR_S = 25.0
#: Who waits for the bus administrator waits longer than it does itself, which knows better who is missing.
LATER_S = 2.0


class Lifelines:
    """The reading ends of pipes whose writing ends other processes hold, each only its own, as long as they live.

    The kernel closes a writing end with its process, however that ends; nobody ever writes.

    :param ends: name of a node and the file descriptor that this process has inherited for it.
    """

    def __init__(self, ends: Mapping[str, int] | None = None) -> None:
        self._ends = dict(ends or {})

    def has_ended(self, node: str) -> bool:
        """Whether it is known that a node has ended; False also for one of which nothing is known."""
        end = self._ends.get(node)
        return end is not None and bool(select.select((end,), (), (), 0.0)[0])
