"""Functions that run both in the interpreter and, for thousands of trains at once, as machine code, with the same bits.

The bench calls the functions marked :func:`compilable` unchanged (:func:`compilable_functions` where the compiled build
of the bench has the module). The batch (:mod:`railhil.batch.compiled`) has numba
compile the same functions when a compiled loop calls them; nothing is translated, copied or renamed, so a debugger can
step through them in both (``NUMBA_DISABLE_JIT=1`` also runs the loops of the batch in the interpreter).

Such a function may use positional arguments, numbers, named tuples of numbers, tables (tuples in the interpreter,
arrays when compiled), constants of its module, and calls of other marked functions. Python's ``min`` and ``max`` and
numpy's ``where`` and ``all`` behave differently in numba, or are not supported: use :func:`smaller`,
:func:`larger`, :func:`chosen` and :func:`every`. ``round`` and ``bisect_right`` may be used; numpy's ``minimum`` and
``maximum`` where the sign of a zero does not matter. A conditional expression does not stand in the fields of a
returned named tuple: from Python 3.12 on each of its arms is a result of its own, and numba refuses a function whose
results have fields of several types (``int`` and ``float``, a number and a member of an enumeration).

This module does not import numba, which is an extra needed only by the batch.
"""

from __future__ import annotations

import ast
import builtins
import sys
from collections.abc import Callable
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any, TypeVar

import numpy as np

F = TypeVar("F", bound=Callable[..., Any])
N = TypeVar("N", bound=float)
P = TypeVar("P", ast.FunctionDef, ast.ClassDef)

#: Functions that are inlined into the compiled loop that calls them.
INLINE: list[Callable[..., Any]] = []
#: Functions that are compiled separately and called, because most ticks do not need them. Runs computed side by side
#: get NaN for their results, which are floats or named tuples of floats and reach the state.
ASIDE: list[Callable[..., Any]] = []


def compilable(function: F) -> F:
    """Decorator: the batch also compiles this function; it is returned unchanged.

    :raises TypeError: numba could not compile it: it has keyword-only arguments or is a closure.
    """
    INLINE.append(_checked(function))
    return function


def compilable_aside(function: F) -> F:
    """Like :func:`compilable`, for a function that is seldom needed."""
    ASIDE.append(_checked(function))
    return function


def compilable_functions(*functions: Callable[..., Any], aside: bool = False) -> None:
    """Mark functions of a module that the compiled build (setup.py) compiles: it calls a decorated one as an object.

    :param aside: as by :func:`compilable_aside`.
    :raises TypeError: see :func:`compilable`.
    """
    (ASIDE if aside else INLINE).extend(map(_checked, functions))


def source_of(module: ModuleType) -> Path:
    """The Python source of a module, which the compiled build has, too."""
    path = Path(str(module.__file__))
    return path.with_name(f"{module.__name__.rpartition('.')[2]}.py")


def interpreted(function: Callable[..., Any]) -> FunctionType:
    """A marked function in bytecode, which numba reads: itself, or for a compiled module the function made from its
    source.

    Its globals are those of its module.
    """
    if isinstance(function, FunctionType):
        return function
    module = sys.modules[str(function.__module__)]
    path = source_of(module)
    whole = compile(path.read_bytes(), str(path), "exec")
    parts = (part for part in whole.co_consts if isinstance(part, CodeType))
    return FunctionType(next(part for part in parts if part.co_name == function.__name__), vars(module))


def result_type(function: Any) -> Any:
    """The type of a marked function's result: a name in its source, which a compiled module has, too."""
    found = _in_source(function, ast.FunctionDef)
    return _type_of(function, found.returns)


def field_types(kind: Any) -> list[Any]:
    """The types of a named tuple's fields: names in its source. Annotations of a compiled module are lost."""
    fields = (part for part in _in_source(kind, ast.ClassDef).body if isinstance(part, ast.AnnAssign))
    return [_type_of(kind, part.annotation) for part in fields]


def _in_source(item: Any, kind: type[P]) -> P:
    parts = ast.parse(source_of(sys.modules[str(item.__module__)]).read_bytes()).body
    return next(part for part in parts if isinstance(part, kind) and part.name == item.__name__)


def _type_of(item: Any, annotation: ast.expr | None) -> Any:
    assert isinstance(annotation, ast.Name)
    return getattr(builtins, annotation.id, None) or vars(sys.modules[str(item.__module__)])[annotation.id]


def _checked(function: Callable[..., Any]) -> Callable[..., Any]:
    if isinstance(function, BuiltinFunctionType):
        # A function of a compiled module; its source is checked where it is interpreted.
        return function
    if not isinstance(function, FunctionType) or function.__code__.co_kwonlyargcount or function.__code__.co_freevars:
        raise TypeError(f"{function.__qualname__}: compilable is a plain function of positional arguments")
    return function


@compilable
def smaller(a: N, b: N) -> N:
    """``min`` of two numbers; if they are equal, the first."""
    return b if b < a else a


@compilable
def larger(a: N, b: N) -> N:
    """``max`` of two numbers; if they are equal, the first."""
    return b if b > a else a


def chosen(condition: Any, a: Any, b: Any) -> Any:
    """numpy's ``where`` for arrays or numbers; when compiled, for numbers only."""
    return np.where(condition, a, b)


def every(condition: Any) -> Any:
    """numpy's ``all`` for an array or one truth value; when compiled, for one truth value only."""
    return np.all(condition)
