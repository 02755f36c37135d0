"""The end of a run: its record is read back, scored, and judged as a record."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from railhil.bus.codes import Event
from railhil.common.digits import count_of
from railhil.common.exit_codes import FAIL, INVALID, PASS, TOOL_ERROR, USAGE
from railhil.common.scheduling import said_in
from railhil.judge.fault_report import FaultOutcome, missed_faults
from railhil.judge.jitter import (
    WALL,
    RunTiming,
    arrivals_of,
    kept_pace,
    lockstep_timing,
    realtime_timing,
    write_wall_times,
)
from railhil.judge.judging import judging_of
from railhil.judge.record_checks import UNCLEAR
from railhil.judge.result import Result
from railhil.plant_sim.any_plant import FaultTooLarge
from railhil.record.framelog import telegrams_sha256
from railhil.record.log_trace import trace_of_log
from railhil.record.notes import untold_wrap
from railhil.record.senders import Senders
from railhil.record.target import read_target
from railhil.record.telemetry import read_notes, read_origin, read_summary, reported, shown_telemetry
from railhil.record.trace import NodeCounters
from railhil.run.node_commands import needs_orders

if TYPE_CHECKING:
    from railhil.judge.score import Score
    from railhil.run.bus_run import BusRun
    from railhil.run.run import Run


def result_of(
    run: BusRun, sha256: str, counters: dict[str, int], line: str, refused: bool, faults: list[FaultOutcome]
) -> Result:
    """Read the record of a run over a bus back, score it, and decide whether it can be trusted. ``run.trace`` then has
    its telegrams.

    :param sha256: of the frame log.
    :param line: known reason why there can be no score; ``refused``: as bad input.
    :raises RecordFailed: the wall times of a run in real time cannot be written.
    """
    session = run.session
    # A foreign frame is no evidence after any end of the run; missing frames have many reasons.
    complete = run.choice.is_private and not run.spec.is_realtime and not line
    # A recorder with two lines may lose a frame, and a sender that errors take off the bus does not notice it.
    complete = complete and not needs_orders(run.scenario.faults)
    senders = Senders(run.folder, run.contract, complete=complete)
    if session.frames:
        run.trace = trace_of_log(run.log.path, run.contract, senders)
    run.trace.reported = NodeCounters(complete, senders.received)
    found = senders.findings()
    said = [*(item.sentence(port, "supervisor") for port, item in session.foreign_frames.items()), *found.said]
    line = "; ".join(filter(None, (line, *said)))
    timing = _timing(run)
    if timing.missed_polls and counters.get("outages") and not run.spec.is_realtime:
        # The kernel may silently drop frames while an interface goes down.
        line = line or f"record: {count_of(timing.missed_polls, 'poll')} without an answer in an outage of the bus"
    code = PASS if not line else USAGE if refused else INVALID
    return judged(run, sha256, line, code, timing, faults, counters, found.not_witnessed)


def judged(
    run: Run,
    sha256: str,
    line: str,
    code: int,
    timing: RunTiming,
    faults: list[FaultOutcome],
    counters: dict[str, int],
    not_witnessed: Sequence[str] = (),
) -> Result:
    """The result of a run whose telegrams have been read back.

    :param line: reason why the record is incomplete, with its exit code; empty and PASS for a complete one.
    """
    judging, session, trace = judging_of(run.scenario), run.session, run.trace
    score = judging.score(run.scenario, trace)
    summary = read_summary(run.folder)
    if code == PASS:
        code = {"PASS": PASS, "FAIL": FAIL}.get(score.verdict, INVALID)
    if not line and (late := late_reason(score, timing)):
        code, line = INVALID, late
    if code in (PASS, FAIL) and (missed := missed_faults(faults)):
        code, line = INVALID, missed
    if code == PASS and (untold := untold_wrap(trace, judging.status, summary.wraps if summary else 0)):
        code, line = INVALID, untold
    if session.ended is Event.ENDED_PLANT_ERROR and FaultTooLarge.SAID not in line:
        code = TOOL_ERROR
    choice = run.choice
    return Result(
        run.scenario,
        run.spec,
        trace,
        score,
        exit_code=code,
        line=line or "; ".join(score.failures),
        frames=session.frames,
        frames_sha256=sha256,
        telegrams_sha256=telegrams_sha256(run.log.path, run.contract) if trace.foreign else sha256,
        other_frames=trace.foreign,
        reported=reported(run.spec.start_up, trace),
        wall_time_s=(session.commands.last_poll_ns - session.first_frame_ns) / 1e9 if session.recording else 0.0,
        sim_time_s=session.sim_time_s,
        first_frame_s=(session.first_frame_ns - run.started_ns) / 1e9 if session.recording else float("nan"),
        transport=choice.transport,
        bus_words=() if choice.is_private else choice.arguments,
        summary=summary or shown_telemetry(trace, judging.status),
        origin=read_origin(run.folder),
        target=read_target(run.folder),
        notes=read_notes(run.folder, judging.status),
        recorder_counters=counters,
        timing=timing,
        not_witnessed=not_witnessed,
        faults=faults,
        ended=session.ended,
        stopped_exit_code=run.stopped_exit_code,
        last_frame_ns=session.heard_ns,
        folder=run.folder,
    )


def late_reason(found: Score, timing: RunTiming) -> str:
    """Reason for which the timing of a run permits no verdict, after the gaps of its record that it causes. Empty if it
    permits one, or if there is none for another reason."""
    unclear = [said for said in found.failures if said.startswith(UNCLEAR)]
    if timing.jitter is None or timing.jitter.valid or (found.verdict == "INVALID" and not unclear):
        return ""
    return "; ".join(filter(None, (*unclear, timing.jitter.sentence(), timing.pace)))


def _timing(run: BusRun) -> RunTiming:
    """Timing of the run, after all nodes have ended."""
    session = run.session
    if not run.spec.is_realtime:
        return lockstep_timing(run.trace)
    write_wall_times(session.wall_ticks, session.wall_ns, run.folder / WALL)
    pace = kept_pace(run.spec.rate, session.rate)[1]
    arrivals = arrivals_of(session.wall_ticks, session.wall_ns, run.wall_tick_ns())
    paths = [run.folder / f"{role}.txt" for role in ("hub", "plant", "controller")]
    said = {path.stem: said_in(path.read_text(errors="replace"), path.stem) for path in paths if path.is_file()}
    scheduling = {**said, "supervisor": run.recorder.scheduling.sentence}
    return realtime_timing(run.folder, run.trace, arrivals, scheduling, pace)
