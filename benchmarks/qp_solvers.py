"""Compares solvers on the quadratic programs of the law delay_qp: ``python -m benchmarks.qp_solvers``.

The programs are recorded in the first two minutes of a journey, for one unit and for a train of three with couplers,
every so many of them. Each solver starts anew for each program; "warm" begins with the solution of the program before.
Times are processor time of a call from dense matrices, as the law calls it. "mm/s2" is the largest difference of the
first commands from those of DAQP: they are sent in whole mm/s2. The last column is a hash of all solutions: equal on
two Pythons if they give the same bytes. OSQP, Clarabel and qpOASES (in casadi) are no part of an extra: pip installs
them.
"""

from __future__ import annotations

import hashlib
import platform
import sys
import time
from collections.abc import Callable, Sequence
from importlib.metadata import PackageNotFoundError, metadata, version
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from railhil.bench import direct_run
from railhil.common.command_line import OneLineParser, parse, whole_number
from railhil.common.exit_codes import run_guarded
from railhil.controller_node.high_speed.laws import delay_qp
from railhil.controller_node.high_speed.qp_problem import daqp_solver
from railhil.scenarios.load import load_any
from railhil.scenarios.parameters import ParameterSet
from railhil.scenarios.run_spec import LawSpec, RunSpec

LAW = "delay_qp"
#: Programs: title, scenario, parameters of the law, where the first command of a program is: p less n.
SETS: tuple[tuple[str, str, dict[str, Any]], ...] = (
    ("one unit", "hst_short", {}),
    ("train of three units", "emu3_short", {"loop": "train"}),
)
#: Accuracy asked of the solvers that have one.
_TOLERANCE = 1e-8
_SHOWN_DIGITS = 12


class Program(NamedTuple):
    """Arguments of :data:`railhil.controller_node.high_speed.qp_problem.Solver`."""

    hessian: Any
    linear: Any
    rows: Any
    upper: Any
    lower: Any


#: A program and the solution of the one before (None: the first, or not warm) to its solution.
Solve = Callable[[Program, Any], Any]


def recorded(scenario: str, values: dict[str, Any]) -> list[Program]:
    """All programs of a run."""
    found: list[Program] = []

    def made(law: str) -> Any:
        solve = daqp_solver(law)

        def kept(*given: Any) -> Any:
            found.append(Program(*(part.copy() for part in given)))
            return solve(*given)

        return kept

    parameters = ParameterSet(LAW, values, Path("benchmark.toml")) if values else None
    with patch.object(delay_qp, "daqp_solver", made):
        direct_run(load_any(scenario), RunSpec(scenario, law=LawSpec(LAW, "float64", parameters=parameters), seed=301))
    return found


def _daqp() -> Solve:
    import daqp

    def solve(program: Program, before: Any) -> Any:
        kinds = np.zeros(len(program.upper), dtype=np.intc)
        more = {} if before is None else {"primal_start": before}
        found, _, flag, _ = daqp.solve(*program, kinds, **more)
        assert flag == 1
        return found

    return solve


def _osqp() -> Solve:
    import osqp
    from scipy import sparse

    def solve(program: Program, before: Any) -> Any:
        solver = osqp.OSQP()
        rows = sparse.csc_matrix(np.vstack([np.eye(len(program.linear)), program.rows]))
        solver.setup(
            sparse.csc_matrix(np.triu(program.hessian)), program.linear, rows, program.lower, program.upper,
            verbose=False, eps_abs=_TOLERANCE, eps_rel=_TOLERANCE, max_iter=100_000,
        )  # fmt: skip
        if before is not None:
            solver.warm_start(x=before)
        return solver.solve().x

    return solve


def _clarabel() -> Solve:
    import clarabel
    from scipy import sparse

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = _TOLERANCE

    def solve(program: Program, before: Any) -> Any:
        rows = np.vstack([np.eye(len(program.linear)), program.rows])
        high, low = np.isfinite(program.upper), np.isfinite(program.lower)
        both = sparse.csc_matrix(np.vstack([rows[high], -rows[low]]))
        bounds = np.concatenate([program.upper[high], -program.lower[low]])
        cones = [clarabel.NonnegativeConeT(len(bounds))]
        hessian = sparse.csc_matrix(np.triu(program.hessian))
        return np.array(clarabel.DefaultSolver(hessian, program.linear, both, bounds, cones, settings).solve().x)

    return solve


