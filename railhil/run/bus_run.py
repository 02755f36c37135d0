"""One run over a bus, from start to verdict: bus, nodes in processes of their own, record, score."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from railhil.bus.can_settings import HUB_INTERFACE
from railhil.bus.codes import Event
from railhil.bus.errors import BusLost
from railhil.bus.link import Link, open_link
from railhil.bus.link.pipes import Pipes
from railhil.bus.order import BusOrder
from railhil.common.digits import count_of
from railhil.common.exit_codes import USAGE
from railhil.faults import parse_faults
from railhil.judge.fault_report import FaultOutcome, fault_outcomes, missing_logs, take_logs
from railhil.live.live_values import LiveLateness
from railhil.live.processes import Nodes
from railhil.live.recorder import AFTER_LOSS_S, SILENCE_S, Recorder, open_recorder, refuse_occupied
from railhil.record.session import make_session
from railhil.run.node_commands import longest_stop_s, start_hub, start_nodes
from railhil.run.run import Observer, Plan, Run

if TYPE_CHECKING:
    from railhil.judge.result import Result

_REAP_S = 1.0
_LOOK_S = 0.05


class BusRun(Run):
    """Starts the nodes, records until the run has ended, and scores.

    :param open_bus: makes the recorder's link from the arguments of ``can.Bus`` and the name of the node.
    :param silence_s: wall time without a tick after which a started run counts as dead.
    :param after_loss_s: wall time for the other nodes to stop by themselves after a node was lost.
    """

    def __init__(
        self,
        plan: Plan,
        observer: Observer | None = None,
        *,
        open_bus: Callable[[dict[str, Any], str], Link] = open_link,
        silence_s: float = SILENCE_S,
        after_loss_s: float = AFTER_LOSS_S,
    ) -> None:
        super().__init__(plan, observer)
        spec, choice, operator = plan.spec, plan.choice, plan.make_operator()
        self._open_bus = open_bus
        self._after_loss_s = after_loss_s
        lines = self.log.late if choice.needs_pipes else None
        self.session = make_session(
            plan.scenario,
            self.log.write if lines is None else lines.write,
            spec,
            fd=choice.fd,
            on_progress=self.observer.on_progress,
            operator=operator,
            late=lines,
        )
        if operator is not None:
            operator.while_waiting = self._while_held
            if spec.is_realtime:
                late = LiveLateness(self.session.wall_ticks, self.session.wall_ns)
                operator.lateness = lambda: late.report(self.wall_tick_ns())
        # The hub has one order for all clients; a kernel bus has one per processor.
        in_order = choice.config.get("interface") == HUB_INTERFACE or spec.is_realtime
        self.recorder = Recorder(
            self.session,
            self.log.flush,
            spec,
            choice.transport,
            None if in_order else BusOrder(fd=choice.fd, contract=self.contract),
            # On the wall clock.
            stopped_s=longest_stop_s(plan.scenario.faults) / (spec.wall_rate or 1.0),
            silence_s=silence_s,
            after_loss_s=after_loss_s,
        )

    def _while_held(self) -> None:
        """An answer is held back: earlier frames are written to the log, for programs that follow the record."""
        self.stop.check()
        self.log.flush()

    def execute(self) -> Result:
        with self.stop:
            return self._execute()

    def _execute(self) -> Result:
        start_up = self.spec.start_up
        try:
            with Nodes(self.folder) as nodes:
                with self.stop.interrupt_at_once():
                    link = self._join(nodes)
                try:
                    self.recorder.record_until_stopped(link, nodes, self.stop)
                except BusLost as error:
                    # A killed process closes its sockets slightly before its end can be detected.
                    nodes.wait(("hub",), _REAP_S)
                    self.recorder.lost = self.recorder.describe_loss(nodes) or str(error)
                except (KeyboardInterrupt, SystemExit):
                    if not self.session.recording:
                        raise
                    self.recorder.lost = self._stopped()
                finally:
                    link.close()
                    link.tell_trouble()
                if self.session.ended is not None:
                    self.recorder.await_controller(nodes, self.stop)
                    self.observer.on_ended()
                counters = dict(link.counters) | self.session.counters
                if self.session.ended is not None:
                    nodes.wait(("plant", "controller"), self._after_loss_s)
                    if start_up.attach:
                        self._await_fault_logs()
                if self.session.ended is Event.ENDED_CONTROLLER_LOST and nodes.find_suspended():
                    self.recorder.lost = self.recorder.lost or self.recorder.describe_loss(nodes)
                faults = fault_outcomes(self.folder, self.scenario, self.spec.seed) if self.session.recording else []
                if self.session.ended is not None and self._was_killed(nodes, faults):
                    # The fault was requested: the run is judged by the train's behaviour.
                    self.recorder.lost = ""
                line, refused = self._verdict_line(nodes, counters)
        finally:
            sha256 = self.log.close()
        # These modules are loaded while the nodes end if the caller takes care of it.
        from railhil.run.conclusion import result_of

        return result_of(self, sha256, counters, line, refused, faults)

    def _await_fault_logs(self) -> None:
        """Nodes that were started elsewhere write the logs of their faults a moment after the end of the run."""
        deadline_s = time.monotonic() + self._after_loss_s
        while True:
            if (logs := self.spec.start_up.fault_logs) is not None:
                take_logs(logs, self.folder)
            if not missing_logs(self.folder, self.scenario) or time.monotonic() >= deadline_s:
                return
            time.sleep(_LOOK_S)

    def _was_killed(self, nodes: Nodes, outcomes: list[FaultOutcome]) -> bool:
        """Whether a fault of the run has killed the controller, and nothing else has ended a node."""
        killed = any(fault.kills_controller for fault in parse_faults(one.text for one in outcomes if one.hits))
        return killed and {node.role for node in nodes.list_ended() if node.was_killed} <= {"controller"}

    def _join(self, nodes: Nodes) -> Link:
        """Start the nodes and open the bus; an existing bus is checked first."""
        lockstep = not self.spec.is_realtime
        if self.choice.needs_pipes:
            return self._join_by_pipes(nodes)
        if self.choice.needs_hub:
            start_hub(nodes, self.spec, self.choice, self.scenario.faults)
        elif not self.spec.start_up.attach:
            link = open_recorder(self.choice, nodes, lockstep, self._open_bus)
            try:
                refuse_occupied(link, self.choice)
                self._start(nodes)
            except BaseException:
                # The interface must be closed on Ctrl-C, too.
                link.close()
                raise
            return link
        self._start(nodes)
        return open_recorder(self.choice, nodes, lockstep, self._open_bus)

    def _join_by_pipes(self, nodes: Nodes) -> Link:
        """Start the nodes with pipes between them."""
        pipes = Pipes()
        try:
            self._start(nodes, pipes)
            config = self.choice.config | {"channel": pipes.ends["supervisor"].channel}
            link = self._open_bus(config, "supervisor")
            pipes.own()
        finally:
            pipes.close()
        link.lossless = True
        return link

    def _start(self, nodes: Nodes, pipes: Pipes | None = None) -> None:
        if not self.spec.start_up.attach:
            start_nodes(nodes, self.spec, self.choice, self.folder, self.scenario, pipes)
        self.observer.on_started()

    def _verdict_line(self, nodes: Nodes, counters: dict[str, int]) -> tuple[str, bool]:
        """The line that explains a run without a score, and whether it was refused as bad input."""
        blamed = nodes.failed_node()
        killed = blamed is not None and blamed.was_killed
        refusals = [] if killed else [node for node in nodes.list_ended() if node.exit_code() == USAGE]
        if disagreements := self.session.handshake.disagreements:
            # The plant ends because of them.
            refusals = [] if self.spec.start_up.foreign else [node for node in refusals if node.role != "plant"]
        if refusals:
            return refusals[0].last_words(), True
        if disagreements:
            return "; ".join(disagreements), True
        if self.session.ended is Event.ENDED_REFUSED:
            return "; ".join(self.session.handshake.disagreements) or "the plant did not start the run", True
        lost = self.recorder.lost
        if self.session.ended is Event.ENDED_PLANT_ERROR and not lost:
            lost = next((node.last_words() for node in nodes.list_ended() if node.role == "plant"), "")
        return "; ".join(filter(None, (lost, self._hole(counters)))), False

    def _hole(self, counters: dict[str, int]) -> str:
        """Reason for which the record is incomplete, if it is."""
        if lost := counters.get("rx_lost"):
            return f"record: {count_of(lost, 'frame')} lost in the recorder's receive buffer (SO_RXQ_OVFL)"
        if self.session.unheard_ns and self.spec.is_realtime:
            return f"record: the recorder was off the bus for {self.session.unheard_ns / 1e9:.2f} s"
        return ""

    def wall_tick_ns(self) -> float:
        """Wall time between two ticks of a real-time run, at the plant's pace."""
        from railhil.judge.jitter import kept_pace

        return self.scenario.timing.base_tick_ns / kept_pace(self.spec.rate, self.session.rate)[0]
