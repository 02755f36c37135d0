"""A study made by a call of the library: in processes of this machine, with remarks on standard error."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from rich.console import Console

from railhil.batch import say_compiling
from railhil.common.extras import need
from railhil.scenarios.given import GivenController
from railhil.study.engines import running
from railhil.study.execute import Outcome, execute
from railhil.study.manifest import checked_request
from railhil.study.pages import page_line
from railhil.study.plan import P, Study


def _say(sentence: str) -> None:
    """Write a remark."""
    print(sentence, file=sys.stderr)


def make_study(
    study: Study[P, Any],
    request: Any,
    jobs: int,
    out: str | Path | None,
    code: Mapping[str, GivenController] | None = None,
    how: Callable[[P], tuple[str, str | None]] = lambda plan: ("", None),
) -> tuple[P, Outcome]:
    """Make or resume a study, finish it, and write its page.

    :param jobs: processes; -1: one for each processor.
    :param out: the folder; None: a new one.
    :param code: controllers of the user, for a study that may have them.
    :param how: as for :class:`railhil.study.command.Command`.
    :raises InputError: the request or the folder cannot be used.
    :raises Stopped: workers or parts were lost.
    """
    checked = checked_request(study, request, Path(f"railhil.{study.name}"))
    plan = study.make_plan(checked) if code is None else study.make_plan(checked, code)
    remark, kernel = how(plan)
    if remark:
        _say(remark)
    if kernel is not None:
        need("numba", "campaign")
        say_compiling(_say, kernel)
    with running("processes", _say, None if jobs == -1 else jobs) as engine:
        made = execute(study, plan, None if out is None else str(out), Console(quiet=True), engine, _say)
        made = study.finish(plan, made, engine, _say)
    page_line(study, plan, made)
    return plan, made
