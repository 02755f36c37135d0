"""The result of a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railhil.bus.codes import Event
from railhil.common.exit_codes import FAIL, PASS
from railhil.judge.events.event import RecordedEvent
from railhil.judge.fault_report import FaultOutcome, missed_faults
from railhil.judge.jitter import RunTiming
from railhil.judge.judging import Judging, judging_of
from railhil.judge.score import Score
from railhil.record.framelog import LOG_NAME
from railhil.record.notes import ReportedNote
from railhil.record.target import Target
from railhil.record.telemetry import LawOrigin, Learned, ShownTelemetry, TelemetrySummary
from railhil.record.trace import Trace
from railhil.scenarios.run_spec import RunSpec

if TYPE_CHECKING:
    from railhil.controller_node.arithmetic.base import Counters
    from railhil.judge.record import Record

#: Events of the law's arithmetic that are counted over a run.
COUNTS = ("wraps", "saturations", "zero_divisions")
#: Counters of a node that do not count refusals.
_NOT_REFUSED = ("unknown_id", "no_mailbox", "accepted", "polls")


@dataclass(slots=True)
class Result:
    """A run that has been made and judged: its description, its telegrams, its score, or the reason why there is none.

    :param scenario: of its system, interpreted by the system's own parts.
    :param spec: with the memory and the orders that the run had.
    """

    scenario: Any
    spec: RunSpec
    trace: Trace = field(repr=False)
    score: Score
    exit_code: int = PASS
    line: str = ""
    frames: int = 0
    frames_sha256: str = ""
    wall_time_s: float = 0.0
    sim_time_s: float = 0.0
    #: Measured from the start of this process (the command), including the interpreter's start.
    first_frame_s: float = float("nan")
    transport: str = ""
    #: Words of a command line that select the bus; none for a bus that existed for this run alone.
    bus_words: Sequence[str] = ()
    #: Summary of the controller's telemetry, from its file or else from the bus; None if there is none.
    summary: TelemetrySummary | ShownTelemetry | None = None
    #: The declaration about the law's own parameters in its file.
    origin: LawOrigin | None = None
    #: The law's declaration of its notes in its file.
    notes: tuple[ReportedNote, ...] | None = None
    #: Counters of the recorder and its link.
    recorder_counters: dict[str, int] = field(default_factory=dict)
    timing: RunTiming | None = None
    #: Ports whose owner has left no list of its frames.
    not_witnessed: Sequence[str] = ()
    #: The memory that the law wants to keep; None for a law without memory, and for a run that cannot be trusted.
    memory: Learned | None = None
    #: The events of the run, in the order of the instants.
    events: tuple[RecordedEvent, ...] = ()
    #: Values stated for a controller that is not railhil's own (:mod:`railhil.record.telemetry`).
    reported: Mapping[str, str] = field(default_factory=dict)
    #: SHA-256 of the recorded frames of the wire contract alone, and how many others the record has.
    telegrams_sha256: str = ""
    other_frames: int = 0
    #: Results of the faults of the run, by number.
    faults: list[FaultOutcome] = field(default_factory=list)
    #: The event with which the run ended.
    ended: Event | None = None
    #: 128 and the number of the signal that has stopped the run; 0: none has.
    stopped_exit_code: int = 0
    #: Monotonic wall time of the plant's last sign of life.
    last_frame_ns: int = 0
    #: The run folder; None: the run has not been recorded, or its folder is gone.
    folder: Path | None = None
    #: What was measured on the board that was its controller; None: it was none.
    target: Target | None = None
    #: A run in this process: the counters of each node, and the content of ``telemetry.json``.
    counters: dict[str, dict[str, int]] = field(default_factory=dict)
    telemetry: dict[str, Any] = field(default_factory=dict, repr=False)
    #: A branch of another run: number of the first lines of that run's log that were written when it was forked, their
    #: SHA-256, and the instant in s; for one that was made as a straight run only the instant, and the reason. None: it
    #: is no branch.
    branched_from: dict[str, Any] | None = None
    #: A run without telegrams: event counters of the law's arithmetic over the whole run.
    arithmetic: Counters | None = None

    def as_record(self) -> Record:
        """The run for readers of records; its certificate has its description, faults and notes alone."""
        from railhil.judge.record import Record

        folder = self.folder or Path()
        certificate = {**self.spec.as_json(), "injected": [one.as_json() for one in self.faults]}
        certificate["notes"] = None if self.notes is None else [note.as_json() for note in self.notes]
        found = Record(folder / LOG_NAME, self.scenario, self.trace, self.invalid, certificate)
        return found.copy_with(score=self.score, events=self.events)

    def __repr__(self) -> str:
        """Verdict and scores in a line."""
        return repr(self.as_record())

    def _repr_html_(self) -> str:
        return self.as_record()._repr_html_()

    @property
    def judging(self) -> Judging:
        """How the system of the scenario judges and shows it."""
        return judging_of(self.scenario)

    @property
    def trusted(self) -> bool:
        """True if the run is trustworthy: only then is there a verdict on the controller."""
        return self.exit_code in (PASS, FAIL)

    @property
    def verdict(self) -> str:
        """PASS or FAIL from the score, INVALID for a run that is not trustworthy."""
        return self.score.verdict if self.trusted else "INVALID"

    @property
    def invalid(self) -> str:
        """Reason for which the run is not trustworthy; empty if it is."""
        return "" if self.trusted else self.line or "no reason given"

    @property
    def missed(self) -> str:
        """The faults of the run that had no effect, as the reason why it proves nothing; empty if all acted."""
        return missed_faults(self.faults)

    @property
    def counts(self) -> dict[str, int]:
        """:data:`COUNTS` by name; 0 for a run in which nobody counted them."""
        if self.arithmetic is not None:
            return {name: int(getattr(self.arithmetic, name)) for name in COUNTS}
        totals = self.telemetry["totals"] if self.telemetry else dict.fromkeys(COUNTS, 0)
        return {name: int(totals[name]) for name in COUNTS}

    @property
    def speed_factor(self) -> float:
        """Simulated seconds per wall second, from the first frame to the last."""
        return self.sim_time_s / self.wall_time_s if self.wall_time_s > 0 else 0.0

    @property
    def place(self) -> Path:
        """The run folder of a run that has one."""
        assert self.folder is not None, "this run has no folder"
        return self.folder

    @property
    def log(self) -> Path:
        """``frames.log`` of a run that has a folder."""
        return self.place / LOG_NAME

    def commands(self, name: str) -> list[int]:
        """Raw values of a command in the order in which they were sent.

        :raises KeyError: the system names no such command.
        """
        port, _, signal = self.scenario.installed_system.named[name].partition(".")
        return [int(raw) for raw in self.trace.raw(port, signal)]

    @property
    def refused(self) -> dict[str, int]:
        """All refusals of any node, except of frames of ports without a mailbox: empty on a healthy bus."""
        found: dict[str, int] = {}
        for node, counters in self.counters.items():
            for cause, count in counters.items():
                if cause not in _NOT_REFUSED and count:
                    found[f"{node}.{cause}"] = count
        return found
