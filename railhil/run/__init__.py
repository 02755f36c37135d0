"""The one place where runs are made. ``railhil.run(...)`` is the library's function of that name.

::

    spec.py        a RunSpec from arguments, checked like a file
    make.py        record_run: a run on any transport, recorded into its folder and judged, with observers
    local.py       a run whose nodes are all in this process
    coupled.py     a run without telegrams: plant and law coupled by raw integers
    replay.py      one node driven by a record
    report.py      the report of runs that have just been recorded
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any


class _Callable(ModuleType):
    """``railhil.run`` is both the library's function and this package: importing one must not hide the other."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        from railhil.library import run

        return run(*args, **kwargs)


sys.modules[__name__].__class__ = _Callable
