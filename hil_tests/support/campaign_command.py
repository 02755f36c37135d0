"""``railhil campaign`` in this process, which is faster than in a separate one."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from hil_tests.support.cli import Done
from railhil.campaign.__main__ import COMMAND
from railhil.common.exit_codes import run_guarded

Campaign = Callable[..., Done]


def campaign_here(capsys: pytest.CaptureFixture[str]) -> Campaign:
    """The command; its arguments are those of the command line."""

    def call(*arguments: str | Path) -> Done:
        handler = signal.getsignal(signal.SIGTERM)
        try:
            code = run_guarded("railhil campaign", lambda: COMMAND.main([str(word) for word in arguments]))
        except SystemExit as end:
            code = int(end.code or 0)
        finally:
            signal.signal(signal.SIGTERM, handler)
        said = capsys.readouterr()
        return Done(code, said.out, said.err)

    return call
