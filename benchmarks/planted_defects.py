"""``python -m benchmarks.planted_defects``: our own hunts on the planted defects of ``railhil bench-suite``.

Each strategy has the runs, seeds, journey, law and sentences of the suite, and ends with the first run that shows the
defect. It is entered as another program enters its searches, and ``railhil bench-suite --score FOLDER/*/*`` makes the
table. The runs without the defect, which the search needs to know whether a run shows it, are timed.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from subprocess import PIPE, Popen
from typing import Any

from rich.console import Console

from benchmarks.figures import MeasurementError
from railhil.common.command_line import OneLineParser, parse, whole_number
from railhil.common.digits import count_of
from railhil.common.exit_codes import run_guarded
from railhil.hunt.defects import JOURNEY_FILE, LAW, REQUIREMENTS, RUNS, SEEDS, defects, plant, requirements
from railhil.hunt.leaderboard import ENTRY, leaderboard, table_of
from railhil.hunt.oracle import Judged, judge_result
from railhil.hunt.plan import Plan, Request, make_plan
from railhil.hunt.study import case_row
from railhil.run.make import run_into
from railhil.scenarios.run_spec import RunSpec

_ROOT = Path(__file__).resolve().parents[1]
#: ``auto`` has the cases of the two others, and comes last: their runs are not made again.
STRATEGIES = ("swarm", "random", "auto")
_RUN, _SHOWN = "run", "shown"


def _plan(strategy: str, seed: int) -> Plan:
    asked = Request(scenario=str(JOURNEY_FILE), requirements=(REQUIREMENTS,), seed=seed, strategy=strategy)
    return make_plan(replace(asked, controller=LAW.controller, arithmetic=LAW.arithmetic))


def _search(seed: int, runs: int, out: Path) -> None:
    """Print each violating case, and end a strategy when the answer is that it shows the defect; keep its run.

    The package of this process has the defect.
    """
    made: dict[tuple[tuple[str, ...], int], dict[str, Any]] = {}
    for strategy in STRATEGIES:
        plan = _plan(strategy, seed)
        for number in range(runs):
            (case,) = plan.cases([number])
            key = case.faults, case.seed
            row = made[key] = made.get(key) or case_row(plan.base, plan.requirements, case)
            if not row["violated"]:
                continue
            print(json.dumps({**row, "strategy": strategy}), flush=True)
            if sys.stdin.readline().strip() == _SHOWN:
                spec = replace(plan.base, faults=tuple(row["faults"]), seed=row["seed"])
                run_into(out / strategy / _RUN, spec)
                break


@dataclass
class Unmodified:
    """Runs without a defect, and their processor time in s: of the runs, and of requirements and cells."""

    runs: int = 0
    run_s: float = 0.0
    judging_s: float = 0.0
    judged: dict[tuple[tuple[str, ...], int], Judged] = field(default_factory=dict)

    def keeps_any(self, row: dict[str, Any]) -> bool:
        """Whether the run of a row keeps a requirement that the row violates."""
        key = tuple(row["faults"]), row["seed"]
        found = self.judged[key] = self.judged.get(key) or self._judge(*key)
        return found.is_valid and any(name not in found.violated for name in row["violated"])

    def _judge(self, faults: tuple[str, ...], seed: int) -> Judged:
        spec = RunSpec(str(JOURNEY_FILE), law=LAW, faults=faults, seed=seed, bus="local")
        asked = requirements()
        with tempfile.TemporaryDirectory(prefix="railhil-") as private:
            start_s = time.process_time()
            result = run_into(Path(private) / _RUN, spec, keep=False)
            made_s = time.process_time()
            judged = judge_result(result, asked)
        self.runs += 1
        self.run_s += made_s - start_s
        self.judging_s += time.process_time() - made_s
        return judged

    @property
    def line(self) -> str:
        """The rate of these runs."""
        whole_s = self.run_s + self.judging_s
        if not whole_s:
            return "no run without the defect was made"
        share = 100 * self.judging_s / whole_s
        rate = f"{self.runs / whole_s:.2f} in 1 s of processor time"
        return f"{count_of(self.runs, 'run')}, {rate}, {share:.1f} % of it judging"


def search(place: Path, name: str, seed: int, runs: int, out: Path, unmodified: Unmodified) -> None:
    """Enter the search of each strategy for one defect with one seed into ``out``.

    :param place: of the package with the defect. :raises MeasurementError: the search ended early.
    """
    words = ["-P", "-m", "benchmarks.planted_defects", "--search", str(seed), "--runs", str(runs), "--out", str(out)]
    environment = {**os.environ, "PYTHONPATH": f"{place}{os.pathsep}{_ROOT}"}
    firsts: dict[str, int] = {}
    with Popen([sys.executable, *words], env=environment, cwd=place, stdin=PIPE, stdout=PIPE, text=True) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        for line in process.stdout:
            row = json.loads(line)
            is_shown = unmodified.keeps_any(row)
            if is_shown:
                firsts[row["strategy"]] = row["number"] + 1
            process.stdin.write(f"{_SHOWN if is_shown else ''}\n")
            process.stdin.flush()
    if process.returncode:
        raise MeasurementError(f"the search for {name} with seed {seed} ended with {process.returncode}")
    for strategy in STRATEGIES:
        first = firsts.get(strategy)
        given = {"tool": f"railhil hunt, {strategy}", "defect": name, "seed": seed, "runs": first or runs}
        given |= {} if first is None else {"run": _RUN}
        (out / strategy).mkdir(parents=True, exist_ok=True)
        text = "".join(f"{key} = {json.dumps(value)}\n" for key, value in given.items())
        (out / strategy / ENTRY).write_text(text, "utf-8")


def measure(out: Path, names: Sequence[str], seeds: Sequence[int], runs: int, console: Console) -> None:
    """Make the searches that ``out`` does not have, and print the table of all."""
    unmodified, entries = Unmodified(), []
    with tempfile.TemporaryDirectory(prefix="railhil-") as private:
        places = {name: plant(name, Path(private)) for name in names}
        for seed in seeds:
            for name, place in places.items():
                folder = out / f"{name}-{seed}"
                entries += [folder / strategy for strategy in STRATEGIES]
                if not all((folder / strategy / ENTRY).is_file() for strategy in STRATEGIES):
                    shutil.rmtree(folder, ignore_errors=True)
                    search(place, name, seed, runs, folder, unmodified)
    console.print(table_of(leaderboard(entries)))
    console.print(f"without a defect: {unmodified.line}")


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a table; exit codes as of ``railhil``."""
    parser = OneLineParser(prog="python -m benchmarks.planted_defects", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", action="append", choices=defects(), metavar="ID", help=f"of {', '.join(defects())}")
    parser.add_argument("--seed", action="append", type=int, choices=SEEDS, help="only these")
    parser.add_argument("--runs", type=whole_number(1, RUNS), default=RUNS, metavar="N", help="of a search at most")
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="keep the entries; those that it has are not made")
    parser.add_argument("--search", type=int, help=argparse.SUPPRESS)

    def work() -> int:
        given = parse(parser, arguments)
        if given.search is not None:
            _search(given.search, given.runs, given.out)
            return 0
        with ExitStack() as held:
            out = given.out or Path(held.enter_context(tempfile.TemporaryDirectory(prefix="railhil-")))
            measure(out.resolve(), given.only or [*defects()], given.seed or SEEDS, given.runs, Console(width=120))
        return 0

    return run_guarded("benchmarks.planted_defects", work)


if __name__ == "__main__":
    sys.exit(main())
