"""The result of a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from railhil.common.exit_codes import FAIL, PASS
from railhil.supervisor.events.event import RecordedEvent
from railhil.supervisor.fault_report import FaultOutcome
from railhil.supervisor.jitter import RunTiming
from railhil.supervisor.learned import Learned
from railhil.supervisor.score import Score
from railhil.supervisor.telemetry import LawOrigin, ShownTelemetry, TelemetrySummary


@dataclass(slots=True)
class RunResult:
    """The score, or why there is none."""

    score: Score
    exit_code: int
    line: str
    frames: int
    frames_sha256: str
    wall_time_s: float
    sim_time_s: float
    #: Measured from the start of this process (the command), including the interpreter's start.
    first_frame_s: float
    transport: str
    #: The controller's telemetry, from its file or else from the bus; None if there is none.
    telemetry: TelemetrySummary | ShownTelemetry | None = None
    #: The declaration about the law's own parameters in its file.
    origin: LawOrigin | None = None
    counters: dict[str, int] = field(default_factory=dict)
    timing: RunTiming | None = None
    #: Ports whose owner has not said what it sent.
    not_witnessed: Sequence[str] = ()
    #: What the law wants kept; None for a law without memory, and for a run that cannot be trusted.
    memory: Learned | None = None
    #: What happened in the run, in the order of the instants.
    events: tuple[RecordedEvent, ...] = ()
    #: What is said of a controller that is not railhil's own (:mod:`railhil.supervisor.reported`).
    reported: Mapping[str, str] = field(default_factory=dict)
    #: SHA-256 of the recorded frames of the wire contract alone, and how many others the record has.
    telegrams_sha256: str = ""
    other_frames: int = 0
    #: What became of the faults of the run, by number.
    faults: list[FaultOutcome] = field(default_factory=list)

    @property
    def trusted(self) -> bool:
        """True if the run is trustworthy: only then is there a verdict on the controller."""
        return self.exit_code in (PASS, FAIL)

    @property
    def verdict(self) -> str:
        """PASS or FAIL from the score, INVALID for a run that is not trustworthy."""
        return self.score.verdict if self.trusted else "INVALID"

    @property
    def speed_factor(self) -> float:
        """Simulated seconds per wall second, from the first frame to the last."""
        return self.sim_time_s / self.wall_time_s if self.wall_time_s > 0 else 0.0
