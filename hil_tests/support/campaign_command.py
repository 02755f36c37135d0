"""``railhil campaign`` in this process: faster than in one of its own."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from hil_tests.support.cli import Done
from railhil.campaign import __main__ as command
from railhil.common.exit_codes import guarded

Campaign = Callable[..., Done]


def campaign_here(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Campaign:
    """The command; its arguments are those of the command line."""
    monkeypatch.setattr("signal.signal", lambda *given: None)

    def call(*arguments: str | Path) -> Done:
        monkeypatch.setattr(sys, "argv", ["campaign", *map(str, arguments)])
        try:
            code = guarded("railhil campaign", command.main)
        except SystemExit as end:
            code = int(end.code or 0)
        said = capsys.readouterr()
        return Done(code, said.out, said.err)

    return call
