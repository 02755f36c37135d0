"""One run that is being made: its plan, its observers, its log, its recorder, and the signals that may stop it."""

from __future__ import annotations

import signal
import time
from abc import ABC, abstractmethod
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.bus.select import BusChoice
from railhil.live.recorder import StopSignals
from railhil.record.framelog import FrameLog
from railhil.record.operator_commands import OperatorCommands, Panel
from railhil.record.session import Session
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    from railhil.judge.result import Result


@dataclass(frozen=True, slots=True)
class Plan:
    """A run that is about to begin, in its folder and on its bus.

    :param folder: existing run folder, for the log and the files of the nodes.
    :param panel: connection to a person who gives orders; ``pace`` with which the run begins there, 0: the fastest.
    """

    spec: RunSpec
    scenario: AnyScenario
    choice: BusChoice
    folder: Path
    panel: Panel | None = None
    pace: float = 0.0

    def make_operator(self) -> OperatorCommands | None:
        """What takes the orders of the person at the panel, besides those of the run; None without a panel."""
        if self.panel is None:
            return None
        lockstep = not self.spec.is_realtime
        return OperatorCommands(self.spec.orders, self.panel, lockstep, self.scenario.faults, self.pace)


class Observer:
    """Watches a run while it is made. Each method does nothing here."""

    def beside(self, plan: Plan) -> AbstractContextManager[Plan]:
        """Entered before the run begins, and left when its folder is written; returns the plan to carry out."""
        return nullcontext(plan)

    def on_started(self) -> None:
        """The nodes have been started, and take a while to appear."""

    def on_progress(self, sim_time_s: float) -> None:
        """Simulation time has reached ``sim_time_s``: called every 160 ms of it."""

    def on_ended(self) -> None:
        """The run has ended, and its nodes take a while to end."""

    def on_result(self, result: Result) -> None:
        """The folder is complete."""


class Run(ABC):
    """Makes one run on any transport.

    :param observer: None: nobody watches the run.
    """

    session: Session

    def __init__(self, plan: Plan, observer: Observer | None) -> None:
        self.scenario = plan.scenario
        self.spec = plan.spec
        self.choice = plan.choice
        self.folder = plan.folder
        self.observer = observer or Observer()
        self.contract = plan.scenario.installed_system.contract
        self.log = FrameLog(plan.folder)
        #: Telegrams of the record, read back from the log after the run.
        self.trace = Trace(self.contract)
        #: Exit code of a run ended by a signal (128 + its number), else 0.
        self.stopped_exit_code = 0
        #: Also used by code that writes results after :meth:`execute`, so that no signal interrupts it.
        self.stop = StopSignals()
        #: Monotonic time from which the wait for the first frame is counted.
        self.started_ns = time.monotonic_ns()

    @abstractmethod
    def execute(self) -> Result:
        """Make the complete run. A signal (Ctrl-C, SIGTERM, SIGHUP) during recording ends it as INVALID, with the
        frames recorded so far; one that comes after recording is only noted in :attr:`stop`.

        :raises BusUnavailable: the bus cannot be opened (nothing was recorded).
        :raises InputError: the law cannot be made, or does not fit the scenario (nothing was recorded).
        """

    def _stopped(self) -> str:
        """A signal has ended the record: note its exit code; returns the reason why the run is incomplete."""
        number = signal.Signals(self.stop.number)
        self.stopped_exit_code = 128 + number
        return f"stopped by {number.name} at simulation time {self.session.sim_time_s:.2f} s"
