"""The bench without sockets, for users: the same plant, controller and supervisor code in one process.

``local_run`` sends every telegram through the codec and the stores, as ``railhil run --bus local`` does;
``unrecorded_run`` keeps nothing of it but its result. ``direct_run`` couples plant and law by raw integers, for
statistics over hundreds of runs, and ``coupled_run`` does so with any function instead of a law. All of them give the
commands of the real bench.
"""

from __future__ import annotations

from railhil.judge.result import Result
from railhil.run.coupled import coupled_run, direct_run
from railhil.run.local import local_run, unrecorded_run

__all__ = ["Result", "coupled_run", "direct_run", "local_run", "unrecorded_run"]
