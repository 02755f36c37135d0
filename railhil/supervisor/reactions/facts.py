"""The facts of a run with faults, read from its folder and its result."""

from __future__ import annotations

import csv
from pathlib import Path

from railhil.bus.injector.log import FILE_NAME
from railhil.common.exit_codes import FAIL, INVALID, PASS, TOOL_ERROR
from railhil.scenarios.model import AnyScenario
from railhil.supervisor.judging import judging_of
from railhil.supervisor.reactions.evaluate import Seen
from railhil.supervisor.result import RunResult
from railhil.supervisor.trace import Trace

VERDICTS = {PASS: "PASS", FAIL: "FAIL", INVALID: "INVALID", TOOL_ERROR: "TOOL ERROR"}
#: Nodes that inject.
INJECTORS = ("plant", "controller", "supervisor")
_BOUNDS = ("begun", "ended")


def injected(folder: Path) -> tuple[float | None, float | None]:
    """When the first fault of a run became active, and when one first changed something, in s; None: never."""
    begun_ns: list[int] = []
    hit_ns: list[int] = []
    for node in INJECTORS:
        path = folder / FILE_NAME.format(node=node)
        if path.is_file():
            with path.open(encoding="utf-8", newline="") as stream:
                for row in csv.DictReader(stream):
                    times_ns = begun_ns if row["what"] == "begun" else hit_ns if row["what"] not in _BOUNDS else None
                    if times_ns is not None:
                        times_ns.append(int(row["time_ns"]))
    return _first_s(begun_ns), _first_s(hit_ns)


def _first_s(times_ns: list[int]) -> float | None:
    return min(times_ns) / 1e9 if times_ns else None


def seen_in(folder: Path, scenario: AnyScenario, result: RunResult, trace: Trace) -> Seen:
    """What a run did.

    :param folder: its run folder.
    """
    truth = judging_of(scenario).truth
    end_s = trace.times_s(truth)
    speed_mps = trace.values(truth, "TrueSpeed") if trace.has(truth, "TrueSpeed") else end_s[:0]
    begun_s, effective_s = injected(folder)
    return Seen(
        begun_s=begun_s,
        effective_s=effective_s,
        events=result.events,
        stands=bool(len(speed_mps)) and float(speed_mps[-1]) == 0.0,
        end_s=float(end_s[-1]) if len(end_s) else 0.0,
        ended=result.score.ended,
        verdict=VERDICTS.get(result.exit_code, f"exit code {result.exit_code}"),
        line=result.line,
    )
