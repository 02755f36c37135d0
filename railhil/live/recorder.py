"""The recorder: the supervisor's link to the bus, and the loop that takes frames until the run has ended.

It looks for other benches on the bus first; the loop notices when it cannot continue. Signals that end a run are
handled only at safe points.
"""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.bus.errors import BusLost, BusOccupied, BusUnavailable
from railhil.bus.link import Link, open_link
from railhil.bus.order import BusOrder
from railhil.bus.own_frames import supervisor_polls
from railhil.bus.select import BusChoice
from railhil.common.exit_codes import INVALID, PASS, Signalled, ending_signals, leave_terminal
from railhil.common.patience import LATER_S
from railhil.common.scheduling import RECORDER_PRIORITY, Scheduling, cycle
from railhil.dbc import house_contract
from railhil.live.processes import Node, Nodes
from railhil.record.session import Session
from railhil.scenarios.run_spec import RunSpec


class StopSignals:
    """Notes SIGINT, SIGTERM and SIGHUP for a loop to check; re-entrant.

    As exceptions they could occur anywhere, and inside a buffered write the content of the buffer would be lost.
    """

    def __init__(self) -> None:
        #: Number of the first signal received, 0 for none.
        self.number = 0
        self._before: dict[signal.Signals, Any] = {}
        self._entered = 0
        self._at_once = False

    def __enter__(self) -> StopSignals:
        self._entered += 1
        # Python delivers signals only to its main thread; another thread of a user's program cannot handle them.
        if self._entered == 1 and threading.current_thread() is threading.main_thread():
            self._before = {number: signal.signal(number, self._note) for number in ending_signals()}
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._entered -= 1
        if self._entered == 0:
            for number, handler in self._before.items():
                signal.signal(number, handler)
            self._before = {}

    @contextmanager
    def interrupt_at_once(self) -> Iterator[None]:
        """A section that may be interrupted anywhere: a signal raises there at once, like :meth:`check`."""
        self._at_once = True
        try:
            self.check()
            yield
        finally:
            self._at_once = False

    def _note(self, number: int, at: FrameType | None) -> None:
        if number == signal.SIGHUP:
            leave_terminal()
        self.number = self.number or number
        if self._at_once:
            self.check()

    def check(self) -> None:
        """Raise here the exception that the signal would have raised.

        :raises KeyboardInterrupt: SIGINT came.
        :raises Signalled: SIGTERM or SIGHUP came.
        """
        if self.number == signal.SIGINT:
            raise KeyboardInterrupt
        if self.number:
            raise Signalled(128 + self.number)


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
        if any(node.role == "hub" for node in nodes.list_ended()):
            raise BusUnavailable("the hub has ended")

    waiting = {"while_connecting": look} if choice.needs_hub else {}
    try:
        link = open_bus(choice.config | waiting | (_bulk_reading(choice) if lockstep else {}), "supervisor")
    except BusUnavailable:
        if (node := nodes.failed_node()) is not None:
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
    return {"coalesce_frames": _BULK_FRAMES, "wake_on": [*supervisor_polls(house_contract())]}


def refuse_occupied(link: Link, choice: BusChoice) -> None:
    """Listen before the nodes are started: two benches on one bus would corrupt both runs.

    :raises BusOccupied: a bus administrator is polling there.
    """
    poll_id = house_contract().poll_id
    deadline_s = time.monotonic() + _LISTEN_S
    while (rest_s := deadline_s - time.monotonic()) > 0:
        if any(frame.can_id == poll_id and not frame.flags for frame in link.receive(rest_s)):
            raise BusOccupied(f"bus {choice.transport}: another bench is running on it; wait for its end, or --attach")


#: Real time: wall time without a tick after which a started run counts as dead, outages of the interface excluded.
#: In lockstep the limit is slightly longer than the plant's patience.
SILENCE_S = 4.0
#: Time for the other nodes to stop by themselves after a node was lost; while the plant ticks, the record goes on.
AFTER_LOSS_S = 4.0
#: Real time: wall time for which the controller may be suspended by a signal; then it counts as lost. The time for
#: which a fault of the run stops it is added.
SUSPENDED_S = 5.0
#: Interval (wall time) at which it checks the nodes, and in lockstep writes the frames that have arrived.
LOOK_S = 0.05
#: Interval (wall time) at which the log is flushed to the kernel: about the part that a killed recorder can lose.
FLUSH_S = 0.2


