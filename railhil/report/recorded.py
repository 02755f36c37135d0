"""A recorded run as input of the report: only what its folder contains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from railhil.bus.ident import INDEXINGS, CtlIdent, PltIdent
from railhil.judge.events.event import RecordedEvent
from railhil.judge.events.summary import explained
from railhil.judge.judging import judging_of
from railhil.judge.measures import KMH
from railhil.judge.record import Record
from railhil.judge.score import Score
from railhil.record.documents import read_score
from railhil.record.notes import ReportedNote, note_values, notes_of
from railhil.record.sampling import drawn_trace
from railhil.record.trace import FloatArray, Trace
from railhil.scenarios.model import PublishedScore
from railhil.scenarios.parameters import DIGEST_DIGITS
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.target import target_of
from railhil.wire.ato import CtlStat, NotchCmd, SimTruth

#: A curve needs two points.
_POINTS_MIN = 2


@dataclass(frozen=True, slots=True)
class RecordedRun:
    """One run: scenario, telegrams, score, and the other documents of the folder (empty if there are none).

    ``label`` is the name of the law in tables, extended if it must be distinguished from other runs of the same law.
    """

    label: str
    #: Type defined by the system; only the system's own parts know it.
    scenario: Any
    trace: Trace
    score: Score
    verdict: str
    line: str
    certificate: dict[str, Any]
    score_document: dict[str, Any]
    #: What happened, in the order of the instants.
    events: tuple[RecordedEvent, ...] = ()

    @property
    def controller(self) -> str:
        """Name of the law; ``?`` for a record without certificate."""
        return str(self.certificate.get("controller", "?"))

    @property
    def published(self) -> PublishedScore | None:
        """The published row of this law, if there is one."""
        return next((row for row in self.scenario.published if row.controller == self.controller), None)

    @property
    def seed_was_trained(self) -> bool:
        """True if the controller's parameters are known to come from this very run, which is then not an evaluation."""
        return bool(self.certificate.get("seed_was_trained"))

    @property
    def caution(self) -> str:
        """The warning for a run that is not an evaluation, empty for the others."""
        if not self.seed_was_trained:
            return ""
        how = "tuned" if self.certificate.get("parameters") else "designed"
        seed = self.certificate.get("seed")
        return f"NOT AN EVALUATION: the parameters of {self.controller} were {how} on this very run, seed {seed}"

    @property
    def can_be_drawn(self) -> bool:
        """True if the truth was recorded more than once."""
        return self.trace.count(judging_of(self.scenario).truth) >= _POINTS_MIN


def recorded_run(record: Record) -> RecordedRun:
    """A record as the report takes it; its line is the verdict's reason, and what the watches did.

    :raises InputError: ``score.json`` is damaged.
    """
    scenario, certificate = record.scenario, record.certificate
    line = explained("; ".join(record.reasons), record.why)
    document = read_score(record.folder) if certificate else None
    label = _law_label(certificate, record.folder.name)
    if memory := _confirmed(certificate).get("memory"):
        label += f"@{memory['sha256'][:DIGEST_DIGITS]}"
    label += " (on this seed)" if certificate.get("seed_was_trained") else ""
    return RecordedRun(
        label, scenario, record.trace, record.score, record.verdict, line, certificate, document or {}, record.events
    )


def _confirmed(certificate: dict[str, Any]) -> dict[str, Any]:
    """What may be said of the law: of a controller that has not said that it has them, nothing is known."""
    return {} if certificate.get("asked") else certificate


def _law_label(certificate: dict[str, Any], otherwise: str) -> str:
    """The law with its parameters, if they are not its own."""
    label = str(certificate.get("controller") or otherwise)
    if parameters := _confirmed(certificate).get("parameters"):
        label += f"+{parameters['sha256'][:DIGEST_DIGITS]}" + (" tuned" if parameters.get("training") else "")
    return label


def law_labels(runs: Sequence[RecordedRun]) -> list[str]:
    """For each run what it is a run of: the law with its parameters, and in which arithmetic, by which set-points and
    of which train, as far as runs of the law differ in it. Runs that differ in the seed alone have the same."""
    bare = [replace(run, label=_law_label(run.certificate, run.controller)) for run in runs]
    return [run.label for run in _extended(bare, ("arithmetic", "indexing", "perturbed"))]


