"""The supervisor's link to the bus: opened for recording, and checked for other benches."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.bus.errors import BusLost, BusOccupied, BusUnavailable
from railhil.bus.link import Link, open_link
from railhil.bus.select import BusChoice
from railhil.bus.supervisor_polls import supervisor_polls
from railhil.dbc import wire_contract
from railhil.live.processes import Nodes

#: Frames that the recorder reads at once from the hub: about a tenth of a second of traffic.
_BULK_FRAMES = 64
#: Listening time: a running bench polls every 20 ms of its time, one that waits for its nodes every 100 ms.
_LISTEN_S = 0.15


def open_recorder(
    choice: BusChoice, nodes: Nodes, lockstep: bool, open_bus: Callable[[dict[str, Any], str], Link] = open_link
) -> Link:
    """Open the bus for the recorder.

    It waits for a hub of the run's own as long as that process lives.

    :param open_bus: makes the link from the arguments of ``can.Bus`` and the name of the node.
    :raises BusUnavailable: it cannot be opened; if the hub has ended, the reason is the hub's.
    :raises BusLost: a signal has ended the hub.
    """

    def look() -> None:
        if any(node.role == "hub" for node in nodes.ended()):
            raise BusUnavailable("the hub has ended")

    waiting = {"while_connecting": look} if choice.needs_hub else {}
    try:
        link = open_bus(choice.config | waiting | (_bulk_reading(choice) if lockstep else {}), "supervisor")
    except BusUnavailable:
        if (node := nodes.blamed()) is not None:
            if node.was_killed:
                raise BusLost(f"{node.role} lost before the run: {node.last_words()}") from None
            raise BusUnavailable(node.last_words()) from None
        raise
    link.lossless = lockstep
    return link


def _bulk_reading(choice: BusChoice) -> dict[str, Any]:
    """On the hub in lockstep, read frames in bulk and wake at once only for polls to be answered."""
    if choice.config.get("interface") != HUB_INTERFACE:
        return {}
    return {"coalesce_frames": _BULK_FRAMES, "wake_on": [*supervisor_polls(wire_contract())]}


def refuse_occupied(link: Link, choice: BusChoice) -> None:
    """Listen before the nodes are started: two benches on one bus would corrupt both runs.

    :raises BusOccupied: a bus administrator is polling there.
    """
    poll_id = wire_contract().poll_id
    deadline_s = time.monotonic() + _LISTEN_S
    while (rest_s := deadline_s - time.monotonic()) > 0:
        if any(frame.can_id == poll_id and not frame.flags for frame in link.receive(rest_s)):
            raise BusOccupied(f"bus {choice.transport}: another bench is running on it; wait for its end, or --attach")
