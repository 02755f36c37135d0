"""python-can without asammdf.

python-can imports it, and pandas with it, for MF4 files of its own: half a second at the start of every command and
node of an installation with the extra ``mdf``.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

_ASAMMDF = "asammdf"


@contextmanager
def without_asammdf() -> Iterator[None]:
    """Inside ``with``, asammdf cannot be imported, unless it or python-can has been already."""
    if "can" not in sys.modules and _ASAMMDF not in sys.modules:
        # None makes an import fail (reference of the language, 5.3.1).
        sys.modules[_ASAMMDF] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        allow_asammdf()


def allow_asammdf() -> None:
    """End :func:`without_asammdf`, for a command that needs asammdf."""
    if sys.modules.get(_ASAMMDF, ...) is None:
        del sys.modules[_ASAMMDF]