def told_apart(runs: Sequence[RecordedRun]) -> list[RecordedRun]:
    """The same runs with distinct labels: equal labels are extended by what differs between the runs."""
    found = _extended(runs, ("arithmetic", "indexing", "perturbed", "seed", "pace"))
    labels = [run.label for run in found]
    for label in {text for text in labels if labels.count(text) > 1}:
        same = [index for index, text in enumerate(labels) if text == label]
        for serial, index in enumerate(same, start=1):
            found[index] = replace(found[index], label=f"{label} #{serial}")
    return found


def _extended(runs: Sequence[RecordedRun], keys: Sequence[str]) -> list[RecordedRun]:
    """The runs with equal labels extended by what their certificates differ in, among these keys."""
    found = list(runs)
    for key in keys:
        labels = [run.label for run in found]
        for label in {text for text in labels if labels.count(text) > 1}:
            same = [index for index, text in enumerate(labels) if text == label]
            values = [found[index].certificate.get(key) for index in same]
            if len(set(map(str, values))) > 1:
                for index, value in zip(same, values, strict=True):
                    word = f"seed {value}" if key == "seed" else value
                    word = ("perturbed" if value else "nominal") if key == "perturbed" else word
                    found[index] = replace(found[index], label=f"{label} {word}")
    return found


@dataclass(frozen=True, slots=True)
class Curves:
    """The curves drawn for one run: arrays of equal length per source, in the units of their names.

    ``time_s`` to ``brake_kn`` from SIM_TRUTH, ``notch*`` from NOTCH_CMD, the rest from CTL_STAT. Where a source falls
    silent, its arrays have an entry without values, so that no line goes over the gap.
    """

    time_s: FloatArray
    position_m: FloatArray
    speed_kmh: FloatArray
    error_kmh: FloatArray
    traction_kn: FloatArray
    brake_kn: FloatArray
    notch_s: FloatArray
    notch: FloatArray
    status_s: FloatArray
    #: The notes reported by the law, with their values.
    notes: tuple[tuple[ReportedNote, FloatArray], ...]

    def told(self, *, flags: bool) -> list[tuple[ReportedNote, FloatArray]]:
        """Notes that are bit fields, or the others; without those that were always 0."""
        return [
            (note, values) for note, values in self.notes if bool(note.bits) == flags and np.nan_to_num(values).any()
        ]


def wanted_mps(scenario: Scenario, trace: Trace) -> FloatArray:
    """The set-point that the law followed, at each SIM_TRUTH: by time, or by the train's position; shape (n,)."""
    target = target_of(scenario.target)
    # Whoever joined late has not heard the controller's.
    ident = trace.ident(CtlIdent) or trace.ident(PltIdent)
    over_distance = ident is not None and ident.indexing == INDEXINGS.index("distance")
    time_s = target.time_s(trace.values(SimTruth.PORT, "TruePos")) if over_distance else trace.times_s(SimTruth.PORT)
    # After the planned stop the target continues below zero, which no train can follow.
    return np.maximum(np.asarray(target.speed_mps(time_s)), 0.0)


def curves(scenario: Scenario, trace: Trace, told: Sequence[dict[str, Any]] | None = None) -> Curves:
    """Curves of a record; the speed error is set-point minus speed, with the set-point that the law followed.

    :param told: ``notes`` of its certificate.
    """
    trace = drawn_trace(scenario, trace)
    speed_kmh = trace.values(SimTruth.PORT, "TrueSpeed") * KMH
    return Curves(
        time_s=trace.times_s(SimTruth.PORT),
        position_m=trace.values(SimTruth.PORT, "TruePos"),
        speed_kmh=speed_kmh,
        error_kmh=wanted_mps(scenario, trace) * KMH - speed_kmh,
        traction_kn=trace.values(SimTruth.PORT, "TractionForce") / 1e3,
        brake_kn=trace.values(SimTruth.PORT, "BrakeForce") / 1e3,
        notch_s=trace.times_s(NotchCmd.PORT),
        notch=trace.values(NotchCmd.PORT, "NotchCmd"),
        status_s=trace.times_s(CtlStat.PORT),
        notes=tuple((note, note_values(trace, note)) for note in notes_of(trace, told)),
    )
