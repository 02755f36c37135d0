"""One run that is being made: its log, its recorder, its telegrams, and the signals that may stop it."""

from __future__ import annotations

import signal
from abc import ABC, abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING

from railhil.bus.select import BusChoice
from railhil.live.recorder import StopSignals
from railhil.record.framelog import FrameLog
from railhil.record.session import Session
from railhil.record.trace import Trace
from railhil.scenarios.model import AnyScenario
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    from railhil.judge.result import Result


class Run(ABC):
    """Makes one run on any transport.

    :param folder: existing run folder, for the log and the files of the nodes.
    """

    session: Session

    def __init__(self, scenario: AnyScenario, spec: RunSpec, choice: BusChoice, folder: Path) -> None:
        self.scenario = scenario
        self.spec = spec
        self.choice = choice
        self.folder = folder
        self.contract = scenario.installed_system.contract
        self.log = FrameLog(folder)
        #: Telegrams of the record, read back from the log after the run.
        self.trace = Trace(self.contract)
        #: Exit code of a run ended by a signal (128 + its number), else 0.
        self.stopped_exit_code = 0
        #: Also used by code that writes results after :meth:`execute`, so that no signal interrupts it.
        self.stop = StopSignals()
        #: Monotonic time from which the wait for the first frame is counted.
        self.started_ns = 0

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
