"""``python -m benchmarks.summary --python PYTHON...``: the first table of docs/reference/benchmarks.md, as Markdown.

Every Python (of a virtual environment in which the bench is installed) measures several times, in turns, so that a slow
hour of the host is slow for all. A cell has the median of the repetitions, and their range in brackets.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from statistics import median
from typing import Any

from benchmarks.figures import MeasurementError
from benchmarks.processes import last_line
from railhil.common.command_line import OneLineParser, parse, whole_number
from railhil.common.exit_codes import run_guarded
from railhil.common.output import Output

#: Row of the table -> benchmark and figure.
ROWS = {
    "speed factor, three processes, recording on (iq), times real time": ("lockstep", "iq: speed factor, median"),
    "the same nodes in one process (`--bus local`)": ("lockstep", "iq: speed factor in one process, median"),
    "command to first frame, s": ("start_and_end", "first frame, median"),
    "all files and the report after the last frame, s": ("start_and_end", "all files after the last frame, median"),
    "`railhil score`, s": ("start_and_end", "railhil score, median"),
    "controller step with telemetry, iq, us": ("controller_step", "iq: step, median"),
    "the same, iq-portable, us": ("controller_step", "iq-portable: step, median"),
    "the same, float32, us": ("controller_step", "float32: step, median"),
    "the same, float64, us": ("controller_step", "float64: step, median"),
    "vectorised batch, runs of 195 s per second and core, float64": ("batch", "float64: runs of one core"),
    "the same, iq": ("batch", "iq: runs of one core"),
    "the same, float32": ("batch", "float32: runs of one core"),
    "peak proportional memory, plant, MB": ("memory", "plant: peak proportional set"),
    "the same, controller, MB": ("memory", "controller: peak proportional set"),
    "the same, supervisor, MB": ("memory", "supervisor: peak proportional set"),
}


def measured(python: str, quick: bool) -> dict[str, Any]:
    """One repetition of all benchmarks of the table: the document of ``python -m benchmarks --json``.

    :raises MeasurementError: it ended with an error.
    """
    names = dict.fromkeys(name for name, _ in ROWS.values())
    words = [word for name in names for word in ("--only", name)]
    command = [python, "-m", "benchmarks", "--json", *(["--quick"] if quick else []), *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise MeasurementError(f"{python} ended with {done.returncode}: {last_line(done.stderr)}")
    document: dict[str, Any] = json.loads(done.stdout)
    return document


def cell(documents: Sequence[dict[str, Any]], benchmark: str, figure: str) -> str:
    """Median and range of a figure over the repetitions."""
    found = [
        one["value"]
        for document in documents
        for one in document["benchmarks"][benchmark]["figures"]
        if one["name"] == figure
    ]
    if len(found) != len(documents):
        raise MeasurementError(f"{benchmark} has no figure {figure!r}")
    return f"{_text(median(found))} ({_text(min(found))} to {_text(max(found))})"


def _text(value: float) -> str:
    """Three digits, without an exponent."""
    return f"{value:.3g}" if value < 1000 else f"{float(f'{value:.3g}'):,.0f}"


def main() -> int:
    """Measure and print."""
    parser = OneLineParser(prog="python -m benchmarks.summary", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--python", nargs="+", default=[sys.executable], help="(default: this one)")
    parser.add_argument("--repetitions", type=whole_number(1, 100), default=3, metavar="N", help="(default 3)")
    parser.add_argument("--quick", action="store_true", help="a check that it works, not a measurement")
    given = parse(parser)
    documents: dict[str, list[dict[str, Any]]] = {python: [] for python in given.python}
    for _ in range(given.repetitions):
        for python, done in documents.items():
            done.append(measured(python, given.quick))
    said = Output().say
    heads = [done[0]["machine"]["python"] for done in documents.values()]
    said("| " + " | ".join(["what", *heads]) + " |")
    said("|---" * (1 + len(heads)) + "|")
    for what, (benchmark, figure) in ROWS.items():
        said("| " + " | ".join([what, *(cell(done, benchmark, figure) for done in documents.values())]) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(run_guarded("python -m benchmarks.summary", main))
