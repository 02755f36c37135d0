"""How the bench of a run is started; the run itself is described by :class:`railhil.scenarios.run_spec.RunSpec`."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from railhil.common.patience import APPEAR_S
from railhil.scenarios.run_spec import RunSpec

#: Names in the run folder of what the nodes leave there: the controller its telemetry, the plant its timing.
TELEMETRY, TIMING = "telemetry.json", "timing.csv"


@dataclass(frozen=True, slots=True)
class StartUp:
    """Which nodes are started, and how.

    :param ask_for_fifo: real time: request SCHED_FIFO and locked memory.
    :param attach: attach to running nodes instead of starting them.
    :param foreign: the controller is a board or another program: all nodes except it are started.
    :param controller_name: what to call that controller; empty: as it reports itself.
    :param rerun_command: the command that the certificate names for repeating an attached run; empty: a run that starts
        its own nodes.
    :param fault_logs: folder in which running nodes leave the logs of their faults; None: the run folder.
    :param appear_s: wall time for all nodes to appear.
    """

    ask_for_fifo: bool = True
    attach: bool = False
    foreign: bool = False
    controller_name: str = ""
    rerun_command: str = ""
    fault_logs: Path | None = None
    appear_s: float = APPEAR_S

    def folder_name(self, law: str) -> str:
        """The controller in the name of a run folder.

        :param law: that was asked for.
        """
        if not self.foreign:
            return law
        return re.sub(r"[^A-Za-z0-9_.+-]+", "_", self.controller_name) or "other"

    def realtime_scheduling(self, run: RunSpec) -> bool:
        """True if the processes of this run should request SCHED_FIFO and locked memory."""
        return run.is_realtime and self.ask_for_fifo
