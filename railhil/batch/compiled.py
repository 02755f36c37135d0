"""What numba is told of the functions that bench and batch have in common, and how its machine code is kept.

A function marked in :mod:`railhil.common.compilable` is compiled from where it stands, when a compiled loop calls it by
its own name: numba's ``register_jitable`` says that it may. A compiled function computes the same bits as the
interpreted one: no fast maths, no fused products, and the same ``exp`` and ``log`` of the C library.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import shutil
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from railhil.common import compilable
from railhil.common.compilable import F

# Their marked functions are told to numba.
from railhil.plant_sim import command_watch, dynamics, forces, sensors
from railhil.scenarios import target
from railhil.supervisor import measures
from railhil.supervisor.extras import missing

try:
    import numba
    from numba.extending import overload, register_jitable
except ImportError as error:
    raise missing("batch", error, "campaign") from None

#: What a damaged file of the cache raises when it is read.
_DAMAGED = (EOFError, pickle.UnpicklingError, AttributeError, ImportError, IndexError, KeyError, OSError, ValueError)

#: For what becomes part of a loop: without references to count, and without calls.
_INLINE = {"forceinline": True, "_nrt": False}
#: For what a loop seldom calls.
_ASIDE = {"_nrt": False}

part: Callable[[F], F] = numba.njit(**_INLINE)
aside: Callable[[F], F] = numba.njit(**_ASIDE)

for _function in compilable.INLINE:
    register_jitable(**_INLINE)(_function)
for _function in compilable.ASIDE:
    register_jitable(**_ASIDE)(_function)


def _bisect_right(values: Any, value: Any) -> Callable[..., int]:
    def by_steps_of_one(values: Any, value: Any) -> int:
        # The tables have a few rows.
        row = 0
        while row < len(values) and values[row] <= value:
            row += 1
        return row

    return by_steps_of_one


def _chosen(condition: Any, a: Any, b: Any) -> Callable[..., Any]:
    return lambda condition, a, b: a if condition else b


def _every(condition: Any) -> Callable[..., Any]:
    return lambda condition: condition


#: For what numba does not know, or not with single numbers: what makes the function that it compiles instead.
for _function, _instead in ((bisect_right, _bisect_right), (compilable.chosen, _chosen), (compilable.every, _every)):
    overload(_function, jit_options=_INLINE, strict=False)(_instead)


@dataclass(frozen=True, slots=True)
class Kept:
    """A compiled function and the folder that keeps its machine code; ``kept``: whether that can be written."""

    name: str
    folder: Path
    kept: bool

    @property
    def is_there(self) -> bool:
        """Whether an earlier process has left it."""
        return any(self.folder.glob(f"*/*.{self.name}-*.nbi"))


#: Every function that :func:`cached` has been put around.
FUNCTIONS: list[Kept] = []


def cached(*sources: str) -> Callable[[Callable[..., Any]], Any]:
    """Decorator: compile a function and keep the machine code on disk between processes.

    numba looks only at the file of the function itself; here the folder is named after the contents of every file
    whose functions may have gone into it (``NUMBA_CACHE_DIR``, else ``XDG_CACHE_HOME``, else ``~/.cache``).

    :param sources: further files.
    """
    # numba's own folder inside is named after the place of the source.
    digest = hashlib.sha256(f"{np.__version__} {__file__}".encode())
    modules = (dynamics, forces, sensors, command_watch, target, measures, compilable)
    for path in (__file__, *(str(module.__file__) for module in modules), *sources):
        digest.update(Path(path).read_bytes())
    home = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    folder = Path(home) / "railhil" / f"batch-{digest.hexdigest()[:16]}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        kept = os.access(folder, os.W_OK)
    except OSError:
        # Then each process compiles anew: numba's own choice of a folder would not see a change of the plant.
        kept = False

    def made(function: Callable[..., Any], kept: bool) -> Any:
        before = numba.config.CACHE_DIR
        numba.config.CACHE_DIR = str(folder)
        try:
            return numba.njit(cache=kept, nogil=True, _nrt=False)(function)
        finally:
            numba.config.CACHE_DIR = before

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        FUNCTIONS.append(Kept(function.__name__, folder, kept))
        kernel, loaded = made(function, kept), False

        def call(*given: Any) -> Any:
            nonlocal kernel, loaded
            if not loaded:
                loaded = True
                try:
                    return kernel(*given)
                except _DAMAGED:
                    # A file of the cache was cut short; it is read before anything is computed.
                    shutil.rmtree(folder, ignore_errors=True)
                    kernel = made(function, False)
            return kernel(*given)

        return call

    return decorate
