"""Functions that run in the interpreter and, for thousands of trains at once, as machine code: to the same bits.

The bench calls the functions marked :func:`compilable` as they stand. The batch (:mod:`railhil.batch.compiled`) has
numba compile the very same ones when a compiled loop calls them; nothing is translated, copied or renamed, so that a
debugger steps through them in either (``NUMBA_DISABLE_JIT=1`` runs the loops of the batch in the interpreter, too).

What such a function may be made of: positional arguments, numbers, named tuples of them, tables (tuples in the
interpreter, arrays when compiled), constants of its module, and calls of functions that are marked, too. Python's
``min`` and ``max`` and numpy's ``where`` and ``all`` mean something else to numba, or nothing: use :func:`smaller`,
:func:`larger`, :func:`chosen` and :func:`every`. ``round`` and ``bisect_right`` may be used; numpy's ``minimum`` and
``maximum`` where the sign of a zero does not matter.

Nothing here knows numba: it is an extra, and only the batch needs it.
"""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType
from typing import Any, TypeVar

import numpy as np

F = TypeVar("F", bound=Callable[..., Any])
N = TypeVar("N", bound=float)

#: Functions that become a part of the loop that calls them.
INLINE: list[Callable[..., Any]] = []
#: Functions that a loop calls where they stand: most ticks do not need them.
ASIDE: list[Callable[..., Any]] = []


def compilable(function: F) -> F:
    """Decorator: the batch compiles this function, too; it is returned as it is.

    :raises TypeError: numba could not: keyword-only arguments, or names of a function around it.
    """
    INLINE.append(_checked(function))
    return function


def compilable_aside(function: F) -> F:
    """As :func:`compilable`, for a function that is seldom needed."""
    ASIDE.append(_checked(function))
    return function


def _checked(function: Callable[..., Any]) -> Callable[..., Any]:
    if not isinstance(function, FunctionType) or function.__code__.co_kwonlyargcount or function.__code__.co_freevars:
        raise TypeError(f"{function.__qualname__}: compilable is a plain function of positional arguments")
    return function


@compilable
def smaller(a: N, b: N) -> N:
    """``min`` of two numbers: of equal ones the first."""
    return b if b < a else a


@compilable
def larger(a: N, b: N) -> N:
    """``max`` of two numbers: of equal ones the first."""
    return b if b > a else a


def chosen(condition: Any, a: Any, b: Any) -> Any:
    """``where`` of numpy, of arrays or numbers; compiled: of numbers."""
    return np.where(condition, a, b)


def every(condition: Any) -> Any:
    """``all`` of numpy, of arrays or one truth value; compiled: of one."""
    return np.all(condition)
