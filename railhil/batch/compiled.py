"""Registers the functions shared by bench and batch with numba, and caches the machine code.

A function marked in :mod:`railhil.common.compilable` is compiled in place when a compiled loop calls it by its own
name, which numba's ``overload`` allows. A compiled function computes the same bits as the interpreted one: no
fast maths, no fused products, and the same ``exp`` and ``log`` of the C library.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import sys
import tempfile
import threading
from bisect import bisect_right
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext, suppress
from dataclasses import dataclass
from math import nan
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from railhil.common import compilable, floats
from railhil.common.compilable import F, field_types, interpreted, result_type, source_of
from railhil.common.extras import missing_library
from railhil.common.output import Output
from railhil.common.user_files import hold_alone

try:
    import numba
    from numba.extending import overload
except ImportError as error:
    raise missing_library("railhil.batch", error, "campaign") from None

#: Exceptions raised when a damaged cache file is read.
_DAMAGED = (EOFError, pickle.UnpicklingError, AttributeError, ImportError, IndexError, KeyError, OSError, ValueError)

#: Compiling is announced if it takes longer than this.
_SAID_AFTER_S = 1.0
#: Options for functions inlined into a loop: no reference counting, no calls.
_INLINE = {"forceinline": True, "_nrt": False}
#: Options for functions that a loop seldom calls.
_ASIDE = {"_nrt": False}

part: Callable[[F], F] = numba.njit(**_INLINE)
aside: Callable[[F], F] = numba.njit(**_ASIDE)
#: The same for loops over lanes and the functions that they call. A division by zero gives infinity as in arrays of
#: numpy, because a loop that may raise is not computed side by side.
side_by_side: Callable[[F], F] = numba.njit(error_model="numpy", **_ASIDE)
side_by_side_part: Callable[[F], F] = numba.njit(error_model="numpy", **_INLINE)


def _as_marked(function: Callable[..., Any]) -> Callable[..., Any]:
    """Overload as by numba's ``register_jitable``, also for a function that is compiled already."""
    source = interpreted(function)
    return lambda *given: source


#: Marked functions that numba knows.
_KNOWN: set[Callable[..., Any]] = set()


def _register() -> None:
    """Tell numba of the functions that have been marked since the last time."""
    for functions, options in ((compilable.INLINE, _INLINE), (compilable.ASIDE, _ASIDE)):
        for function in functions:
            if function not in _KNOWN:
                _KNOWN.add(function)
                overload(function, jit_options=options, strict=False)(_as_marked(function))


def straight(function: Any) -> Callable[..., Any]:
    """A marked function, compiled for loops over lanes. Functions that it seldom needs answer NaN instead, and its
    tables have one row, in which each value lies.

    Such a loop has no calls and no loops, so it is computed side by side. If a result is not a number, the whole
    function has to compute it.
    """
    return side_by_side_part(_without_seldom(function))


def _without_seldom(function: Callable[..., Any]) -> FunctionType:
    source = interpreted(function)
    names = dict(source.__globals__)
    for name in source.__code__.co_names:
        called = names.get(name)
        if any(called is seldom for seldom in compilable.ASIDE):
            names[name] = side_by_side_part(_never(result_type(called)))
        elif any(called is other for other in compilable.INLINE):
            names[name] = straight(called)
        elif called is bisect_right:
            names[name] = side_by_side_part(lambda values, value: 1)
    return FunctionType(source.__code__, names, source.__name__)


def _never(kind: Any) -> Callable[..., Any]:
    """A function that answers NaN: a float, or a named tuple of floats."""
    answer = _not_a_number(kind)
    return lambda *given: answer


def _not_a_number(kind: Any) -> Any:
    return nan if kind is float else kind(*map(_not_a_number, field_types(kind)))


def _bisect_right(values: Any, value: Any) -> Callable[..., int]:
    def by_steps_of_one(values: Any, value: Any) -> int:
        # A linear search is enough: the tables have few rows.
        row = 0
        while row < len(values) and values[row] <= value:
            row += 1
        return row

    return by_steps_of_one


def _chosen(condition: Any, a: Any, b: Any) -> Callable[..., Any]:
    return lambda condition, a, b: a if condition else b


def _every(condition: Any) -> Callable[..., Any]:
    return lambda condition: condition


#: For functions that numba does not support, or not for single numbers: the factory of the function compiled instead.
for _function, _instead in ((bisect_right, _bisect_right), (compilable.chosen, _chosen), (compilable.every, _every)):
    overload(_function, jit_options=_INLINE, strict=False)(_instead)

# Marked functions of modules that are imported later are registered before the first call of a loop.
_register()


