"""A complete run in this process (``railhil run --bus local``), with the same folder, certificate and bytes as over a
bus."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from railhil.bus.can_settings import LOCAL
from railhil.bus.errors import BusError, PeerSilent
from railhil.bus.frame import Frame
from railhil.bus.local import LocalBus
from railhil.bus.reception import received_by
from railhil.bus.select import no_bus
from railhil.common.errors import InputError
from railhil.common.exit_codes import INVALID, PASS, USAGE, exit_code_of
from railhil.controller_node.controller import (
    AnyController,
    adopt_faults,
    make_controller_node,
    was_killed,
    write_fault_log,
)
from railhil.controller_node.telemetry_file import telemetry_document, write_telemetry
from railhil.judge.fault_report import check_faults, fault_outcomes
from railhil.judge.jitter import lockstep_timing
from railhil.judge.result import Result
from railhil.live.recorder import LOOK_S
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.node import make_plant_node
from railhil.record.log_trace import trace_of_log
from railhil.record.run_folder import TELEMETRY
from railhil.record.session import make_session
from railhil.record.trace import NodeCounters, Trace
from railhil.run.conclusion import judged
from railhil.run.run import Observer, Plan, Run
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import LawSpec, RunSpec


class LocalRun(Run):
    """Plant, controller and recorder in one process.

    :param wire: applied to each frame on its way to the controller (faults); None: no change.
    :param controller: computes the commands instead of the run's law.
    :param hear: called with each frame in bus order, and its simulation time in ns.
    :param branches: the run may be given other faults (:meth:`adopt`).
    """

    def __init__(
        self,
        plan: Plan,
        observer: Observer | None = None,
        *,
        wire: Callable[[Frame], list[Frame]] | None = None,
        controller: Any = None,
        hear: Callable[[Frame, int], object] | None = None,
        branches: bool = False,
    ) -> None:
        super().__init__(plan, observer)
        scenario, spec, folder, fd = plan.scenario, plan.spec, plan.folder, plan.choice.fd
        late = self.log.late
        self.session = make_session(
            scenario,
            late.write,
            spec,
            fd=fd,
            on_progress=self._poll,
            operator=plan.make_operator(),
            late=late,
            branches=branches,
        )
        self._flush_s = 0.0
        self._wire = wire
        self._hear = hear
        try:
            self.controller: AnyController = make_controller_node(
                scenario, spec, controller, fd=fd, folder=folder, branches=branches
            )
            bus = LocalBus([self._controller_takes if wire else self.controller.handle, self._recorder_takes()])
            self.plant = make_plant_node(scenario, spec, bus, fd=fd, fault_log=folder, branches=branches)
        except BaseException:
            self.log.close()
            raise

    def _controller_takes(self, frame: Frame) -> list[Frame]:
        assert self._wire is not None
        return [answer for item in self._wire(frame) for answer in self.controller.handle(item)]

    def _recorder_takes(self) -> Callable[[Frame], list[Frame]]:
        session, hear = self.session, self._hear
        if hear is None:
            return session.handle

        def take(frame: Frame) -> list[Frame]:
            answers = session.handle(frame)
            for item in (frame, *answers):
                hear(item, session.time_ns)
            return answers

        return take

    def _poll(self, sim_time_s: float) -> None:
        """At each poll of SUP_CMD: the tasks of the recorder on a bus besides recording."""
        self.stop.check()
        now_s = time.monotonic()
        if now_s >= self._flush_s:
            self.log.flush()
            self._flush_s = now_s + LOOK_S
        self.observer.on_progress(sim_time_s)

    def execute(self) -> Result:
        with self.stop:
            line, code = "", PASS
            try:
                self.plant.run()
            except (BusError, PlantError, InputError) as error:
                line, code = self.incomplete(error)
            except (KeyboardInterrupt, SystemExit):
                if not self.session.recording:
                    self.close()
                    raise
                line, code = self._stopped(), INVALID
            except BaseException:
                self.close()
                raise
            return self.finish(line, code)

    def let_end(self, ticks: Iterator[None]) -> tuple[str, int]:
        """Let a run that has begun go on to its end; returns what :meth:`finish` is given.

        :param ticks: of its plant.
        """
        try:
            for _ in ticks:
                pass
            self.plant.ending()
        except (BusError, PlantError, InputError) as error:
            return self.incomplete(error)
        return "", PASS

    def adopt(self, plan: Plan) -> None:
        """Be another run from the next tick on, which differs only in its faults and its later noise; its log is moved
        by the caller.

        :raises InputError: a fault has begun that is not in both runs.
        """
        scenario, spec, folder = plan.scenario, plan.spec, plan.folder
        adopt_faults(self.controller, scenario, spec, folder, fd=plan.choice.fd)
        self.plant.adopt(scenario, spec, folder)
        self.scenario, self.spec, self.folder = scenario, spec, folder

    def play(self) -> Result:
        """Make the complete run, for a caller that wants its errors raised.

        :raises BusError, PlantError, InputError: the run is incomplete.
        """
        try:
            self.plant.run()
        except BaseException as error:
            if not (isinstance(error, PeerSilent) and self._was_killed):
                self.close()
                raise
        return self.finish()

    @property
    def _was_killed(self) -> bool:
        """Whether a fault has killed the controller, and the train has stopped by itself: as requested, the run is
        judged by the train's behaviour."""
        return was_killed(self.controller) and self.plant.ended is not None

    def incomplete(self, error: Exception) -> tuple[str, int]:
        """Reason for which a run that ended with this error is incomplete, and its exit code; empty and PASS for a
        complete run."""
        if isinstance(error, PeerSilent) and self._was_killed:
            return "", PASS
        if isinstance(error, (PeerSilent, PlantError)):
            return str(error), exit_code_of(error)
        # Nodes that disagree, or a law that raises.
        return "; ".join(self.session.handshake.disagreements) or str(error), USAGE

    def finish(self, line: str = "", code: int = PASS) -> Result:
        """End the run and judge its record.

        :param line: reason why the run is incomplete, with its exit code; empty and PASS for a complete run.
        """
        sha256 = self.close()
        session, plant, controller = self.session, self.plant, self.controller
        self.trace = trace_of_log(self.log.path, self.contract) if session.frames else Trace(self.contract)
        if self._wire is None:
            self.trace.reported = NodeCounters(
                exact=True, nodes=received_by({"controller": controller, "plant": plant})
            )
        faults = fault_outcomes(self.folder, self.scenario, self.spec.seed) if session.recording else []
        result = judged(self, sha256, line, code, lockstep_timing(self.trace), faults, session.counters)
        counters = {
            "plant": dict(plant.counters),
            "gate": dict(plant.plant.refused),
            "controller": dict(controller.counters),
            "supervisor": session.counters,
        }
        told = {} if controller.controller is None else telemetry_document(controller)
        return replace(result, counters=counters, telemetry=told)

    def close(self) -> str:
        """Write the nodes' final reports, their telemetry and the logs of the faults, and close the log; returns its
        SHA-256."""
        # The console of a board is complete when it is off.
        self.controller.close()
        write_telemetry(self.controller, self.folder / TELEMETRY)
        self.plant.faults.write_logs()
        write_fault_log(self.controller)
        return self.log.close()


