"""``railhil run --bus local``: a complete run in this process, with the same folder, certificate and bytes as over a
bus."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from pathlib import Path

from railhil.bench import plant_beside, write_fault_logs
from railhil.bus.codes import Event
from railhil.bus.errors import BusError, PeerSilent
from railhil.bus.reception import received_by
from railhil.bus.select import LOCAL
from railhil.common.errors import InputError
from railhil.common.exit_codes import FAIL, INVALID, PASS, TOOL_ERROR, USAGE
from railhil.controller_node.any_controller import AnyController
from railhil.controller_node.faulty import controller_of, was_killed
from railhil.controller_node.telemetry_file import write_telemetry
from railhil.plant_sim.any_plant import PlantError
from railhil.plant_sim.node import PlantNode
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec
from railhil.scenarios.system import system_named
from railhil.supervisor.fault_report import fault_outcomes, missed_faults
from railhil.supervisor.framelog import FrameLog, telegrams_sha256
from railhil.supervisor.jitter import lockstep_timing
from railhil.supervisor.judging import judging_of
from railhil.supervisor.log_trace import trace_of_log
from railhil.supervisor.recorder import LOOK_S
from railhil.supervisor.result import RunResult
from railhil.supervisor.session import Session
from railhil.supervisor.start_up import TELEMETRY
from railhil.supervisor.status import untold_wrap
from railhil.supervisor.stopping import StopSignals
from railhil.supervisor.telemetry import read_origin, read_summary, shown_telemetry
from railhil.supervisor.trace import Told, Trace


class LocalRun:
    """Like :class:`railhil.supervisor.run.Run`, without hub and processes.

    :param folder: existing run folder; log and telemetry go there.
    :param started_ns: monotonic time from which the wait for the first frame is counted.
    """

    def __init__(
        self,
        scenario: AnyScenario,
        spec: RunSpec,
        folder: Path,
        on_progress: Callable[[float], None] | None = None,
        *,
        started_ns: int | None = None,
    ) -> None:
        self.scenario = scenario
        self._system = system_named(scenario.system)
        self._judging = judging_of(scenario)
        self.spec = spec
        self.folder = folder
        self.log = FrameLog(folder)
        late = self.log.late
        self.session = Session(scenario, late.write, spec, on_progress=self._poll, late=late)
        self.trace = Trace()
        self.stopped_exit_code = 0
        self.stop = StopSignals()
        self._made: dict[str, object] = {}
        self._on_progress = on_progress
        self._flush_s = 0.0
        self._started_ns = time.monotonic_ns() if started_ns is None else started_ns

    def _poll(self, sim_time_s: float) -> None:
        """At each poll of SUP_CMD: what the recorder on a bus does in addition to recording."""
        self.stop.check()
        now_s = time.monotonic()
        if now_s >= self._flush_s:
            self.log.flush()
            self._flush_s = now_s + LOOK_S
        if self._on_progress is not None:
            self._on_progress(sim_time_s)

    def execute(self) -> RunResult:
        """Make the complete run. A signal ends it as INVALID, with the frames recorded so far.

        :raises InputError: the law cannot be made, or does not fit the scenario.
        """
        with self.stop:
            line, code = "", PASS
            try:
                line, code = self._run()
            except (KeyboardInterrupt, SystemExit):
                if not self.session.recording:
                    raise
                number = signal.Signals(self.stop.number)
                self.stopped_exit_code = 128 + number
                line, code = f"stopped by {number.name} at simulation time {self.session.sim_time_s:.2f} s", INVALID
            finally:
                sha256 = self.log.close()
            return self.finish(sha256, line, code)

    def nodes(self) -> tuple[PlantNode, AnyController]:
        """Plant and controller of the run.

        :raises InputError: the law cannot be made, or does not fit the scenario.
        """
        node = controller_of(self.scenario, self.spec.law, self.spec.seed, folder=self.folder)
        plant = plant_beside(self.scenario, self.spec, node, self.session, folder=self.folder)
        self._made = {"controller": node, "plant": plant}
        return plant, node

    def _run(self) -> tuple[str, int]:
        """Why the run is incomplete, and its exit code; empty and PASS for a complete run."""
        plant, node = self.nodes()
        try:
            plant.run()
        except (BusError, PlantError, InputError) as error:
            return self.incomplete(error, node)
        finally:
            self.write_logs(plant, node)
        return "", PASS

    def write_logs(self, plant: PlantNode, node: AnyController) -> None:
        """Write what the nodes report at their end: telemetry, and the logs of the faults."""
        write_telemetry(node, self.folder / TELEMETRY)
        write_fault_logs(plant, node)

    def incomplete(self, error: Exception, node: AnyController) -> tuple[str, int]:
        """Why a run that ended with this error is incomplete, and its exit code; empty and PASS for a complete run."""
        if isinstance(error, PeerSilent) and was_killed(node) and self.session.ended is not None:
            # As asked for: the run is judged by what the train did.
            return "", PASS
        if isinstance(error, (PeerSilent, PlantError)):
            return str(error), TOOL_ERROR if isinstance(error, PlantError) else INVALID
        # Nodes that disagree, or a law that raises.
        return "; ".join(self.session.disagreements) or str(error), USAGE

    def finish(self, sha256: str, line: str, code: int) -> RunResult:
        """The result of the closed log.

        :param line: why the run is incomplete, with its exit code; empty and PASS for a complete run.
        """
        session = self.session
        contract = self._system.contract
        self.trace = trace_of_log(self.log.path, contract) if session.frames else Trace(contract)
        self.trace.told = Told(exact=True, nodes=received_by(self._made))
        found = self._judging.score(self.scenario, self.trace)
        if code == PASS:
            code = {"PASS": PASS, "FAIL": FAIL}.get(found.verdict, INVALID)
        faults = fault_outcomes(self.folder, self.scenario, self.spec.seed) if session.recording else []
        if code in (PASS, FAIL) and (missed := missed_faults(faults)):
            code, line = INVALID, missed
        summary = read_summary(self.folder)
        if code == PASS and (untold := untold_wrap(self.trace, self._judging.status, summary.wraps if summary else 0)):
            code, line = INVALID, untold
        if session.ended is Event.ENDED_PLANT_ERROR:
            code = TOOL_ERROR
        recording = session.recording
        return RunResult(
            score=found,
            exit_code=code,
            line=line or "; ".join(found.failures),
            frames=session.frames,
            frames_sha256=sha256,
            telegrams_sha256=telegrams_sha256(self.log.path, contract) if self.trace.foreign else sha256,
            other_frames=self.trace.foreign,
            wall_time_s=(session.last_poll_ns - session.first_frame_ns) / 1e9 if recording else 0.0,
            sim_time_s=session.sim_time_s,
            first_frame_s=(session.first_frame_ns - self._started_ns) / 1e9 if recording else float("nan"),
            transport=LOCAL,
            telemetry=summary or shown_telemetry(self.trace, self._judging.status),
            origin=read_origin(self.folder),
            counters=session.counters,
            timing=lockstep_timing(self.trace),
            faults=faults,
        )