class Recorder:
    """Passes frames from a link to the session of a run, and watches the nodes meanwhile.

    :param flush: writes the buffer of the log to the kernel.
    :param transport: the bus, for messages.
    :param order: puts frames into the order of the bus; None: they arrive in it.
    :param stopped_s: wall time for which a fault of the run stops the controller.
    :param silence_s: real time: wall time without a tick after which a started run counts as dead.
    :param after_loss_s: wall time for the other nodes to stop by themselves after a node was lost.
    """

    def __init__(
        self,
        session: Session,
        flush: Callable[[], None],
        spec: RunSpec,
        transport: str,
        order: BusOrder | None,
        *,
        stopped_s: float,
        silence_s: float,
        after_loss_s: float,
    ) -> None:
        #: Reason for which the run was given up; empty if it was not.
        self.lost = ""
        #: Scheduling of this process while it recorded.
        self.scheduling = Scheduling()
        self.stopped_s = stopped_s
        self._session = session
        self._flush = flush
        self._spec = spec
        self._transport = transport
        self._order = order
        self._silence_s = silence_s
        self._after_loss_s = after_loss_s

    def record_until_stopped(self, link: Link, nodes: Nodes, stop: StopSignals) -> None:
        """Record until the run has ended, or is given up (:attr:`lost`); with the scheduling of the recorder.

        :raises BusLost: the bus is gone, and no signal has ended the run.
        """
        priority = RECORDER_PRIORITY if self._spec.asks_for_fifo else 0
        with cycle("supervisor", priority, aloud=False) as self.scheduling:
            link.while_waiting = stop.check
            try:
                self.record(link, nodes, stop)
            except BusLost:
                # Ctrl-C also reaches the other nodes, which may end sooner.
                stop.check()
                raise
            stop.check()

    def record(self, link: Link, nodes: Nodes, stop: StopSignals) -> None:
        """Record until the run has ended, or is given up (:attr:`lost`)."""
        try:
            self._record(link, nodes, stop)
        finally:
            self._session.settle()

    def _record(self, link: Link, nodes: Nodes, stop: StopSignals) -> None:
        session = self._session
        look_s = time.monotonic() + LOOK_S
        # In lockstep a panel may follow the record; in real time it listens on a bus.
        interval_s = FLUSH_S if self._spec.is_realtime else 0.0
        flush_s = time.monotonic() + interval_s
        opened_s = open_s = time.monotonic()
        give_up_s: float | None = None
        # Checks in a row are counted, not wall time: this process may have been suspended together with the others.
        suspended_looks = 0
        silence_s = self._silence_s if self._spec.is_realtime else self._spec.patience_s + LATER_S
        # The supervisor observes the nodes that it has started itself; in real time the reaction ladder gets its time.
        told = self._spec.start_up.attach and not self._spec.is_realtime
        apart = not self._spec.is_realtime and bool(nodes.nodes)
        while session.ended is None:
            heard = self._take(link, LOOK_S)
            stop.check()
            if told and self._has_left(link, heard):
                return
            now_s = time.monotonic()
            if link.is_down:
                # The link gives up by itself after a time.
                open_s = now_s
            if apart and session.recording:
                nodes.keep_together()
                apart = False
            if now_s < look_s:
                continue
            look_s = now_s + LOOK_S
            session.settle()
            if now_s >= flush_s:
                self._flush()
                flush_s = now_s + interval_s
            if give_up_s is None:
                ended = nodes.list_ended()
                failed = any(node.exit_code() for node in ended)
                # A node may end normally just before its last frames are read here.
                if failed or (ended and not self.drain(link, stop, ended)):
                    self.lost = self.describe_loss(nodes)
                    give_up_s = now_s + self._after_loss_s
                    # Without a train in motion there is nothing more to record.
                    if ended[0].role != "controller" or not session.recording:
                        return
            elif now_s > max(give_up_s, session.heard_ns / 1e9 + self._after_loss_s):
                # The plant ends the run when its train stands; until then it ticks.
                return
            if self._spec.is_realtime:
                suspended_looks = suspended_looks + 1 if nodes.find_suspended() == "controller" else 0
                if suspended_looks * LOOK_S > SUSPENDED_S + self.stopped_s:
                    self.lost = self.describe_loss(nodes)
                    return
            # Only the plant's ticks count: a shared bus may always carry frames of other nodes.
            if not session.recording and now_s - opened_s > self._spec.start_up.appear_s + LATER_S:
                self.lost = self.lost or f"no plant on {self._transport} within {self._spec.start_up.appear_s:g} s"
                return
            if session.recording and now_s - max(open_s, session.heard_ns / 1e9) > silence_s:
                stuck = f"no tick for {silence_s:g} s of wall time: bench is deadlocked"
                self.lost = self.lost or self.describe_loss(nodes) or stuck
                return

    def await_controller(self, nodes: Nodes, stop: StopSignals) -> None:
        """A controller that a fault has stopped continues by itself, and then writes the log of the fault."""
        give_up_s = time.monotonic() + self.stopped_s
        while nodes.find_suspended() == "controller" and time.monotonic() < give_up_s and not stop.number:
            time.sleep(LOOK_S)

    def _has_left(self, link: Link, heard: bool) -> bool:
        """Record which node was the first to leave an unfinished run; True if nothing more can come."""
        gone = [node for node in ("controller", "plant") if link.has_ended(node)] if self._session.recording else []
        over = "plant" in gone and not heard
        if gone and not self.lost and (over or self._session.ending is None):
            self.lost = f"{gone[0]} left the bus at simulation time {self._session.sim_time_s:.2f} s"
        return over

    def drain(self, link: Link, stop: StopSignals, ended: list[Node]) -> bool:
        """Read the frames still queued after nodes have ended; True if the run ended normally with them.

        Frames of other nodes may keep arriving, and a hub that stands still delivers later.
        """
        give_up_s = time.monotonic() + self._after_loss_s
        while self._session.ended is None and time.monotonic() < give_up_s:
            heard = self._take(link, LOOK_S)
            stop.check()
            if not heard and not any(link.may_deliver(node.role) for node in ended):
                break
        return self._session.ended is not None

    def _take(self, link: Link, timeout_s: float) -> bool:
        """Pass arrived frames to the recorder and send its answers; False when nothing came."""
        if link.packed is not None and self._order is None:
            packet = link.packed.receive_packed(timeout_s)
            if packet and (answers := self._session.take_packed(packet)):
                link.send(answers)
            return bool(packet)
        frames = arrived = link.receive(timeout_s)
        if gap_ns := link.take_gap_ns():
            self._session.was_out(gap_ns)
        if self._order is not None:
            frames = [item for frame in arrived for item in self._order.feed(frame)] if arrived else self._order.flush()
        if frames and (answers := self._session.take(frames)):
            link.send(answers)
        return bool(frames or arrived)

    def describe_loss(self, nodes: Nodes) -> str:
        """The missing node and the reason; empty if none is missing."""
        dead = nodes.failed_node()
        at = f"at simulation time {self._session.sim_time_s:.2f} s" if self._session.recording else "before the run"
        if (dead is None or not dead.was_killed) and (role := nodes.find_suspended()):
            return f"{role} lost {at}: suspended by a signal (SIGSTOP) or a debugger"
        if dead is None:
            return ""
        if dead.exit_code() == PASS:
            return f"{dead.role} lost {at}: it has ended, but the end of the run has not arrived here"
        # A node that ends by itself names the node that it waited for, so it is not itself the missing one.
        how = "gave up" if dead.exit_code() == INVALID else "lost"
        return f"{dead.role} {how} {at}: {dead.last_words()}"