def local_plan(scenario: AnyScenario, spec: RunSpec, folder: Path, *, fd: bool = False) -> Plan:
    """A run in this process, into an existing folder.

    :param fd: telegrams in the CAN FD form.
    :raises InputError: the run is in real time.
    """
    choice = no_bus({}, spec.pace)
    return Plan(spec, scenario, replace(choice, config={**choice.config, "fd": fd}), folder)


def local_run(
    scenario: AnyScenario,
    folder: Path,
    spec: RunSpec | None = None,
    *,
    fd: bool = False,
    wire: Callable[[Frame], list[Frame]] | None = None,
    controller: Any = None,
) -> Result:
    """One run through codec and stores, for any system, without the files of a run folder except the log.

    :param spec: None: the system's default law in lockstep, seed 0.
    :param wire: applied to each frame on its way to the controller (faults); default: no change.
    :param controller: computes the commands instead of the run's law.
    :raises BusError, PlantError, InputError: the run is incomplete.
    """
    spec = spec or RunSpec(law=LawSpec(scenario.usual_law))
    check_faults(scenario, [LOCAL], spec.pace)
    return LocalRun(local_plan(scenario, spec, folder, fd=fd), wire=wire, controller=controller).play()


def unrecorded_run(scenario: AnyScenario, spec: RunSpec | None = None, controller: Any = None) -> Result:
    """:func:`local_run` without a run folder: only the hash of the record is kept."""
    with tempfile.TemporaryDirectory(prefix="railhil-") as folder:
        return replace(local_run(scenario, Path(folder), spec, controller=controller), folder=None)
