"""The controller with faults: its answers pass them, and faults of its process are acted out here.

In lockstep the bus administrator waits for the answer to every poll. If an answer is lost, held back or never made, the
controller therefore sends an empty frame on the telegram's last identifier, which means "no answer"
(:mod:`railhil.bus.administrator`). In real time nothing is sent.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

from railhil.bus.codes import Event
from railhil.bus.frame import Frame
from railhil.bus.injector.holding import LOST
from railhil.bus.injector.node_faults import NodeFaults
from railhil.bus.mvb import parse_master_frame
from railhil.bus.own_frames import OwnFrames, no_answer
from railhil.bus.reception import Document, Gap, summed
from railhil.dbc import Contract, Port
from railhil.faults.model import Injection


class Served(Protocol):
    """Interface of a controller under faults (:class:`railhil.controller_node.controller.AnyController`)."""

    ended: Event | None

    @property
    def lockstep(self) -> bool:
        """True unless the pace is known to follow the wall clock."""

    def handle(self, frame: Frame, /) -> list[Frame]:
        """Take one frame; returns the answer to a poll."""

    def was_stopped(self, sim_ns: int, /) -> None:
        """Take note that nothing was received for some simulation time while the node's own timer ran on."""


class FaultyController:
    """A controller under the faults of its node; calls that are not about frames go to the controller itself.

    :param make: makes the controller, again after a restart.
    :param kill: ends the process at once; None: the controller shares the process of the other nodes and only falls
        silent.
    :param pause: stops the process for a time on the wall clock in s; None: acted out in simulation time.
    """

    def __init__(
        self,
        make: Callable[[], Any],
        faults: NodeFaults,
        contract: Contract,
        kill: Callable[[], None] | None = None,
        pause: Callable[[float], None] | None = None,
    ) -> None:
        self._make = make
        self._node: Served = make()
        self.faults = faults
        self._kill = kill
        self._pause = pause
        self._poll_id = contract.poll_id
        self._own = OwnFrames(contract)
        self._polled: Mapping[int, Port] = {
            port.f_code << 12 | port.address: port
            for port in contract.ports
            if port.source == "controller" and port.mode == "poll" and port.period_ns
        }
        #: True when a fault has killed it.
        self.is_gone = False
        faults.attach(self._take)
        # Instant since when it hears nothing, and the frames that it will still be given.
        self._deaf_since_ns: int | None = None
        self._backlog: list[Frame] = []
        self._is_new = False
        # Documents of the telegrams that it had received at each restart, and the gaps in which it received none.
        self._former: list[Document] = []
        self._gaps: list[Gap] = []
        self._ports = contract.ports

    def _take(self) -> None:
        """Take the node's faults that are not about a telegram."""
        faults = self.faults
        self._kills = faults.at("node", "kill")
        self._stops = faults.at("node", "stop")
        self._restarts = faults.at("node", "restart")
        self._silences = faults.at("bus", "off", "down")

    def adopt(self, make: Callable[[], Any], injection: Injection, folder: Path | None) -> None:
        """Have other faults from the next instant on (:meth:`NodeFaults.adopt`).

        :param make: makes the controller after a restart.
        :raises InputError: a fault has begun that is not in both lists.
        """
        self._make = make
        self.faults.adopt(injection, folder)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._node, name)

    @property
    def ended(self) -> Event | None:
        """The event that ended the run, which a stopped controller does not see."""
        return self._node.ended or self.faults.follower.ended

    def handle(self, frame: Frame) -> list[Frame]:
        """Take one frame in bus order; returns the frames that leave instead of the answer."""
        if self.faults.see(frame):
            self._instant()
        if self.is_gone:
            if self._gaps:
                self._gaps[-1].take(frame)
            return []
        port = self._asked(frame)
        if self._deaf_since_ns is not None:
            self._backlog.append(frame)
            for one in self._silences if port is not None else ():
                if one.active:
                    self.faults.activities.note(one, f"poll of {frame.data.hex()}", LOST)
            return self._nothing(port)
        answers = self._node.handle(frame)
        if port is None:
            return answers
        for answer in answers:
            self.faults.see(answer)
        left = list(self.faults.passes(answers))
        ends = (port.can_ids[-1], port.fd_id)
        answered = any(one.can_id in ends and one in self._own for one in left)
        return left if answered else [*left, *self._nothing(port)]

    def _asked(self, frame: Frame) -> Port | None:
        """The port that a frame polls; None: it polls no port of this controller."""
        if frame.can_id != self._poll_id or frame not in self._own:
            return None
        asked = parse_master_frame(frame.data)
        return None if asked is None else self._polled.get(asked[0] << 12 | asked[1])

    def _nothing(self, port: Port | None) -> list[Frame]:
        """The frame that means "no answer"."""
        return [no_answer(port.can_ids)] if port is not None and self._node.lockstep else []

    def _instant(self) -> None:
        """Begin and end the faults of an instant that are not about a telegram."""
        activities = self.faults.activities
        for one in self._kills:
            if one.active and not self.is_gone:
                activities.note(one, "running", "killed")
                self.is_gone = True
                self._gaps += self._gap(self._backlog)
                self._deaf_since_ns, self._backlog = None, []
                if self._kill is not None:
                    self.faults.write()
                    self._kill()
        for one in self._stops:
            if one.active and one.hits == 0:
                activities.note(one, "running", "stopped")
                if self._pause is not None and not self._node.lockstep and one.fault.duration_s is not None:
                    self._pause(self.faults.follower.wall_s(one.fault.duration_s))
                    one.order(False, activities.now_ns)
        for one in self._restarts:
            if one.active and one.hits == 0:
                activities.note(one, "running", "ended")
                self._is_new = True
        if self.is_gone:
            # The controller has ended: faults that end later cannot make it hear again.
            return
        deaf = [one for one in (*self._stops, *self._restarts, *self._silences) if one.active]
        if deaf and self._deaf_since_ns is None:
            self._deaf_since_ns = activities.now_ns
        elif not deaf and self._deaf_since_ns is not None:
            self._hears_again(activities.now_ns)

    def _hears_again(self, now_ns: int) -> None:
        since_ns, self._deaf_since_ns = self._deaf_since_ns or 0, None
        backlog, self._backlog = self._backlog, []
        delivers = any(one.fault.after == "deliver" and one.over for one in self._stops)
        if self._is_new:
            self._gaps += self._gap(backlog, restarted=True)
            self._is_new = False
            self.faults.end_process()
            if (told := getattr(self._node, "received", None)) is not None:
                self._former.append(told)
            self._node = self._make()
        elif delivers:
            # Its answers to these polls come too late for every node.
            for frame in backlog:
                self._node.handle(frame)
        else:
            self._gaps += self._gap(backlog)
            self._node.was_stopped(now_ns - since_ns)

    @property
    def received(self) -> Document | None:
        """Telegrams that the controller has received (:mod:`railhil.bus.reception`); None: it does not count them."""
        return self._told([] if self._deaf_since_ns is None else self._gap(self._backlog))

    def _told(self, also: Sequence[Gap] = ()) -> Document | None:
        told = getattr(self._node, "received", None)
        gaps = [gap.document() for gap in (*self._gaps, *also)]
        return None if told is None else summed([*self._former, told], gaps)

    def _gap(self, frames: Sequence[Frame], restarted: bool = False) -> list[Gap]:
        """Count frames that the controller never gets, unless it does not count its telegrams."""
        before = self._told()
        if before is None:
            return []
        gap = Gap(before, self._ports, restarted)
        for frame in frames:
            gap.take(frame)
        return [gap]
