"""The facts of a run with faults."""

from __future__ import annotations

from collections.abc import Iterable

from railhil.common.exit_codes import FAIL, INVALID, PASS, TOOL_ERROR
from railhil.judge.judging import judging_of
from railhil.judge.reactions.evaluate import Seen
from railhil.judge.result import Result

VERDICTS = {PASS: "PASS", FAIL: "FAIL", INVALID: "INVALID", TOOL_ERROR: "TOOL ERROR"}


def _first_s(times_s: Iterable[float | None]) -> float | None:
    return min((time_s for time_s in times_s if time_s is not None), default=None)


def seen_in(result: Result) -> Seen:
    """What a run did."""
    trace, truth = result.trace, judging_of(result.scenario).truth
    end_s = trace.times_s(truth)
    speed_mps = trace.values(truth, "TrueSpeed") if trace.has(truth, "TrueSpeed") else end_s[:0]
    return Seen(
        begun_s=_first_s(one.begun_s for one in result.faults),
        effective_s=_first_s(one.effect_s for one in result.faults),
        events=result.events,
        stands=bool(len(speed_mps)) and float(speed_mps[-1]) == 0.0,
        end_s=float(end_s[-1]) if len(end_s) else 0.0,
        ended=result.score.ended,
        verdict=VERDICTS.get(result.exit_code, f"exit code {result.exit_code}"),
        line=result.line,
        broken=result.score.failures,
    )