@dataclass(frozen=True, slots=True)
class Kept:
    """A compiled function and the folder with its machine code; ``kept``: whether that folder is writable."""

    name: str
    folder: Path
    kept: bool

    @property
    def is_there(self) -> bool:
        """Whether the machine code of an earlier process exists."""
        return self.kept and any(self.folder.glob(f"*/*.{self.name}-*.nbi"))


#: Every function decorated with :func:`cached`.
FUNCTIONS: list[Kept] = []


def _folder(*sources: ModuleType | str) -> tuple[Path, bool]:
    """The folder with the machine code of functions, and whether it can be written.

    numba checks only the file of the function itself. This folder is named after the contents of every file whose
    functions may be compiled into it (``NUMBA_CACHE_DIR``, else ``XDG_CACHE_HOME``, else ``~/.cache``).
    """
    # numba's own subfolder is named after the path of the source.
    digest = hashlib.sha256(f"{np.__version__} {__file__}".encode())
    for source in (__file__, compilable, floats, *sources):
        digest.update((source_of(source) if isinstance(source, ModuleType) else Path(source)).read_bytes())
    home = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    folder = Path(home) / "railhil" / f"batch-{digest.hexdigest()[:16]}"
    try:
        # "~" stays in the name if this user has no home.
        kept = not home.startswith("~")
        if kept:
            folder.mkdir(parents=True, exist_ok=True)
            kept = os.access(folder, os.W_OK)
    except OSError:
        # Otherwise each process compiles anew: numba's default folder would not detect a change of the plant.
        kept = False
    return folder, kept


@contextmanager
def _said(what: str, file: Path, kept: bool) -> Iterator[None]:
    """Inside ``with``, a text is compiled, or its machine code is read. If compiling takes longer than
    :data:`_SAID_AFTER_S`, one line on standard error says so.

    :param file: with the text.
    :param kept: whether the folder can be written.
    """
    how_often = "once for this machine" if kept else "in every process"
    line = f"compiling {what} for the batch ({how_often}; up to half a minute) ..."
    with ExitStack() as held:
        if kept:
            held.enter_context(hold_alone(file))
        if not (kept and any(file.parent.glob(f"*/{file.stem}.*.nbi"))):
            timer = threading.Timer(_SAID_AFTER_S, Output(stderr=True).say, (line,))
            timer.daemon = True
            held.callback(timer.cancel)
            timer.start()
        yield


def _kept(
    function: Callable[..., Any], folder: Path, kept: bool, compiling: AbstractContextManager[None]
) -> Callable[..., Any]:
    """A function whose machine code is in a folder, if it is ``kept``.

    :param compiling: entered while it is compiled, or its machine code is read.
    """

    def made(kept: bool) -> Any:
        before = numba.config.CACHE_DIR
        numba.config.CACHE_DIR = str(folder)
        try:
            return numba.njit(cache=kept, nogil=True, _nrt=False)(function)
        finally:
            numba.config.CACHE_DIR = before

    kernel, loaded = made(kept), False

    def call(*given: Any) -> Any:
        nonlocal kernel, loaded
        if loaded:
            return kernel(*given)
        loaded = True
        _register()
        with compiling:
            try:
                return kernel(*given)
            except _DAMAGED:
                # A cache file was truncated; this shows before anything is computed.
                for file in folder.glob("*/*.nb?"):
                    file.unlink(missing_ok=True)
                kernel = made(False)
            return kernel(*given)

    return call


def cached(*sources: ModuleType | str) -> Callable[[Callable[..., Any]], Any]:
    """Decorator: compile a function and cache the machine code on disk between processes.

    :param sources: modules and files whose functions and constants are compiled into it.
    """
    folder, kept = _folder(*sources)

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        FUNCTIONS.append(Kept(function.__name__, folder, kept))
        return _kept(function, folder, kept, hold_alone(folder) if kept else nullcontext())

    return decorate


def cached_text(text: str, name: str, what: str, *sources: ModuleType | str) -> Callable[..., Any]:
    """The function of an emitted text; the text is kept beside its machine code, so a traceback shows it.

    :param name: of the function.
    :param what: what it computes, in words.
    :param sources: as for :func:`cached`.
    """
    folder, kept = _folder(*sources)
    file = folder / f"{name}_{hashlib.sha256(text.encode()).hexdigest()[:16]}.py"
    if kept and not file.exists():
        # Several processes may write it; the first one's stays, for numba looks at the file's time.
        with tempfile.NamedTemporaryFile("w", dir=folder, encoding="utf-8") as written, suppress(FileExistsError):
            written.write(text)
            written.flush()
            os.link(written.name, file)
    # A module, because numba looks for it by its name when it reads the machine code of an earlier process.
    module = sys.modules[file.stem] = ModuleType(file.stem)
    exec(compile(text, str(file), "exec"), vars(module))  # noqa: S102
    return _kept(getattr(module, name), folder, kept, _said(what, file, kept))
