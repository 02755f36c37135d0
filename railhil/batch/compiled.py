"""The plant's own functions as machine code: numba compiles their very bytecode, so the dynamics exist once.

A compiled function computes the same bits as the interpreted one: no fast maths, no fused products, the same ``exp``
and ``log`` of the C library, and ``min``, ``max`` and ``round`` with Python's rules for equal numbers and ties.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any, NamedTuple

import numpy as np

from railhil.plant_sim import dynamics, forces, sensors, watch
from railhil.scenarios import target
from railhil.supervisor import measures
from railhil.supervisor.extras import missing

try:
    import numba
except ImportError as error:
    raise missing("batch", error, "campaign") from None

#: What a damaged file of the cache raises when it is read.
_DAMAGED = (EOFError, pickle.UnpicklingError, AttributeError, ImportError, IndexError, KeyError, OSError, ValueError)


def _bisect_right(values: Any, value: float) -> int:
    """As :func:`bisect.bisect_right`, by steps of one: the tables have a few rows."""
    row = 0
    while row < len(values) and values[row] <= value:
        row += 1
    return row


def _smaller(a: Any, b: Any) -> Any:
    """``min`` of Python: of equal numbers the first."""
    return b if b < a else a


def _larger(a: Any, b: Any) -> Any:
    """``max`` of Python: of equal numbers the first."""
    return b if b > a else a


def _nearest(value: float) -> int:
    """``round`` of Python: ties to even."""
    return int(np.rint(value))


def _chosen(condition: bool, a: float, b: float) -> float:
    """``where`` of numpy for single numbers."""
    return a if condition else b


def _itself(condition: bool) -> bool:
    """``all`` of numpy for a single condition."""
    return condition


class _Levels(NamedTuple):
    """The ladder's levels as plain integers."""

    NORMAL: int
    HOLD: int
    TRACTION_CUT: int
    SERVICE_BRAKE: int
    EMERGENCY: int


LEVELS = _Levels(*(int(level) for level in watch.Level))


def _positional(code: CodeType) -> CodeType:
    """The code with its keyword-only arguments as positional ones: compiled calls know no others."""
    return code.replace(co_argcount=code.co_argcount + code.co_kwonlyargcount, co_kwonlyargcount=0)


def compiled(function: Callable[..., Any], namespace: dict[str, Any]) -> Any:
    """A function compiled, its global names taken from ``namespace``; keyword-only arguments are positional."""
    kind = aside if function.__name__ in _SELDOM else part
    return kind(FunctionType(_positional(function.__code__), namespace, function.__name__))


#: Compiles what becomes part of a loop: without references to count, and without calls.
part = numba.njit(forceinline=True, _nrt=False)
#: Compiles what a loop seldom calls.
aside = numba.njit(_nrt=False)
#: Functions of the plant that most ticks do not need.
_SELDOM = ("_to_rest", "_from_rest", "_waiting_s", "clipped_mean_n", "lag")

bisect_right = part(_bisect_right)
smaller = part(_smaller)
larger = part(_larger)
nearest = part(_nearest)
_PYTHON = {"bisect_right": bisect_right, "min": smaller, "max": larger, "round": nearest, "Level": LEVELS}


def functions_of(module: ModuleType, using: dict[str, Any]) -> dict[str, Any]:
    """Every function that a module defines, compiled, by name; each calls the others in their compiled form.

    :param using: names that stand for something else than in the module.
    """
    namespace = {**vars(module), **_PYTHON, **using}
    own = {
        name: compiled(value, namespace)
        for name, value in vars(module).items()
        if isinstance(value, FunctionType) and value.__module__ == module.__name__
    }
    namespace.update(own)
    return own


_FORCES = functions_of(forces, {})
_DYNAMICS = functions_of(dynamics, _FORCES)
_WATCH = functions_of(watch, {})
#: Functions of numpy, for single numbers.
_ARRAY_FUNCTIONS = {"where": part(_chosen), "minimum": smaller}
_MEASURES = functions_of(measures, _ARRAY_FUNCTIONS)
_TARGET = functions_of(target, {**_ARRAY_FUNCTIONS, "maximum": larger, "sqrt": sqrt, "all_of": part(_itself)})
_SENSORS = {**vars(sensors), **_PYTHON}

applied_n = _DYNAMICS["applied_n"]
acceleration_mps2 = _DYNAMICS["acceleration_mps2"]
lag = _DYNAMICS["lag"]
step = _DYNAMICS["step"]
watch_step = _WATCH["watch_step"]
watch_brake_mps2 = _WATCH["watch_brake_mps2"]
#: Methods of the sensors; the first argument is anything with their two attributes.
speed_01mmps = compiled(sensors.AxleSensors.speed_01mmps, _SENSORS)
odometer_mm = compiled(sensors.AxleSensors.odometer_mm, _SENSORS)
odometer_between_mm = compiled(sensors.AxleSensors.odometer_between_mm, _SENSORS)
limits_under_train = _MEASURES["limits_under_train"]
work_j = _MEASURES["work_j"]
time_in_piece_s = _TARGET["time_in_piece_s"]
error_kmh = _MEASURES["error_kmh"]


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
    modules = (dynamics, forces, sensors, watch, target, measures)
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
