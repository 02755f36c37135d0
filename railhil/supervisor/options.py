"""What the command line says about a run."""

from __future__ import annotations

from dataclasses import dataclass

from railhil.common.patience import PATIENCE_S
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.settings import set_words


@dataclass(frozen=True, slots=True)
class RunOptions:
    """One law on one scenario over the bus."""

    scenario: str
    #: Keys set beside its files, ``KEY=VALUE`` (:mod:`railhil.scenarios.settings`).
    settings: tuple[str, ...] = ()
    controller: str = "ipfc"
    arithmetic: str = "iq"
    indexing: str = "time"
    pace: str = "lockstep"
    rate: float = 1.0
    seed: int = 0
    perturbed: bool = False
    #: Simulation time between two readings of the controller's mailboxes; 0: each frame at once.
    task_period_ms: int = 0
    #: Of the law, from a file; None: its own.
    parameters: ParameterSet | None = None
    #: Realtime: ask for SCHED_FIFO and locked memory.
    ask_for_fifo: bool = True
    #: Attach to nodes that are running already instead of starting them.
    attach: bool = False
    #: The controller is somebody else (a board, another program): everything but it is started.
    foreign: bool = False
    #: What the certificate names as the way to make an attached run again; empty: a run that starts its own nodes.
    rerun_command: str = ""
    #: Wall time for all nodes to appear.
    appear_s: float = 25.0
    #: Lockstep: wall time for an answer, see :mod:`railhil.common.patience`.
    patience_s: float = PATIENCE_S

    @property
    def label(self) -> str:
        """The law, with the digest of its parameters when they come from a file: its name in the handshake."""
        return self.controller if self.parameters is None else self.parameters.controller

    @property
    def realtime_scheduling(self) -> bool:
        """True when the processes of this run are to ask for SCHED_FIFO and locked memory."""
        return self.pace == "realtime" and self.ask_for_fifo

    @property
    def scenario_arguments(self) -> list[str]:
        """Arguments of every command that say which scenario it is."""
        return [self.scenario, *set_words(self.settings)]

    @property
    def law_arguments(self) -> list[str]:
        """Arguments of the controller node that say which law it runs, and how."""
        law = ["--controller", self.controller, "--arithmetic", self.arithmetic, "--indexing", self.indexing]
        return law + (["--parameters", str(self.parameters.source)] if self.parameters is not None else [])
