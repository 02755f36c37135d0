"""The telegrams that a node has received in a run, as it counts them; the supervisor compares them with the record.

A document for ``NODE.sent`` and ``certificate.json``::

    ports   by name: committed  telegrams that the traffic store has taken
                     accepted   those that the check behind it has taken, if there is one for the port
                     refused    those that it has not taken, by cause
                     lost       frames overwritten unread in the CAN module
    frames  frames and telegrams that the traffic store has refused, by cause; no_answer: empty frames of a source that
            does not answer; late: frames that came after the reply time-out and were dropped (plant, real time)
    gaps    times in which an injected fault kept everything from the node, in their order: by port the number of its
            telegrams before and in the gap; restarted: the node began anew after it
    by_task mailboxes are read by a task, so that telegrams overwrite each other
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Final

from railhil.bus.frame import Frame
from railhil.bus.store import TrafficStore
from railhil.dbc import Port

#: Counters of a receiver's check that are no refusals.
NOT_REFUSED: Final = ("accepted", "gap", "safe_source", "safe_channel")
_SUMMED: Final = ("committed", "accepted", "lost")

Document = dict[str, Any]


def reception(store: TrafficStore, judged: Mapping[str, tuple[int, Mapping[str, int]]]) -> Document:
    """The document of a node.

    :param judged: for each port whose telegrams are checked behind the store: how many were accepted, and the counters
        of that check.
    """
    ports: dict[str, Document] = {port: {"committed": store.accepted(port)} for port in store.ports}
    for port, (accepted, counters) in judged.items():
        refused = {cause: count for cause, count in counters.items() if cause not in NOT_REFUSED}
        ports[port] |= {"accepted": accepted, "refused": refused}
    return {"ports": ports, "frames": dict(store.counters), "gaps": []}


def received_by(nodes: Mapping[str, object]) -> dict[str, Document]:
    """The documents of nodes by name, for the nodes that count their telegrams (attribute ``received``)."""
    told = {name: getattr(node, "received", None) for name, node in nodes.items()}
    return {name: document for name, document in told.items() if document is not None}


def summed(documents: Sequence[Document], gaps: Sequence[Document]) -> Document:
    """One document of a node that was started several times."""
    ports: dict[str, Document] = {}
    frames: Counter[str] = Counter()
    for document in documents:
        frames.update(document["frames"])
        for name, own in document["ports"].items():
            port = ports.setdefault(name, {})
            for key in _SUMMED:
                if key in own:
                    port[key] = port.get(key, 0) + own[key]
            if "refused" in own:
                port["refused"] = dict(Counter(port.get("refused", {})) + Counter(own["refused"]))
    return {**documents[-1], "ports": ports, "frames": dict(frames), "gaps": list(gaps)}


class Gap:
    """Telegrams that a fault keeps from a node, from one instant to another.

    :param before: the node's document at its beginning, with the gaps before it.
    :param ports: of the contract.
    :param restarted: the node began anew after it.
    """

    def __init__(self, before: Document, ports: Sequence[Port], restarted: bool = False) -> None:
        earlier = before["gaps"]
        self._store = TrafficStore([port for port in ports if port.name in before["ports"]])
        self._first = {
            name: port["committed"] + sum(gap["ports"][name]["count"] for gap in earlier)
            for name, port in before["ports"].items()
        }
        self._restarted = restarted

    def take(self, frame: Frame) -> None:
        """A frame that the node does not get."""
        self._store.feed(frame, 0)

    def document(self) -> Document:
        """Its entry under ``gaps``."""
        ports = {name: {"first": first, "count": self._store.accepted(name)} for name, first in self._first.items()}
        return {"restarted": self._restarted, "ports": ports}
