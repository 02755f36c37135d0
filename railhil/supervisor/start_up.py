"""How the bench of a run is brought up; what the run is says :class:`railhil.scenarios.run_spec.RunSpec`."""

from __future__ import annotations

from dataclasses import dataclass

from railhil.common.patience import APPEAR_S
from railhil.scenarios.run_spec import RunSpec


@dataclass(frozen=True, slots=True)
class StartUp:
    """Which nodes are started, and how.

    :param ask_for_fifo: realtime: ask for SCHED_FIFO and locked memory.
    :param attach: attach to nodes that are running already instead of starting them.
    :param foreign: the controller is somebody else (a board, another program): everything but it is started.
    :param rerun_command: what the certificate names as the way to make an attached run again; empty: a run that starts
        its own nodes.
    :param appear_s: wall time for all nodes to appear.
    """

    ask_for_fifo: bool = True
    attach: bool = False
    foreign: bool = False
    rerun_command: str = ""
    appear_s: float = APPEAR_S

    def realtime_scheduling(self, run: RunSpec) -> bool:
        """True when the processes of this run are to ask for SCHED_FIFO and locked memory."""
        return run.is_realtime and self.ask_for_fifo
