"""``railhil campaign``: thousands of perturbed runs of several laws, in parts that survive any interruption.

::

    plan.py     what is run: laws, seeds, chunks; its identity is recorded in campaign.json
    work.py     one chunk -> the bytes of its part (any process, any machine)
    engines.py  chunks -> parts, in this process or over the cores; dask_engine.py: over machines
    folder.py   parts/, results.parquet, summary.json; manifest.py: campaign.json, which is also the lock
    summary.py  results -> statistics.py's figures and worst.py's runs; show.py prints them
    verify.py   repeats some of the runs on the real bench
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any


class _Callable(ModuleType):
    """``railhil.campaign`` is both the library's function and this package: importing one must not hide the other."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        from railhil.library import campaign

        return campaign(*args, **kwargs)


sys.modules[__name__].__class__ = _Callable
