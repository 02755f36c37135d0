"""The curves of a recorded run that report, panel and ``signals.csv`` draw or list."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from railhil.bus.ident import INDEXINGS, CtlIdent, PltIdent
from railhil.record.notes import ReportedNote, note_values
from railhil.record.sampling import drawn_trace
from railhil.record.trace import FloatArray, Trace
from railhil.systems.ato.judge.events import STATUS
from railhil.systems.ato.judge.measures import KMH
from railhil.systems.ato.scenario.model import Scenario
from railhil.systems.ato.scenario.target import target_of
from railhil.wire.ato import CtlStat, NotchCmd, SimTruth


@dataclass(frozen=True, slots=True)
class Curves:
    """The curves drawn for one run: arrays of equal length per source, in the units of their names.

    ``time_s`` to ``brake_kn`` from SIM_TRUTH, ``notch*`` from NOTCH_CMD, the rest from CTL_STAT. Where a source falls
    silent, its arrays have an entry without values, so that no line crosses the gap.
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
        """Notes that are bit fields, or the others; without notes that were always 0."""
        return [
            (note, values) for note, values in self.notes if bool(note.bits) == flags and np.nan_to_num(values).any()
        ]


def wanted_mps(scenario: Scenario, trace: Trace) -> FloatArray:
    """The set-point that the law followed, at each SIM_TRUTH: by time, or by the train's position; shape (n,)."""
    target = target_of(scenario.target)
    # A recorder that joined late has not heard the controller's handshake.
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
        notes=tuple((note, note_values(trace, note, STATUS.port)) for note in STATUS.recorded(trace, told)),
    )
