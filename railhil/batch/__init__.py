"""Many runs of a scenario at once: the code that the batches of all systems share.

A system's part ``batch`` makes the runs, with the plant's own functions compiled by numba (:mod:`.compiled`, extra
``campaign``) and the law on arrays. Without it they go through the nodes of the bench (:mod:`.nodes`). Each run equals
the run of the bench bit by bit.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from railhil.batch.case import Batch, Case

__all__ = ["Batch", "Case", "say_compiling"]


def say_compiling(say: Callable[[str], None], kernel: str | None) -> None:
    """Print one sentence before the batch is compiled, or nothing if the machine code is cached.

    :param kernel: module with the compiled loops; None: there are none.
    :raises scenarios.errors.InputError: numba is missing.
    """
    if kernel is None:
        return
    # Importing it registers its compiled functions.
    module = import_module(kernel)
    from railhil.batch.compiled import FUNCTIONS

    absent = [function for function in FUNCTIONS if hasattr(module, function.name) and not function.is_there]
    if not absent:
        return
    how_often = "once for this machine"
    if not all(function.kept for function in absent):
        how_often = f"in every process, as {absent[0].folder} cannot be written; NUMBA_CACHE_DIR names another place"
    say(f"compiling the batch of trains ({how_often}; up to a minute) ...")
