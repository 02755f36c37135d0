"""What comes out of a run."""

from __future__ import annotations

from dataclasses import dataclass, field

from railhil.common.exit_codes import FAIL, PASS
from railhil.scenarios.memory import Memory
from railhil.supervisor.jitter import RunTiming
from railhil.supervisor.score import Score
from railhil.supervisor.telemetry import LawOrigin, ShownTelemetry, TelemetrySummary


@dataclass(slots=True)
class RunResult:
    """What came out: the score, or why there is none."""

    score: Score
    exit_code: int
    line: str
    frames: int
    frames_sha256: str
    wall_time_s: float
    sim_time_s: float
    #: From the start of this process (the command), interpreter start included.
    first_frame_s: float
    transport: str
    #: What the controller has said about its arithmetic, in its file or else on the bus; None without a word.
    telemetry: TelemetrySummary | ShownTelemetry | None = None
    #: What it has said in its file of the law's own parameters.
    origin: LawOrigin | None = None
    counters: dict[str, int] = field(default_factory=dict)
    timing: RunTiming | None = None
    #: What the law wants kept; None for a law without memory, and for a run that cannot be trusted.
    memory: Memory | None = None

    @property
    def trusted(self) -> bool:
        """True when the bench could be trusted: only then there is a verdict on the controller."""
        return self.exit_code in (PASS, FAIL)

    @property
    def verdict(self) -> str:
        """PASS or FAIL of the score, INVALID for a bench that could not be trusted."""
        return self.score.verdict if self.trusted else "INVALID"

    @property
    def speed_factor(self) -> float:
        """Simulated seconds per wall second, from the first frame to the last."""
        return self.sim_time_s / self.wall_time_s if self.wall_time_s > 0 else 0.0
