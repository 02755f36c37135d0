"""What a command need not load at its start, although it is installed."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

_ASAMMDF = "asammdf"
#: What matplotlib calls for each class of artists, to describe its properties.
_DESCRIBE = "_update_set_signature_and_docstring"
#: New objects after which unreachable cycles are looked for; Python's own number is 700.
_OBJECTS = 100_000


@contextmanager
def rare_collection() -> Iterator[None]:
    """Inside ``with``, cycles are looked for more rarely: while modules load, nearly every new object stays."""
    before = gc.get_threshold()
    gc.set_threshold(_OBJECTS, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)


def one_thread_for_matrices() -> None:
    """Numpy, if it is loaded from here on, multiplies matrices in one thread, in this process and in those it starts.

    All matrices here are small; threads for them would cost every process 40 ms at its start, and sums could depend on
    the number of processors. What the user has set stays.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


@contextmanager
def without_asammdf() -> Iterator[None]:
    """Inside ``with``, asammdf cannot be imported, unless it or python-can has been already.

    python-can imports it, and pandas with it, for MF4 files of its own: half a second at the start of every command
    and node of an installation with the extra ``mdf``.
    """
    if "can" not in sys.modules and _ASAMMDF not in sys.modules:
        sys.modules[_ASAMMDF] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        allow_asammdf()


def allow_asammdf() -> None:
    """End :func:`without_asammdf`, for a command that needs asammdf."""
    if sys.modules.get(_ASAMMDF, ...) is None:
        del sys.modules[_ASAMMDF]


@contextmanager
def undocumented_matplotlib() -> Iterator[None]:
    """Inside ``with``, matplotlib is loaded without the help texts that it makes for each kind of artist: they take
    half of its time to load, and a command shows them to nobody. Drawings are the same. It is for commands, not for a
    process in which somebody may ask matplotlib for help.

    :raises ImportError: it is not installed.
    """
    known = "matplotlib.artist" in sys.modules
    from matplotlib import artist

    names = {} if known else {(artist, "kwdoc"): _no_text, (artist.Artist, _DESCRIBE): classmethod(_no_text)}
    # Names that a later version of matplotlib may not have any more.
    before = [(owner, name, vars(owner)[name]) for owner, name in names if name in vars(owner)]
    for owner, name, _ in before:
        setattr(owner, name, names[owner, name])
    try:
        yield
    finally:
        for owner, name, original in before:
            setattr(owner, name, original)


def _no_text(_: object) -> str:
    return ""
