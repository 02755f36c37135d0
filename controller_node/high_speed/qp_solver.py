"""Quadratic programs with linear constraints, solved by DAQP (a dual active-set method, Arnstrom et al. 2022).

Every solution starts anew, so that it depends on nothing but the problem. DAQP is the extra [qp].
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from railhil.common.extras import missing_library
from railhil.controller_node.high_speed.model import Matrix

#: ``solve(hessian, linear, rows, upper, lower)``: the minimum of x'Hx/2 + f'x with lower <= (x, rows x) <= upper;
#: bounds first limit x, then the rows.
Solver = Callable[[Matrix, Matrix, Matrix, Matrix, Matrix], Matrix]

_SOLVED = 1
#: DAQP's numbers for problems that have no solution, or took too long.
_WORDS = {-1: "no solution fulfils the constraints", -2: "cycling", -3: "unbounded", -4: "too many iterations"}


class SolverError(Exception):
    """A quadratic program was not solved; one line."""


def daqp_solver(law: str) -> Solver:
    """DAQP.

    :param law: named in the message if it is not installed.
    :raises InputError: it is not installed.
    """
    try:
        import daqp
    except ImportError as error:
        raise missing_library(law, error, "qp") from None

    def solve(hessian: Matrix, linear: Matrix, rows: Matrix, upper: Matrix, lower: Matrix) -> Matrix:
        kinds = np.zeros(len(upper), dtype=np.intc)
        found, _, flag, _ = daqp.solve(hessian, linear, rows, upper, lower, kinds)
        if flag != _SOLVED:
            raise SolverError(f"quadratic program: {_WORDS.get(flag, f'DAQP answers {flag}')}")
        answer: Any = found
        return np.asarray(answer, dtype=np.float64)

    return solve