def _qpoases() -> Solve:
    import casadi

    made: dict[tuple[int, int], Any] = {}

    def solve(program: Program, before: Any) -> Any:
        size, rows = len(program.linear), len(program.rows)
        if (rows, size) not in made:
            shapes = {"h": casadi.Sparsity.dense(size, size), "a": casadi.Sparsity.dense(rows, size)}
            made[rows, size] = casadi.conic("program", "qpoases", shapes, {"printLevel": "none"})
        return np.array(
            made[rows, size](
                h=program.hessian, g=program.linear, a=program.rows, lba=program.lower[size:],
                uba=program.upper[size:], lbx=program.lower[:size], ubx=program.upper[:size],
            )["x"]
        ).ravel()  # fmt: skip

    return solve


#: Title, distribution, whether warm, what makes it.
SOLVERS: tuple[tuple[str, str, bool, Callable[[], Solve]], ...] = (
    ("DAQP", "daqp", False, _daqp),
    ("DAQP, warm", "daqp", True, _daqp),
    ("OSQP", "osqp", False, _osqp),
    ("OSQP, warm", "osqp", True, _osqp),
    ("Clarabel", "clarabel", False, _clarabel),
    ("qpOASES (casadi)", "casadi", False, _qpoases),
)


def solved(solve: Solve, programs: Sequence[Program], warm: bool) -> tuple[Any, list[float]]:
    """Solutions, (programs, unknowns), and processor time of each, s."""
    found, taken_s, before = [], [], None
    for program in programs:
        start_s = time.process_time()
        found.append(np.asarray(solve(program, before)))
        taken_s.append(time.process_time() - start_s)
        before = found[-1] if warm else None
    return np.array(found), taken_s


def exceeded(programs: Sequence[Program], found: Any) -> float:
    """Largest amount by which a solution exceeds a bound, m/s^2 or kN; 0 if none does."""
    rows = [np.concatenate([x, program.rows @ x]) for program, x in zip(programs, found, strict=True)]
    pairs = zip(programs, rows, strict=True)
    return max(0.0, *(float(np.max([values - program.upper, program.lower - values])) for program, values in pairs))


def _licence(distribution: str) -> str:
    known = metadata(distribution)
    text = str(known.get("License-Expression") or known.get("License") or "?")
    return {"GNU Lesser General Public License v3 or later (LGPLv3+)": "LGPL-3.0+"}.get(text, text)


def _compared(title: str, programs: Sequence[Program], moves: int, units: int) -> Table:
    size, rows = len(programs[0].linear), len(programs[0].rows)
    head = f"{title}: {len(programs)} programs of {size} unknowns and {rows} rows; Python {platform.python_version()}"
    table = Table(title=head, title_justify="left", box=SIMPLE_HEAD, show_edge=False, pad_edge=False)
    table.add_column("solver")
    columns = (
        "version",
        "licence",
        "time us\nmedian",
        "p99",
        "bound\nexceeded",
        "mm/s2",
        "twice the\nsame bytes",
        "hash",
    )
    for column in columns:
        table.add_column(column, justify="right")
    reference = None
    # p and n of the first sample of each unit.
    places = [unit * 2 * moves for unit in range(units)]
    for name, distribution, warm, make in SOLVERS:
        try:
            solve, which = make(), version(distribution)
        except (ImportError, PackageNotFoundError):
            table.add_row(name, "MISSING", f"pip install {distribution}")
            continue
        solved(solve, programs[:3], warm)
        found, taken_s = solved(solve, programs, warm)
        again, _ = solved(solve, programs, warm)
        commands = np.stack([found[:, place] - found[:, place + moves] for place in places], axis=1)
        reference = commands if reference is None else reference
        times_us = np.array(taken_s) * 1e6
        table.add_row(
            name, which, _licence(distribution), f"{np.median(times_us):.0f}", f"{np.percentile(times_us, 99):.0f}",
            f"{abs(exceeded(programs, found)):.1e}", f"{np.abs(commands - reference).max() * 1000:.1e}",
            "yes" if found.tobytes() == again.tobytes() else "NO",
            hashlib.sha256(found.tobytes()).hexdigest()[:_SHOWN_DIGITS],
        )  # fmt: skip
    return table


def main() -> int:
    """Print the tables."""
    parser = OneLineParser(prog="python -m benchmarks.qp_solvers", description=__doc__.splitlines()[0])
    parser.add_argument("--programs", type=whole_number(3, 10_000), default=100, metavar="N", help="(default 100)")
    wanted = parse(parser).programs
    console = Console(markup=False, emoji=False, highlight=False)
    if not console.is_terminal:
        console.width = 120
    for title, scenario, values in SETS:
        every = recorded(scenario, values)
        programs = every[:: max(1, len(every) // wanted)][:wanted]
        units = len(load_any(scenario).task.unit)  # type: ignore[union-attr]
        console.print(_compared(title, programs, delay_qp.DelayQpParameters().control_horizon, units))
        console.print()
    return 0


if __name__ == "__main__":
    sys.exit(run_guarded("python -m benchmarks.qp_solvers", main))
