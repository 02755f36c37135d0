"""A study made by a call of the library: in processes of this machine, with remarks on standard error."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from rich.console import Console

from railhil.study.engines import running
from railhil.study.execute import Outcome, execute
from railhil.study.plan import P, Study


def say(sentence: str) -> None:
    """Write a remark."""
    print(sentence, file=sys.stderr)


def make_study(study: Study[P, Any], plan: P, jobs: int, out: str | Path | None) -> Outcome:
    """Make or resume a study, and finish it.

    :param jobs: processes; -1: one for each processor.
    :param out: the folder; None: a new one.
    :raises InputError: the folder cannot be used.
    :raises Stopped: workers or parts were lost.
    """
    with running("processes", say, None if jobs == -1 else jobs) as engine:
        made = execute(study, plan, None if out is None else str(out), Console(quiet=True), engine, say)
        return study.finish(plan, made, engine, say)
