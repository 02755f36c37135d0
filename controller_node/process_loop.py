"""The loop of the controller process: frames from the bus to the node, its answers to the bus."""

from __future__ import annotations

import time
from typing import Final

from railhil.bus.errors import PeerSilent
from railhil.bus.link import Link
from railhil.common.patience import LATER_S, PATIENCE_S
from railhil.controller_node.controller import AnyController

#: Real time: a controller that receives nothing for this long on the wall clock ends.
SILENCE_S: Final = 3.0
#: The controller waits longer for the first frame: the other nodes may be started by hand, on a loaded machine.
FIRST_FRAME_S: Final = 300.0


def serve(
    node: AnyController, endpoint: Link, *, appear_s: float = FIRST_FRAME_S, patience_s: float = PATIENCE_S
) -> None:
    """Answer the bus administrator until the run has ended, including during outages of the interface.

    :param appear_s: wall time for its first frame.
    :param patience_s: its patience with the other nodes, in lockstep.
    :raises BusLost: the bus has been lost.
    :raises PeerSilent: nothing was received for too long.
    """
    heard_s = time.monotonic()
    limit_s, heard = appear_s, False
    while node.ended is None:
        frames = endpoint.receive(0.5)
        if gap_ns := endpoint.take_gap_ns():
            node.was_out(gap_ns)
        for frame in frames:
            answers = node.handle(frame)
            if answers:
                endpoint.lossless = node.lockstep
                endpoint.send(answers)
        now_s = time.monotonic()
        if frames:
            heard, heard_s, limit_s = True, now_s, patience_s + LATER_S if node.lockstep else SILENCE_S
        elif heard and node.lockstep and endpoint.has_ended("plant"):
            raise PeerSilent("controller waits for the bus administrator, which has ended")
        elif endpoint.is_down:
            # The link itself gives up after a time.
            heard_s = now_s
        elif now_s - heard_s > limit_s:
            raise PeerSilent(f"controller waits for the bus administrator: no frame for {limit_s:g} s")


def run_controller(
    node: AnyController, endpoint: Link, *, appear_s: float = FIRST_FRAME_S, patience_s: float = PATIENCE_S
) -> int:
    """Like :func:`serve`, then leave the bus; returns an exit code."""
    try:
        serve(node, endpoint, appear_s=appear_s, patience_s=patience_s)
    finally:
        endpoint.close()
        endpoint.tell_trouble()
    return 0
